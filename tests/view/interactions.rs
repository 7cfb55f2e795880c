//! The papers' own interaction: handles in the camera's volume, and tools in the picture.

use crate::browser::Browser;
use crate::page::{is_quiet, open, text};
use crate::viewed::{CITY, Viewed};
use serde_json::{Value, json};

/// Numbers that a path of the scene has on the page.
fn numbers(browser: &Browser, path: &str) -> Vec<f64> {
    let value = browser.run(&format!("return get({path:?})"));
    match &value {
        Value::Array(items) => items.iter().map(|x| x.as_f64().unwrap_or_else(|| panic!("{path}: {value}"))).collect(),
        _ => vec![value.as_f64().unwrap_or_else(|| panic!("{path}: {value}"))],
    }
}

/// Drags a handle of the volume by some pixels.
fn drag_handle(browser: &Browser, id: &str, [dx, dy]: [f64; 2]) {
    browser.wait("turntable.isFitted && state.volume.revision === state.scene.revision && drawing === null");
    let [x, y] = browser.middle(&format!("#handles [data-id='{id}']"));
    browser.drag(&[[x, y], [x + dx, y + dy]]);
    browser.rest();
}

/// What a drag of a handle changed: the value of its key before and after; and the picture is that of the changed scene.
fn dragged(viewed: &Viewed, browser: &Browser, id: &str) -> (Vec<f64>, Vec<f64>) {
    let (before, picture) = (numbers(browser, id), browser.picture());
    drag_handle(browser, id, [26.0, -18.0]);
    let after = numbers(browser, id);
    assert_ne!(before, after, "{id}");
    assert!(browser.picture() != picture, "{id}");
    assert!(browser.picture() == viewed.rendered(&text(browser), &[]), "{id}");
    (before, after)
}

fn scene(camera: &str) -> String {
    format!("{CITY}{camera}\n")
}

#[test]
fn near_and_far_points_of_a_glc_are_dragged() {
    let glc = "kind = \"glc\"\nnear = [[-40, 40, 60], [40, 40, 60], [-40, 10, 60]] # at t = 0\nfar = [[-20, 20, 0], [20, 20, 0], [-20, 0, 0]]";
    let Some((viewed, mut browser)) = open(&scene(glc)) else { return };
    assert_eq!(browser.run("return document.querySelectorAll('#handles .handle').length"), json!(6));
    let (before, after) = dragged(&viewed, &browser, "camera.near.1");
    // in the plane of the drawing: as far in the world as the pointer moved on the page
    let moved: Vec<f64> = (0..3).map(|k| after[k] - before[k]).collect();
    let script = "return turntable.scale";
    let scale = browser.run(script).as_f64().unwrap();
    let (world, page) = (moved.iter().map(|x| x * x).sum::<f64>().sqrt(), 26f64.hypot(18.0) / scale);
    // each coordinate is rounded to a part in a million of the scene's size, and pointers to a pixel
    assert!((world / page - 1.0).abs() < 0.05, "{world} {page}");
    dragged(&viewed, &browser, "camera.far.2");
    let after = text(&browser);
    assert!(after.contains("# at t = 0") && after.contains("# a city"), "{after}");
    browser.screenshot("glc");
    // the drawing turns without a change of the scene
    let [x, y] = browser.middle("#volume");
    browser.drag(&[[x - 150.0, y + 180.0], [x, y + 200.0]]);
    assert_eq!(text(&browser), after);
    is_quiet(&viewed, &mut browser);
}

#[test]
fn slits_are_dragged() {
    let slits = "kind = \"cross_slit\"\nslits = [{ distance = 60, angle = 0 }, { point = [0, 20, -30], direction = [0, 1, 0] }]\neye = [0, 30, 60]\ntarget = [0, 5, 0]\nheight = 40";
    let Some((viewed, mut browser)) = open(&scene(slits)) else { return };
    dragged(&viewed, &browser, "camera.slits.0.distance");
    dragged(&viewed, &browser, "camera.slits.0.angle");
    dragged(&viewed, &browser, "camera.slits.1.point");
    dragged(&viewed, &browser, "camera.slits.1.direction");
    browser.screenshot("slits");
    is_quiet(&viewed, &mut browser);
}

#[test]
fn projectors_bend_with_their_control_surfaces() {
    let projector = "kind = \"projector\"\nsurfaces = [\n  { kind = \"plane\", origin = [-20, 40, 60], u = [40, 0, 0], v = [0, -30, 0] },\n  \
                     { kind = \"bilinear\", corners = [[-30, 50, 20], [30, 50, 20], [-30, 5, 20], [30, 5, 20]] },\n  \
                     { kind = \"bezier\", points = [[[-40, 60, -40], [0, 60, -40], [40, 60, -40]], [[-40, -10, -40], [0, -10, -40], [40, -10, -40]]] },\n]";
    let Some((viewed, mut browser)) = open(&scene(projector)) else { return };
    dragged(&viewed, &browser, "camera.surfaces.0.origin");
    dragged(&viewed, &browser, "camera.surfaces.0.u");
    dragged(&viewed, &browser, "camera.surfaces.1.corners.1");
    dragged(&viewed, &browser, "camera.surfaces.2.points.0.2");
    browser.screenshot("projector");
    is_quiet(&viewed, &mut browser);
}

#[test]
fn a_hinge_turns_by_its_handle() {
    let hinge = "kind = \"hinge\"\neye = [0, 40, 70]\ntarget = [0, 5, 0]\nvfov = 40\npath = 50\nangle = 0";
    let Some((viewed, mut browser)) = open(&scene(hinge)) else { return };
    let (before, after) = dragged(&viewed, &browser, "camera.angle");
    assert!(before == [0.0] && after[0].abs() > 2.0 && after[0].abs() < 89.0, "{after:?}");
    // the handle is where the angle is
    let apart = browser.run(
        "const h = handles().find((h) => h.id === 'camera.angle'); const again = h.move(h.at)[0][1]; return Math.abs(again - state.values.camera.angle)",
    );
    assert!(apart.as_f64().unwrap() < 1e-3, "{apart}");
    browser.screenshot("hinge");
    is_quiet(&viewed, &mut browser);
}

#[test]
fn path_points_are_dragged() {
    let path = "kind = \"mcop\"\npath = [{ eye = [-50, 30, 50], target = [-20, 5, 0] }, { eye = [50, 30, 50], target = [20, 5, 0] }]\nvfov = 40";
    let Some((viewed, mut browser)) = open(&scene(path)) else { return };
    dragged(&viewed, &browser, "camera.path.1.eye");
    dragged(&viewed, &browser, "camera.path.0.target");
    browser.screenshot("path");
    is_quiet(&viewed, &mut browser);
}

#[test]
fn regions_are_drawn_and_their_viewpoints_moved() {
    let Some((viewed, mut browser)) = open(&scene(crate::page::PINHOLE)) else { return };
    let draw = |from: [f64; 2], to: [f64; 2]| {
        browser.choose("#tool", "region");
        browser.drag(&[browser.in_picture(from), browser.in_picture(to)]);
    };
    draw([0.15, 0.3], [0.4, 0.6]);
    browser.wait("state.scene.values.camera.regions?.length === 1");
    browser.rest();
    let rect = numbers(&browser, "camera.regions.0.rect");
    // pointers stand on whole pixels of the page
    let expected = [0.15, 0.3, 0.4, 0.6];
    assert!(rect.iter().zip(expected).all(|(a, b)| (a - b).abs() < 0.005), "{rect:?}");
    // dragging now moves the region's viewpoint, not the camera
    assert_eq!(browser.run("return document.getElementById('pose').value"), json!("camera.regions.0"));
    let (eye, root) = (numbers(&browser, "camera.regions.0.eye"), numbers(&browser, "camera.eye"));
    let before = browser.picture();
    browser.drag(&[[0.7, 0.7], [0.75, 0.72]].map(|at| browser.in_picture(at)));
    browser.rest();
    assert!(numbers(&browser, "camera.regions.0.eye") != eye && numbers(&browser, "camera.eye") == root);
    assert!(browser.picture() != before && browser.picture() == viewed.rendered(&text(&browser), &[]));
    // a second one, and a corner of the first by its handle in the picture
    draw([0.6, 0.35], [0.85, 0.65]);
    browser.wait("state.scene.values.camera.regions?.length === 2");
    browser.rest();
    browser.choose("#tool", "region");
    let [x, y] = browser.middle("#overlay [data-id='camera.regions.0.rect.21']");
    browser.drag(&[[x, y], [x + 14.0, y - 16.0]]);
    browser.rest();
    let wider = numbers(&browser, "camera.regions.0.rect");
    assert!(wider[2] > rect[2] + 0.01 && wider[1] < rect[1] - 0.01 && wider[0] == rect[0], "{wider:?}");
    assert!(browser.picture() == viewed.rendered(&text(&browser), &[]));
    // the viewpoint as a handle of the volume, too
    dragged(&viewed, &browser, "camera.regions.1.eye");
    browser.screenshot("regions");
    is_quiet(&viewed, &mut browser);
}

#[test]
fn targets_are_placed_and_moved() {
    let Some((viewed, mut browser)) = open(&scene(crate::page::PINHOLE)) else { return };
    browser.choose("#tool", "target");
    browser.drag(&[browser.in_picture([0.45, 0.5])]);
    browser.wait("state.scene.values.camera.targets?.length === 1");
    browser.rest();
    // its mark is where the pointer was
    let place = browser.run("return viewPlace(get('camera.targets.0.at'))");
    let near = |k: usize, at: f64| (place[k].as_f64().unwrap() - at).abs() < 0.005;
    assert!(near(0, 0.45) && near(1, 0.5), "{place}");
    let before = numbers(&browser, "camera.targets.0.at");
    let [x, y] = browser.middle("#overlay [data-id='camera.targets.0.at']");
    browser.drag(&[[x, y], [x + 60.0, y - 10.0]]);
    browser.rest();
    assert_ne!(numbers(&browser, "camera.targets.0.at"), before);
    assert!(browser.picture() == viewed.rendered(&text(&browser), &[]));
    browser.screenshot("targets");
    is_quiet(&viewed, &mut browser);
}

#[test]
fn two_saved_views_are_joined() {
    let Some((viewed, mut browser)) = open(&scene(crate::page::PINHOLE)) else { return };
    browser.click("#tab-views");
    browser.click("#save-view");
    // to the right, and turned to the right: the views must not meet within the scene
    browser.run("edit([['camera.eye', [110, 45, 10]], ['camera.target', [70, 0, -90]]])");
    browser.rest();
    browser.click("#save-view");
    assert_eq!(browser.run("return views.length"), json!(2));
    browser.click("[data-view='0']");
    browser.click("[data-view='1']");
    browser.click("#join-views");
    browser.wait("state.scene.values.camera.kind === 'bottom_up'");
    browser.rest();
    let eyes = [numbers(&browser, "camera.views.0.eye"), numbers(&browser, "camera.views.1.eye")];
    assert!(eyes[0] == [60.0, 45.0, 60.0] && eyes[1] != eyes[0], "{eyes:?}");
    assert!(browser.picture() == viewed.rendered(&text(&browser), &[]));
    browser.screenshot("views");
    is_quiet(&viewed, &mut browser);
}

#[test]
fn a_grid_of_offsets_is_dragged() {
    if crate::needs::adapter().is_none() {
        return;
    }
    let camera = "kind = \"camera_texture\"\neye = [60, 45, 60]\ntarget = [0, 0, 0]\nvfov = 45\nfile = \"grid.npy\"";
    let Some(mut browser) = Browser::open() else { return };
    // 3 x 4 offsets of 0 in a file
    let header = "{'descr': '<f8', 'fortran_order': False, 'shape': (3, 4, 2), }";
    let header = format!("{header:<117}\n");
    let npy = [b"\x93NUMPY\x01\x00", &(header.len() as u16).to_le_bytes()[..], header.as_bytes(), &[0; 3 * 4 * 2 * 8]]
        .concat();
    let viewed = Viewed::with_file(&scene(camera), "grid.npy", &npy);
    browser.go(&viewed.address);
    browser.rest();
    browser.choose("#tool", "grid");
    browser.click("#hint button");
    browser.wait("state.scene.values.camera.offsets?.length === 3");
    browser.rest();
    assert!(!text(&browser).contains("grid.npy"));
    let before = browser.picture();
    let [x, y] = browser.middle("#overlay [data-id='camera.offsets.1.2']");
    browser.drag(&[[x, y], [x + 30.0, y - 20.0]]);
    browser.rest();
    let offset = numbers(&browser, "camera.offsets.1.2");
    let width = browser.run("return document.getElementById('view').clientWidth").as_f64().unwrap();
    assert!(
        (offset[0] - 30.0 / width).abs() < 0.004 && (offset[1] + 20.0 / (0.75 * width)).abs() < 0.006,
        "{offset:?} {width}"
    );
    assert!(browser.picture() != before && browser.picture() == viewed.rendered(&text(&browser), &[]));
    browser.screenshot("grid");
    is_quiet(&viewed, &mut browser);
}

#[test]
fn a_pushbroom_flies_where_the_pointer_was_drawn() {
    let pushbroom =
        "kind = \"pushbroom\"\nstart = [-40, 60, 0]\nend = [40, 60, 0]\nlook = [0, -1, 0]\nup = [0, 0, -1]\nvfov = 50";
    let Some((viewed, mut browser)) = open(&scene(pushbroom)) else { return };
    browser.choose("#tool", "path");
    browser.drag(&[[0.25, 0.7], [0.8, 0.3]].map(|at| browser.in_picture(at)));
    browser.wait("state.scene.values.camera.start[0] !== -40");
    browser.rest();
    let (start, end) = (numbers(&browser, "camera.start"), numbers(&browser, "camera.end"));
    // as high as before; a quarter of 80 along, where the pointer was pressed
    assert!(
        start[1] == 60.0 && end[1] == 60.0 && (start[0] + 20.0).abs() < 0.5 && (end[0] - 24.0).abs() < 0.5,
        "{start:?} {end:?}"
    );
    assert!(start[2] > 1.0 && end[2] < -1.0, "the upper part of the picture is at negative z: {start:?} {end:?}");
    assert!(browser.picture() == viewed.rendered(&text(&browser), &[]));
    // its ends are handles, too
    dragged(&viewed, &browser, "camera.end");
    browser.screenshot("pushbroom");
    is_quiet(&viewed, &mut browser);
}

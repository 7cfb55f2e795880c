//! Frames leave out parts of a scene that do not show: pairs of a scene with such a part and without it, and parts that are needed though they
//! are out of view.

use crate::common;

use anamorph::internals::camera::{Camera, Ray};
use anamorph::internals::engine::in_view::ImageRays;
use anamorph::internals::engine::left_out::LeftOut;
use anamorph::internals::engine::plan::variant::variant;
use anamorph::internals::engine::plan::{Plan, SceneContents, SceneExtent, SceneShape};
use anamorph::internals::engine::sequence::Sequence;
use anamorph::internals::engine::{Rendered, RunOptions};
use anamorph::internals::gpu::device::AdapterFeatures;
use anamorph::internals::image::png_bytes;
use anamorph::internals::scene::Scene;
use anamorph::internals::scene::volume::Mode;
use common::cameras::{MeshShape, glc_of_each_class, mesh_camera, raymap};
use common::file::load;
use common::gpu::{Without, engine, render_with, wanted, words};
use common::rng::Rng;
use common::volumes::{SHELLS, bumps, grid, volume};
use common::{ALL_T, FORWARD, camera, scene as scene_of, soup};
use glam::{DAffine3, DQuat, DVec3};
use std::sync::Arc;

/// Things in view of a camera above them that looks down to the origin from [0, 2, 5].
const THINGS: &str = r#"
[[mesh]]
builtin = "plane"
size = 8
[[mesh]]
builtin = "icosphere"
level = 2
scale = 0.6
translate = [-0.7, 0.6, 0]
[[mesh]]
builtin = "box"
rotate = [10, 30, 0]
translate = [0.9, 0.4, 0.2]
"#;

const VIEW: &str = "eye = [0, 2, 5]\ntarget = [0, 0.4, 0]\nvfov = 40";

/// Light that falls from behind the camera down to the floor that it sees, at 45 degrees.
const SHADOWS: &str = "[[light]]\ndirection = [0, -1, -1]\nshadows = true\n";

const BALL_BEHIND: &str = "[[spheres]]\ncenters = [[0.1, 6, 6]]\nradius = 0.4\n";

const BOX_BEHIND: &str = "[[mesh]]\nbuiltin = \"box\"\nscale = 0.4\n\
                          translate = [{ frame = 0, value = [0, 6, 6] }, { frame = 1, value = [0.5, 6, 6] }]\n";

fn scene(parts: &[&str], camera: &str) -> Scene {
    let image = "image = { width = 64, height = 48, background = [0.1, 0.2, 0.3] }";
    load(&format!("{image}\n{THINGS}{}[camera]\n{camera}", parts.concat())).unwrap()
}

fn pinhole(parts: &[&str]) -> Scene {
    scene(parts, &format!("kind = \"pinhole\"\n{VIEW}\nline_time = 0.01\n"))
}

fn rendered(scene: &Scene, run: &RunOptions) -> Option<Rendered> {
    let camera: Camera = scene.camera().unwrap();
    render_with(scene, &camera, Without::Nothing, run)
}

/// The parts of a frame that are left out, for this reason.
fn left_out(frame: &Rendered, why: &str) -> Vec<String> {
    let line = |left: &LeftOut| left.to_string();
    let lines = frame.left_out.iter().map(line).filter_map(|line| line.strip_suffix(why).map(str::to_owned));
    lines.map(|part| part.trim_start_matches('[').replace("] is left out: ", "")).collect()
}

/// Asserts that a frame of the scene with a part shows the same bytes, by as many passes, as one without the part, and that it says why;
/// and that culling is what leaves the part out.
fn assert_left_out(name: &str, [with, without]: [&Scene; 2], parts: &[&str], why: &str) {
    let Some(own) = rendered(with, &RunOptions::default()) else { return };
    let bare = rendered(without, &RunOptions::default()).unwrap();
    assert!(own.srgb8 == bare.srgb8, "{name}: another picture");
    assert_eq!(own.passes, bare.passes, "{name}");
    assert_eq!(own.method.name, bare.method.name, "{name}");
    assert_eq!(left_out(&own, why), parts, "{name}");
    assert_ne!(left_out(&bare, why), parts, "{name}");
    let whole = rendered(with, &RunOptions { no_cull: true, ..RunOptions::default() }).unwrap();
    assert!(left_out(&whole, why).is_empty(), "{name}: left out without culling");
    assert!(words(&own.frame) == words(&whole.frame), "{name}: other planes than with all parts");
}

/// Asserts that a part changes the picture, and that nothing of it is left out.
fn assert_needed(name: &str, [with, without]: [&Scene; 2]) {
    let Some(own) = rendered(with, &RunOptions::default()) else { return };
    let bare = rendered(without, &RunOptions::default()).unwrap();
    assert!(own.srgb8 != bare.srgb8, "{name}: the part changes nothing");
    assert_eq!(left_out(&own, "not in view"), [""; 0], "{name}");
    let whole = rendered(with, &RunOptions { no_cull: true, ..RunOptions::default() }).unwrap();
    assert!(words(&own.frame) == words(&whole.frame), "{name}: other planes than with all parts");
}

#[test]
fn spheres_behind_the_camera() {
    assert_left_out("ball", [&pinhole(&[BALL_BEHIND]), &pinhole(&[])], &["spheres"], "not in view");
    let beside = "[[spheres]]\ncenters = [[4.5, 0.5, 0]]\nradius = 0.4\n";
    assert_left_out("ball beside", [&pinhole(&[beside]), &pinhole(&[])], &["spheres"], "not in view");
    let half_seen = "[[spheres]]\ncenters = [[2.6, 0.5, 0]]\nradius = 0.4\n";
    assert_needed("half a ball", [&pinhole(&[half_seen]), &pinhole(&[])]);
}

#[test]
fn spheres_and_boxes_behind_the_camera_whose_shadows_are_seen() {
    assert_needed("ball", [&pinhole(&[SHADOWS, BALL_BEHIND]), &pinhole(&[SHADOWS])]);
    assert_needed("box", [&pinhole(&[SHADOWS, BOX_BEHIND]), &pinhole(&[SHADOWS])]);
}

#[test]
fn a_moving_box_behind_the_camera() {
    assert_left_out("box", [&pinhole(&[BOX_BEHIND]), &pinhole(&[])], &["time steps"], "not in view");
    // at the frame's own time it is beside the image
    let comes = "[[mesh]]\nbuiltin = \"box\"\nscale = 0.4\n\
                 translate = [{ frame = 0, value = [9, 0.5, 0] }, { frame = 0.1, value = [1.5, 0.5, 0] }]\n";
    assert_needed("box that comes", [&pinhole(&[comes]), &pinhole(&[])]);
}

#[test]
fn images_on_a_quad_behind_the_camera() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("image.png");
    let texels: Vec<u8> = (0..16u8).flat_map(|k| [16 * k, 200, 90, 255]).collect();
    std::fs::write(&path, png_bytes(4, 4, &texels).unwrap()).unwrap();
    let quad = |translate: &str| {
        let path = path.display();
        format!(
            "[[mesh]]\nbuiltin = \"plane\"\nsize = 1\nrotate = [70, 0, 0]\ntranslate = {translate}\ntexture = '{path}'\n"
        )
    };
    let behind = quad("[0, 3, 8]");
    assert_left_out("quad", [&pinhole(&[&behind]), &pinhole(&[])], &["textures"], "not in view");
    assert_needed("quad in view", [&pinhole(&[&quad("[0, 1, 1]")]), &pinhole(&[])]);
}

#[test]
fn alpha_masks_on_a_quad_behind_the_camera() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mask.png");
    let texels: Vec<u8> = (0..16u8).flat_map(|k| [90, 200, 90, 255 * (k % 2)]).collect();
    std::fs::write(&path, png_bytes(4, 4, &texels).unwrap()).unwrap();
    let quad = |translate: &str| {
        let path = path.display();
        format!(
            "[[mesh]]\nbuiltin = \"plane\"\nsize = 1\nrotate = [70, 0, 0]\ntranslate = {translate}\n\
             texture = {{ file = '{path}', cutoff = 0.5 }}\n"
        )
    };
    let behind = quad("[0, 3, 8]");
    let parts = ["textures", "alpha masks"];
    assert_left_out("quad", [&pinhole(&[&behind]), &pinhole(&[])], &parts, "not in view");
    assert_needed("quad in view", [&pinhole(&[&quad("[0, 1, 1]")]), &pinhole(&[])]);
    // its shadow is in view, but not its image
    let shadow = [true, false].map(|no_cull| {
        rendered(&pinhole(&[SHADOWS, &quad("[0, 6, 6]")]), &RunOptions { no_cull, ..RunOptions::default() })
    });
    let [Some(whole), Some(own)] = shadow else { return };
    let solid = quad("[0, 6, 6]").replace(", cutoff = 0.5", "");
    assert!(rendered(&pinhole(&[SHADOWS, &solid]), &RunOptions::default()).unwrap().srgb8 != own.srgb8);
    assert_eq!(
        (left_out(&own, "not in view"), words(&own.frame) == words(&whole.frame)),
        (vec!["textures".into()], true)
    );
}

#[test]
fn a_volume_behind_the_camera() {
    let with = |center: DVec3| {
        let mut grid = grid([9, 9, 9], DQuat::IDENTITY, bumps);
        grid.to_world = DAffine3::from_translation(center) * grid.to_world;
        Scene { volume: Some(volume(grid, &SHELLS, Mode::Composite, true)), ..pinhole(&[]) }
    };
    let behind = with(DVec3::new(0.0, 2.0, 7.0));
    assert_left_out("volume", [&behind, &pinhole(&[])], &["volume"], "not in view");
    assert_needed("volume in view", [&with(DVec3::new(0.3, 1.0, 0.0)), &pinhole(&[])]);
}

/// A ball of glass at a place, before the same eye.
fn glass(center: &str, parts: &[&str]) -> Scene {
    let lens = format!("lens = {{ shape = \"sphere\", center = {center}, radius = 0.5 }}");
    scene(
        parts,
        &format!(
            "kind = \"refraction\"\nior = 1.5\nfresnel = true\ndepth = 3\n{lens}\neye = {{ kind = \"pinhole\", {} }}\n",
            VIEW.replace('\n', ", ")
        ),
    )
}

#[test]
fn a_glass_ball_behind_the_camera() {
    let plain = scene(&[], &format!("kind = \"pinhole\"\n{VIEW}\n"));
    assert_left_out("glass", [&glass("[0, 2, 7]", &[]), &plain], &["bounce, fit and meet"], "not in view");
    assert_needed("glass in view", [&glass("[0, 1, 1]", &[]), &plain]);
}

/// A flat mirror behind the things, in which the camera sees behind itself.
#[test]
fn a_mirror_that_shows_a_sphere_behind_the_camera() {
    let mirror = |center: &str, parts: &[&str]| {
        let mirror = format!(
            "mirror = {{ shape = \"quadric\", vertex = {center}, axis = [0, 0, 1], curvature = 0, radius = 2 }}"
        );
        let eye = VIEW.replace('\n', ", ");
        scene(parts, &format!("kind = \"reflection\"\n{mirror}\neye = {{ kind = \"pinhole\", {eye} }}\n"))
    };
    let ball = "[[spheres]]\ncenters = [[0.1, 1.5, 9]]\nradius = 1.4\n";
    let seen = |parts: &[&str]| mirror("[0, 1, -2]", parts);
    assert_needed("ball in a mirror", [&seen(&[ball]), &seen(&[])]);
    let hidden = |parts: &[&str]| mirror("[0, 1, 9]", parts);
    let parts = ["spheres", "bounce, fit and meet"];
    assert_left_out("mirror and ball", [&hidden(&[ball]), &pinhole(&[])], &parts, "not in view");
}

const LENS: &str = r#"[caustics]
light = { kind = "refraction", ior = 1.5, depth = 2,
  eye = { kind = "pinhole", eye = [X, 5, 0], target = [X, 0, 0], up = [0, 0, 1], vfov = 40 },
  lens = { shape = "lens", center = [X, 2, 0], axis = [0, -1, 0], radius = 0.5, thickness = 0.25, curvatures = [0.7, -0.7] } }
receivers = [{ origin = [Y, 0, 1], u = [2, 0, 0], v = [0, 0, -2], texels = [40, 40] }]
"#;

#[test]
fn caustics_on_a_floor_beside_the_image() {
    let caustics = |x: f64| LENS.replace('X', &x.to_string()).replace('Y', &(x - 1.0).to_string());
    let floor = "[[mesh]]\nbuiltin = \"plane\"\nsize = 3\ntranslate = [20, 0, 0]\n";
    let with = |x: f64| pinhole(&[floor, &caustics(x)]);
    assert_left_out("caustics", [&with(20.0), &pinhole(&[floor])], &["caustics"], "not in view");
    assert_needed("caustics in view", [&with(0.0), &pinhole(&[floor])]);
}

#[test]
fn black_lights() {
    let sun = "[[light]]\ndirection = [-1, -2, -1]\n";
    let black = "[[light]]\nposition = [1, 3, 1]\ncolor = [0, 0, 0]\nshadows = true\n";
    assert_left_out("beside the sun", [&pinhole(&[sun, black]), &pinhole(&[sun])], &["1 light"], "black");
    let dark = "[[light]]\ndirection = [-1, -2, -1]\ncolor = [0, 0, 0]\n";
    assert_left_out("no other", [&pinhole(&[black, black]), &pinhole(&[dark])], &["2 lights"], "black");
}

#[test]
fn lamps_below_the_ground() {
    let ball = "[[mesh]]\nbuiltin = \"icosphere\"\nlevel = 2\nscale = 0.6\ntranslate = [0.4, 0.9, 0]\n";
    let ground = "[[mesh]]\nbuiltin = \"plane\"\nsize = 8\n";
    let sun = "[[light]]\ndirection = [-1, -2, -1]\n";
    let of = |eye: &str, parts: &[&str]| {
        let image = "image = { width = 64, height = 48 }";
        let camera = format!("[camera]\nkind = \"pinhole\"\neye = {eye}\ntarget = [0, 0.4, 0]\nvfov = 40");
        load(&format!("{image}\n{}{camera}", [&[ball, ground, sun], parts].concat().concat())).unwrap()
    };
    let lamp = |place: &str, shadows: bool| format!("[[light]]\nposition = {place}\nshadows = {shadows}\n");
    let [above, below] = ["[0, 2, 5]", "[0, -2, 5]"];
    let reason = "lights nothing in view";
    let left = lamp("[0.5, -2, 1]", true);
    assert_left_out("below", [&of(above, &[&left]), &of(above, &[])], &["1 light"], reason);
    let both = lamp("[-3, -1, 4]", true) + &left;
    assert_left_out("two below", [&of(above, &[&both]), &of(above, &[])], &["2 lights"], "light nothing in view");
    for (name, eye, lamp) in [
        ("seen from below", below, left.clone()),
        ("without shadows", above, lamp("[0.5, -2, 1]", false)),
        ("beside the ground", above, lamp("[5, -0.1, 1]", true)),
        ("above", above, lamp("[1, 2, 1]", true)),
    ] {
        let [with, without] = [of(eye, &[&lamp]), of(eye, &[])];
        assert_needed(name, [&with, &without]);
        let Some(own) = rendered(&with, &RunOptions::default()) else { return };
        assert_eq!(left_out(&own, reason), [""; 0], "{name}");
    }
    let hole = [ball, sun, "[[mesh]]\nbuiltin = \"plane\"\nsize = 8\ntranslate = [1, 0, 0]\n"].concat();
    let over = of(above, &[&hole, &left]);
    let Some(own) = rendered(&over, &RunOptions::default()) else { return };
    assert_eq!(left_out(&own, reason), [""; 0], "two grounds that lap over");
}

/// Normals, vertex colours and patterns of surfaces behind the camera.
#[test]
fn looks_of_things_behind_the_camera() {
    let folder = tempfile::tempdir().unwrap();
    let colored = folder.path().join("colored.ply");
    let header = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
                  property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 1\n\
                  property list uchar int vertex_indices\nend_header\n";
    std::fs::write(&colored, format!("{header}0 0 0 255 0 0\n1 0 0 0 255 0\n0 1 0 0 0 255\n3 0 1 2\n")).unwrap();
    let city = "[[mesh]]\nbuiltin = \"city\"\ntriangles = 300\nscale = 0.02\n";
    let of = |parts: &[&str]| {
        let image = "image = { width = 64, height = 48 }";
        load(&format!("{image}\n{city}{}[camera]\nkind = \"pinhole\"\n{VIEW}", parts.concat())).unwrap()
    };
    let at = |z: f64, keys: &str| format!("translate = [0, 0.4, {z}]\n{keys}\n");
    let ball = |z: f64, keys: &str| format!("[[mesh]]\nbuiltin = \"icosphere\"\nscale = 0.3\n{}", at(z, keys));
    let colored = |z: f64| format!("[[mesh]]\nfile = '{}'\n{}", colored.display(), at(z, ""));
    let smooth = "smooth = true";
    let checker = "smooth = true\npattern = { kind = \"checker\", size = 0.1 }";
    for (name, [behind, seen], parts) in [
        ("smooth", [8.0, 0.0].map(|z| ball(z, smooth)), &["smooth normals"][..]),
        ("colored", [8.0, 0.0].map(colored), &["vertex colours"]),
        ("pattern", [8.0, 0.0].map(|z| ball(z, checker)), &["smooth normals", "patterns"]),
    ] {
        assert_left_out(name, [&of(&[&behind]), &of(&[])], parts, "not in view");
        assert_needed(name, [&of(&[&seen]), &of(&[])]);
    }
}

/// A projector that throws an image of this value from above the things towards a place.
fn projector(folder: &std::path::Path, value: u8, target: &str) -> String {
    let path = folder.join(format!("{value}.png"));
    std::fs::write(&path, png_bytes(2, 2, &[value; 12]).unwrap()).unwrap();
    let camera = format!("{{ kind = \"pinhole\", eye = [0, 4, 0.5], target = {target}, vfov = 50 }}");
    format!("[[projector_light]]\nimage = '{}'\nmode = \"light\"\ncamera = {camera}\n", path.display())
}

#[test]
fn projector_lights() {
    let folder = tempfile::tempdir().unwrap();
    let sun = "[[light]]\ndirection = [-1, -2, -1]\n";
    let with = |value: u8, target: &str| pinhole(&[sun, &projector(folder.path(), value, target)]);
    let plain = pinhole(&[sun]);
    let reason = "lights nothing in view";
    assert_left_out("up into the sky", [&with(200, "[0, 9, 1]"), &plain], &["1 projector light"], reason);
    assert_left_out("black", [&with(0, "[0, 0, 0]"), &plain], &["1 projector light"], reason);
    // only what lies behind the camera is reached
    let ball = "[[mesh]]\nbuiltin = \"icosphere\"\nscale = 0.4\ntranslate = [0.1, 6, 9]\n";
    let both = |parts: &[&str]| pinhole(&[&[sun, ball], parts].concat());
    let behind = projector(folder.path(), 200, "[0.1, 6, 9]");
    assert_left_out("behind", [&both(&[&behind]), &both(&[])], &["1 projector light"], reason);
    assert_needed("onto the floor", [&with(200, "[0, 0, 0]"), &plain]);
    // without any light of its own a scene would have a headlight
    let alone = pinhole(&[&projector(folder.path(), 0, "[0, 0, 0]")]);
    let dark = pinhole(&["[[light]]\ndirection = [0, -1, 0]\ncolor = [0, 0, 0]\n"]);
    assert_left_out("no other light", [&alone, &dark], &["1 projector light"], reason);
}

/// Whether a ray meets a box between the ends of t.
fn meets(ray: &Ray, t_range: [f64; 2], (lo, hi): (DVec3, DVec3)) -> bool {
    let (a, b) = ((lo - ray.origin) / ray.direction, (hi - ray.origin) / ray.direction);
    let first = a.min(b).max_element().max(t_range[0]);
    first <= a.max(b).min_element().min(t_range[1])
}

/// No ray of any pixel meets a box that frames may leave out; and a third of the boxes that all rays miss may be left out, at least.
#[test]
fn boxes_that_no_ray_meets() {
    const PIXELS: (u32, u32) = (48, 36);
    let shape = MeshShape { discontinuous: true, weights: true, ..Default::default() };
    let kinds = glc_of_each_class().into_iter().chain([("mesh", mesh_camera(1, 9, 7, shape))]);
    let mut cameras: Vec<Camera> =
        kinds.flat_map(|(_, kind)| [FORWARD, ALL_T, [0.2, 0.7]].map(|t| camera(kind.clone(), PIXELS, t))).collect();
    cameras.push(raymap(PIXELS.0, PIXELS.1, FORWARD));
    let lens = |keys: &str| {
        common::file::camera_of("", PIXELS, &format!("{keys}\neye = [0, 0, 2]\ntarget = [0, 0, 0]")).unwrap()
    };
    cameras.extend([lens("kind = \"fisheye\"\nfov = 150"), lens("kind = \"sphere\"")]);
    let mut rng = Rng(5);
    for camera in cameras {
        let scene = scene_of(soup(&mut rng, 9, 1.0));
        let (has, wanted) = (AdapterFeatures { f64: true, ..AdapterFeatures::default() }, wanted());
        let (contents, extent) = (SceneContents::of(&scene), SceneExtent::of(&camera, SceneShape::of(&scene)));
        let variant = variant(&camera, contents, &wanted, has, &RunOptions::default());
        let plan = Plan::new(variant, &camera, contents, extent, &wanted, has, 1 << 27);
        let rays = ImageRays::of(&plan, camera.t_range).unwrap();
        let pixels = (0..PIXELS.1).flat_map(|j| (0..PIXELS.0).map(move |i| (i, j)));
        let all: Vec<Ray> = pixels.filter_map(|(i, j)| camera.ray(i, j)).collect();
        let (mut left_out, mut missed) = (0, 0);
        for _ in 0..400 {
            let (center, half) = (6.0 * rng.vector(), 0.5 * rng.vector().abs() + 0.01);
            let bounds = (center - half, center + half);
            let is_met = all.iter().any(|ray| meets(ray, camera.t_range, bounds));
            let may_be_met = rays.may_meet(bounds);
            assert!(may_be_met || !is_met, "{}, {:?}: {bounds:?}", camera.kind, camera.t_range);
            missed += usize::from(!is_met);
            left_out += usize::from(!may_be_met);
        }
        println!("{}, {:?}: {left_out} of {missed} boxes left out", camera.kind, camera.t_range);
        assert!(
            camera.kind == "sphere" || missed > 20 && 3 * left_out > missed,
            "{}: {left_out} of {missed}",
            camera.kind
        );
    }
}

/// The frames of a sequence, each of a scene through a camera.
fn sequence(frames: &[(&Scene, Arc<Camera>)]) -> Vec<Rendered> {
    let Some(mut engine) = engine(&frames[0].1, Without::Nothing) else { return Vec::new() };
    let (run, mut sequence, mut last) = (RunOptions::default(), Sequence::default(), None);
    let each = frames.iter().map(|(scene, camera)| {
        let planned = engine.planner().plan(scene, camera.clone(), &wanted(), &run, last.as_ref()).unwrap();
        last = Some(planned.clone());
        let shown = sequence.render(&mut engine, planned, &run).unwrap().rendered();
        let whole = RunOptions { no_cull: true, ..run.clone() };
        let anew = engine.render(scene, camera.clone(), &wanted(), &whole).unwrap();
        assert!(words(&shown.frame) == words(&anew.frame));
        shown
    });
    each.collect()
}

/// A sequence uploads anew when a part first comes into view, and keeps it.
#[test]
fn a_part_that_comes_into_view_stays_for_the_rest_of_a_sequence() {
    let scene = pinhole(&[BALL_BEHIND]);
    let camera_at = |eye: &str| {
        let view = format!("kind = \"pinhole\"\neye = {eye}\ntarget = [0.1, 6, 6]\nvfov = 40\nline_time = 0.01\n");
        Arc::new(common::file::camera_of("", (64, 48), &view).unwrap())
    };
    let away = Arc::new(scene.camera().unwrap());
    let cameras = [away.clone(), camera_at("[0, 5, 14]"), away, camera_at("[1, 5, 14]")];
    let frames = sequence(&cameras.map(|camera| (&scene, camera)));
    let found = frames.iter().map(|frame| (frame.method.name, left_out(frame, "not in view").len()));
    let expected = [("raster", 1), ("trace", 0), ("trace", 0), ("trace", 0)];
    assert!(frames.is_empty() || found.eq(expected));
}

/// A light that is black for a while stays, so that nothing is uploaded anew as it goes on and off.
#[test]
fn a_light_that_goes_out_stays_for_the_rest_of_a_sequence() {
    let on = pinhole(&[SHADOWS]);
    let mut off = on.clone();
    off.lights[0].colour = [0.0; 3];
    let camera = Arc::new(on.camera().unwrap());
    let frames = sequence(&[&off, &on, &off, &on].map(|scene| (scene, camera.clone())));
    let found = frames.iter().map(|frame| left_out(frame, "black").len());
    assert!(frames.is_empty() || found.eq([1, 0, 0, 0]));
}

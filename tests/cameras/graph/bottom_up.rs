//! Two views joined.

use super::*;

const VIEWS: &str = "views = [{ eye = [-6, 3, 9], target = [-7, 1, 0], vfov = 40 }, \
                     { eye = [6, 4, 9], target = [7, 1, 0], vfov = 50 }]\nweights = [3, 2, 3]";

fn of(keys: &str) -> Camera {
    camera_of(BOXES, SIZE, &format!("kind = \"bottom_up\"\n{VIEWS}\n{keys}")).unwrap()
}

fn view(k: usize, size: (u32, u32)) -> Camera {
    let pose =
        ["eye = [-6, 3, 9]\ntarget = [-7, 1, 0]\nvfov = 40", "eye = [6, 4, 9]\ntarget = [7, 1, 0]\nvfov = 50"][k];
    camera_of(BOXES, size, &format!("kind = \"pinhole\"\n{pose}")).unwrap()
}

const ROOT: &str = "root = { eye = [0, 4, 20], target = [0, 1, 0], vfov = 45 }";

fn root() -> Camera {
    camera_of(BOXES, SIZE, "kind = \"pinhole\"\neye = [0, 4, 20]\ntarget = [0, 1, 0]\nvfov = 45").unwrap()
}

#[test]
fn each_view_is_the_plain_pinhole_of_its_part_of_the_image() {
    for keys in [
        "",
        "foreground = true",
        "foreground = true\njoin = \"bezier\"",
        "lateral = 1",
        "foreground = true\nlongitudinal = 3",
    ] {
        let camera = of(keys);
        let leaf = camera.layers.len() - 1;
        let (left, right) = (view(0, (30, 60)), view(1, (30, 60)));
        for (i, j) in (0..60).flat_map(|j| (0..30).map(move |i| (i, j))) {
            assert_same(&camera, leaf, (i, j), &left.ray(i, j).unwrap());
            assert_same(&camera, leaf, (i + 50, j), &right.ray(i, j).unwrap());
        }
    }
}

#[test]
fn its_pixels_are_those_of_the_plain_pictures() {
    let scene = scene_of(BOXES, SIZE, &format!("kind = \"bottom_up\"\n{VIEWS}")).unwrap();
    let channels = [Channel::TriangleId, Channel::R, Channel::G, Channel::B];
    let joined = image::image(&scene, &scene.camera().unwrap(), &channels);
    for (k, start) in [(0, 0), (1, 50)] {
        let plain = image::judge(&scene, &view(k, (30, 60)), &Frame { width: 30, height: 60, planes: Vec::new() });
        let mut seen = 0;
        for at in (0..30 * 60).filter(|&at| plain.safe[at]) {
            let of_joined = start + at % 30 + at / 30 * 80;
            let id = |frame: &Frame, at: usize| frame.u32(Channel::TriangleId).unwrap()[at];
            assert_eq!(id(&joined, of_joined), id(&plain.truth, at));
            for c in &channels[1..] {
                let value = |frame: &Frame, at: usize| frame.f32(*c).unwrap()[at];
                assert!((value(&joined, of_joined) - value(&plain.truth, at)).abs() <= 1.0 / 255.0);
            }
            seen += usize::from(id(&plain.truth, at) != NO_ID);
        }
        assert!(seen > 30 * 60 / 4, "{seen} safe pixels with something to see");
    }
}

#[test]
fn the_picture_has_no_seam() {
    for (keys, layers) in [
        ("", 1),
        ("foreground = true", 3),
        ("foreground = true\nlongitudinal = 4", 6),
        ("foreground = true\nnear = 2\njoin = \"bezier\"", 3),
    ] {
        let camera = of(keys);
        assert_eq!(camera.layers.len(), layers, "{keys}");
        assert_eq!(assert_joined(&camera, 1), 3 * (layers - 1) * 80 * 60);
        assert!(assert_seamless(&camera, 2) >= 5, "{keys}");
        assert_curves_seamless(&camera);
        assert!(pixels(&camera).all(|(i, j)| (0..layers).all(|layer| camera.curve(layer, i, j).is_some())));
    }
    assert_smooth(&of("foreground = true\nnear = 2\njoin = \"bezier\""));
}

#[test]
fn morphed_to_0_it_is_the_root_view_and_on_the_way_it_moves_evenly() {
    for keys in [ROOT.to_string(), format!("{ROOT}\nforeground = true\njoin = \"bezier\"")] {
        let at = |morph: f64| of(&format!("{keys}\nmorph = {morph:?}"));
        let [plain, half, whole] = [at(0.0), at(0.5), at(1.0)];
        let root = root();
        for (i, j) in pixels(&plain) {
            assert_straight(&plain, (i, j), &root.ray(i, j).unwrap());
            for layer in 0..plain.layers.len() {
                let [a, b, c] = [&plain, &half, &whole].map(|c| c.curve(layer, i, j).unwrap().1);
                for ((p, q), r) in a.points().iter().zip(b.points()).zip(c.points()) {
                    let size = 1.0 + p.length() + r.length();
                    assert!((*q - (*p + *r) / 2.0).length() <= POINT_ROUNDING * size);
                }
            }
        }
        assert_seamless(&half, 3);
    }
}

#[test]
fn between_the_views_rays_turn_evenly_from_the_one_to_the_other() {
    // at strip borders, on the image's upper border
    let camera = of("lateral = 8").with_sample_offset(-0.5, -0.5);
    let border = |k: usize, side: f64, i: u32| view(k, (30, 60)).with_sample_offset(side, -0.5).ray(i, 0).unwrap();
    let (left, right) = (border(0, 0.5, 29), border(1, -0.5, 0));
    for k in 0..=4 {
        let (s, ray) = (k as f64 / 4.0, camera.ray(30 + 5 * k, 0).unwrap());
        let (eye, d) = (left.origin.lerp(right.origin, s), left.direction.slerp(right.direction, s).normalize());
        assert!((ray.origin - eye).length() <= POINT_ROUNDING * 10.0, "{k}: {} {eye}", ray.origin);
        assert!((ray.direction.normalize() - d).length() <= POINT_ROUNDING, "{k}: {} {d}", ray.direction);
    }
}

#[test]
fn opposite_views_are_joined_too() {
    let keys = "kind = \"bottom_up\"\nviews = [{ eye = [-1, 3, 0], target = [-9, 2, 0], vfov = 50 }, \
                { eye = [1, 3, 0], target = [9, 2, 0], vfov = 50 }]";
    let camera = camera_of(BOXES, SIZE, keys).unwrap();
    assert_seamless(&camera, 4);
    let middle = camera.ray(40, 30).unwrap().direction.normalize();
    assert!(middle.z < -0.9, "between views to -x and +x, ahead is -z: {middle}");
    // the graph camera has the same views and breaks between
    let discontinuous = camera_of(BOXES, SIZE, &keys.replace("bottom_up", "graph_camera")).unwrap();
    assert!(discontinuous.notes.iter().any(|n| n.contains("breaks")));
    for (i, j) in [(0, 0), (20, 30), (31, 59), (48, 0), (79, 59)] {
        assert_same(&discontinuous, 0, (i, j), &camera.ray(i, j).unwrap());
    }
    let jump = |c: &Camera, i: u32| {
        (c.ray(i, 30).unwrap().direction.normalize() - c.ray(i + 1, 30).unwrap().direction.normalize()).length()
    };
    for border in [31, 47] {
        assert!(
            jump(&discontinuous, border) > 5.0 * jump(&camera, border),
            "{border}: {}",
            jump(&discontinuous, border)
        );
    }
}

#[test]
fn views_that_cannot_be_joined_are_errors() {
    let says = |keys: &str| refusal(BOXES, SIZE, &format!("kind = \"bottom_up\"\n{keys}"));
    let facing = "views = [{ eye = [-9, 3, 9], target = [9, 1, -9], vfov = 40 }, { eye = [9, 3, 9], target = [-9, 1, -9], vfov = 40 }]";
    assert!(says(facing).contains("camera.views: the two views intersect"), "{}", says(facing));
    let swapped = "views = [{ eye = [6, 3, 9], target = [7, 1, 0], vfov = 20 }, { eye = [-6, 3, 9], target = [-7, 1, 0], vfov = 20 }]";
    assert!(says(swapped).contains("give the left view first"), "{}", says(swapped));
    let narrow = format!("{VIEWS}\nweights = [1, 0.001, 1]");
    assert!(
        says(&narrow.replacen("weights = [3, 2, 3]\n", "", 1)).contains("camera.weights: in an image 80 pixels wide")
    );
    assert!(says(&VIEWS.replace("vfov = 50", "vfov = 180")).contains("camera.views.1.vfov = 180"));
    assert!(
        says(&VIEWS.replace("target = [-7, 1, 0]", "target = [-6, 3, 9]")).contains("camera.views.0: eye and target")
    );
    assert!(says(&VIEWS.replace("[3, 2, 3]", "[3, 0, 3]")).contains("every share must be above 0"));
    assert!(says(&format!("{VIEWS}\nlongitudinal = 4")).contains("add foreground = true"));
    assert!(says(&format!("{VIEWS}\nforeground = true\nlongitudinal = 15")).contains("17 segments"));
    assert!(says(&format!("{VIEWS}\nforeground = true\nlongitudinal = 3\njoin = \"bezier\"")).contains("leave it out"));
    assert!(says(&format!("{VIEWS}\nmorph = 1.5")).contains("camera.morph: 1.5 lies outside [0, 1]"));
    assert!(says(&format!("{VIEWS}\nfar = 0.5\nnear = 1")).contains("camera.far: 0.5 must be more than 1"));
}

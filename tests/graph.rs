//! What the constructors of Popescu et al. promise: views undistorted where they land, no seam anywhere, the plain view
//! where it should be.

mod common;

use anamorph::camera::{Camera, Ray, Rays};
use anamorph::frame::{Channel, Frame, NO_ID};
use anamorph::reference::image;
use common::continuity::{POINT_ROUNDING, assert_joined, assert_seamless, assert_smooth, borders};
use common::file::{camera_of, refusal, scene_of};
use glam::{DVec2, DVec3};

const SIZE: (u32, u32) = (80, 60);

/// Three boxes on a floor.
const BOXES: &str = r#"
[[mesh]]
builtin = "plane"
scale = 2
[[mesh]]
builtin = "box"
translate = [-6, 1, -4]
[[mesh]]
builtin = "box"
translate = [0, 1, 0]
[[mesh]]
builtin = "box"
translate = [6, 1, -4]
"#;

/// The two rays are one line, run through the same way, from the same eye.
fn assert_same(of: &Camera, layer: usize, (i, j): (u32, u32), plain: &Ray) {
    let (_, bundle) = of.pixel(layer, i, j).unwrap_or_else(|| panic!("no ray at {i},{j}"));
    let ray = bundle.ray(0.0, 0.0);
    let (d, e) = (ray.direction.normalize(), plain.direction.normalize());
    let size = 1.0 + ray.direction.length() + plain.origin.length();
    assert!((ray.origin - plain.origin).length() <= POINT_ROUNDING * size, "{i},{j}: {} {}", ray.origin, plain.origin);
    assert!((d - e).length() <= POINT_ROUNDING, "{i},{j}: {d} is not {e}");
}

/// Every leg of the pixel lies on the plain ray, one after the other.
fn assert_straight(of: &Camera, (i, j): (u32, u32), plain: &Ray) {
    let e = plain.direction.normalize();
    let mut last = 0.0;
    for layer in 0..of.layers.len() {
        let (_, curve) = of.curve(layer, i, j).unwrap();
        let size = 1.0 + plain.origin.length() + curve.points().iter().map(|p| p.length()).fold(0.0, f64::max);
        for p in curve.points() {
            let along = (*p - plain.origin).dot(e);
            assert!((*p - plain.origin - along * e).length() <= POINT_ROUNDING * size, "{i},{j}: {p} beside the ray");
            assert!(along >= last - POINT_ROUNDING * size, "{i},{j}: {p} before {last}");
            last = along;
        }
    }
}

fn pixels(of: &Camera) -> impl Iterator<Item = (u32, u32)> + use<> {
    let (w, h) = (of.width, of.height);
    (0..h).flat_map(move |j| (0..w).map(move |i| (i, j)))
}

/// At the borders of curved layers, curves on both sides come together as places do: half the distance, half the jump.
fn assert_curves_seamless(of: &Camera) {
    for layer in 0..of.layers.len() {
        let (Rays::Curves(curves), Some(Rays::Pieces(net))) = (&of.layers[layer], of.layers.get(layer + 1)) else {
            continue;
        };
        let size = DVec2::new(of.width as f64, of.height as f64);
        for (_, _, from, to) in borders(net) {
            let (middle, across) = ((from + to) / 2.0, (to - from).perp().normalize());
            if middle.cmplt(DVec2::ONE).any() || middle.cmpgt(size - 1.0).any() {
                continue;
            }
            let jump = |by: f64| {
                let [a, b] =
                    [-by, by].map(|s| (middle + s * across) / size).map(|q| curves.map.curve(q.x, q.y).unwrap().1);
                let apart = a.points().iter().zip(b.points()).map(|(p, q)| (*p - *q).length()).fold(0.0, f64::max);
                let reach = a.points().iter().map(|p| p.length()).fold(1.0, f64::max);
                (apart, POINT_ROUNDING * reach)
            };
            let ((far, rounding), (near, _)) = (jump(2e-3), jump(1e-3));
            assert!((near - far / 2.0).abs() <= 2.0 * rounding, "layer {layer} at {middle}: {near} of {far}");
        }
    }
}

mod bottom_up {
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
        let torn = camera_of(BOXES, SIZE, &keys.replace("bottom_up", "graph_camera")).unwrap();
        assert!(torn.notes.iter().any(|n| n.contains("breaks")));
        for (i, j) in [(0, 0), (20, 30), (31, 59), (48, 0), (79, 59)] {
            assert_same(&torn, 0, (i, j), &camera.ray(i, j).unwrap());
        }
        let jump = |c: &Camera, i: u32| {
            (c.ray(i, 30).unwrap().direction.normalize() - c.ray(i + 1, 30).unwrap().direction.normalize()).length()
        };
        for border in [31, 47] {
            assert!(jump(&torn, border) > 5.0 * jump(&camera, border), "{border}: {}", jump(&torn, border));
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
            says(&narrow.replacen("weights = [3, 2, 3]\n", "", 1))
                .contains("camera.weights: in an image 80 pixels wide")
        );
        assert!(says(&VIEWS.replace("vfov = 50", "vfov = 180")).contains("camera.views.1.vfov = 180"));
        assert!(
            says(&VIEWS.replace("target = [-7, 1, 0]", "target = [-6, 3, 9]"))
                .contains("camera.views.0: eye and target")
        );
        assert!(says(&VIEWS.replace("[3, 2, 3]", "[3, 0, 3]")).contains("every share must be above 0"));
        assert!(says(&format!("{VIEWS}\nlongitudinal = 4")).contains("add foreground = true"));
        assert!(says(&format!("{VIEWS}\nforeground = true\nlongitudinal = 15")).contains("17 segments"));
        assert!(
            says(&format!("{VIEWS}\nforeground = true\nlongitudinal = 3\njoin = \"bezier\"")).contains("leave it out")
        );
        assert!(says(&format!("{VIEWS}\nmorph = 1.5")).contains("camera.morph: 1.5 lies outside [0, 1]"));
        assert!(says(&format!("{VIEWS}\nfar = 0.5\nnear = 1")).contains("camera.far: 0.5 must be more than 1"));
    }
}

mod top_down {
    use super::*;

    const ROOT: &str = "eye = [0, 6, 20]\ntarget = [0, 1, 0]\nvfov = 40";
    const REGIONS: &str = "regions = [{ rect = [0.1, 0.2, 0.35, 0.7], eye = [-6, 12, 4], target = [-6, 1, -4] }, \
                           { polygon = [[0.6, 0.3], [0.85, 0.25], [0.8, 0.7], [0.7, 0.5]], eye = [8, 10, 6], vfov = 30 }]\nband = 0.1";

    fn of(keys: &str) -> Camera {
        camera_of(BOXES, SIZE, &format!("kind = \"top_down\"\n{ROOT}\n{REGIONS}\n{keys}")).unwrap()
    }

    fn root() -> Camera {
        camera_of(BOXES, SIZE, &format!("kind = \"pinhole\"\n{ROOT}")).unwrap()
    }

    /// Pixels surely inside the first region, and outside all regions and bands.
    fn inside((i, j): (u32, u32)) -> bool {
        (8..28).contains(&i) && (12..42).contains(&j)
    }

    fn outside((i, j): (u32, u32)) -> bool {
        let near = |x0: u32, x1: u32, y0: u32, y1: u32| (x0..x1).contains(&i) && (y0..y1).contains(&j);
        !near(1, 35, 5, 49) && !near(38, 79, 2, 60)
    }

    #[test]
    fn a_region_is_the_plain_pinhole_of_its_eye_moved_by_whole_pixels() {
        for keys in ["", "foreground = true", "foreground = true\njoin = \"bezier\""] {
            let camera = of(keys);
            let leaf = camera.layers.len() - 1;
            let own = camera_of(BOXES, SIZE, "kind = \"pinhole\"\neye = [-6, 12, 4]\ntarget = [-6, 1, -4]\nvfov = 40")
                .unwrap();
            // the region's middle is at (18, 27), the view's at (40, 30)
            for (i, j) in pixels(&camera).filter(|p| inside(*p)) {
                assert_same(&camera, leaf, (i, j), &own.ray(i + 22, j + 3).unwrap());
            }
        }
    }

    #[test]
    fn around_the_regions_it_is_the_plain_root_view() {
        for keys in
            ["", "foreground = true", "foreground = true\nlongitudinal = 3", "foreground = true\njoin = \"bezier\""]
        {
            let camera = of(keys);
            let root = root();
            let around: Vec<_> = pixels(&camera).filter(|p| outside(*p)).collect();
            assert!(around.len() > 600);
            for p in around {
                assert_straight(&camera, p, &root.ray(p.0, p.1).unwrap());
            }
        }
    }

    #[test]
    fn a_region_without_a_target_looks_at_what_the_root_sees_in_its_middle() {
        let rect = "regions = [{ rect = [0.4, 0.4, 0.6, 0.6], eye = [3, 8, 9] }]";
        let camera = camera_of(BOXES, SIZE, &format!("kind = \"top_down\"\n{ROOT}\n{rect}")).unwrap();
        // the root looks down onto the middle box's front, x = 0, z = 0.5; its middle ray meets that at y = 1.125
        let ray = camera.with_sample_offset(-0.5, -0.5).ray(40, 30).unwrap();
        let to = DVec3::new(0.0, 1.125, 0.5) - ray.origin;
        assert!((to.normalize() - ray.direction.normalize()).length() < 1e-9, "{to} {}", ray.direction);
    }

    #[test]
    fn the_picture_has_no_seam() {
        for (keys, layers) in [
            ("", 1),
            ("foreground = true", 3),
            ("foreground = true\nlongitudinal = 2", 4),
            ("foreground = true\njoin = \"bezier\"", 3),
        ] {
            let camera = of(keys);
            assert_eq!(camera.layers.len(), layers, "{keys}");
            assert_eq!(assert_joined(&camera, 1), 3 * (layers - 1) * 80 * 60);
            // 8 corners in regions, 8 around them, 4 around the image; all sides but those 4 are shared
            assert!(assert_seamless(&camera, 2) >= 40);
            assert_curves_seamless(&camera);
            assert!(pixels(&camera).all(|(i, j)| (0..layers).all(|layer| camera.curve(layer, i, j).is_some())));
        }
        assert_smooth(&of("foreground = true\njoin = \"bezier\""));
    }

    #[test]
    fn any_number_of_regions_and_of_none() {
        let many: Vec<String> = (0..12)
            .map(|k| {
                let (a, b) = (0.05 + 0.25 * (k % 4) as f64, 0.1 + 0.3 * (k / 4) as f64);
                format!("{{ rect = [{a}, {b}, {}, {}], eye = [{k}, 9, 9] }}", a + 0.15, b + 0.15)
            })
            .collect();
        let camera = camera_of(
            BOXES,
            SIZE,
            &format!("kind = \"top_down\"\n{ROOT}\nband = 0.03\nregions = [{}]", many.join(", ")),
        )
        .unwrap();
        assert!(assert_seamless(&camera, 3) > 12 * 9);
        let none = camera_of(BOXES, SIZE, &format!("kind = \"top_down\"\n{ROOT}\nregions = []")).unwrap();
        let root = root();
        pixels(&none).for_each(|p| assert_straight(&none, p, &root.ray(p.0, p.1).unwrap()));
    }

    #[test]
    fn morphed_to_0_it_is_the_root_view() {
        for keys in ["morph = 0", "morph = 0.0\nforeground = true\njoin = \"bezier\""] {
            let (camera, root) = (of(keys), root());
            pixels(&camera).for_each(|p| assert_straight(&camera, p, &root.ray(p.0, p.1).unwrap()));
        }
        assert_seamless(&of("morph = 0.3"), 5);
    }

    #[test]
    fn a_cube_of_views_closes_around_the_eye() {
        for (layout, cells) in [
            ("cross", [(0, 1), (1, 1), (2, 1), (3, 1), (1, 0), (1, 2)]),
            ("strip", [(0, 0), (1, 0), (2, 0), (3, 0), (4, 0), (5, 0)]),
        ] {
            let keys = format!(
                "kind = \"top_down\"\nlayout = \"{layout}\"\neye = [1, 4, 7]\ntarget = [1, 4, 0]\nregions = []\nforeground = true"
            );
            let size = if layout == "cross" { (80, 60) } else { (120, 20) };
            let camera = camera_of(BOXES, size, &keys).unwrap();
            let looks = [(-1, 0, 0), (0, 0, -1), (1, 0, 0), (0, 0, 1), (0, 1, 0), (0, -1, 0)];
            let ups = [(0, 1, 0), (0, 1, 0), (0, 1, 0), (0, 1, 0), (0, 0, 1), (0, 0, -1)];
            for k in 0..6 {
                let ((x, y, z), (ux, uy, uz)) = (looks[k], ups[k]);
                let face = format!(
                    "kind = \"pinhole\"\neye = [1, 4, 7]\ntarget = [{}, {}, {}]\nup = [{ux}, {uy}, {uz}]\nvfov = 90",
                    1 + x,
                    4 + y,
                    7 + z
                );
                let face = camera_of(BOXES, (20, 20), &face).unwrap();
                for (i, j) in pixels(&face) {
                    let (column, row) = cells[k];
                    assert_straight(&camera, (20 * column + i, 20 * row + j), &face.ray(i, j).unwrap());
                }
            }
            let blank = pixels(&camera).filter(|(i, j)| camera.ray(*i, *j).is_none()).count();
            assert_eq!(blank as u32, size.0 * size.1 - 6 * 400);
        }
    }

    #[test]
    fn faces_of_a_cube_have_regions_of_their_own() {
        let keys = "kind = \"top_down\"\nlayout = \"cross\"\neye = [0, 4, 8]\ntarget = [0, 4, 0]\nband = 0.1\nregions = [\
                    { rect = [0.3, 0.4, 0.45, 0.6], eye = [0, 9, 9], target = [0, 1, 0] }]";
        let camera = camera_of(BOXES, SIZE, keys).unwrap();
        assert!(assert_seamless(&camera, 6) > 10);
        let own =
            camera_of(BOXES, (20, 20), "kind = \"pinhole\"\neye = [0, 9, 9]\ntarget = [0, 1, 0]\nvfov = 90").unwrap();
        for (i, j) in (24..36).flat_map(|i| (24..36).map(move |j| (i, j))) {
            assert_same(&camera, 0, (i, j), &own.ray(i - 20, j - 20).unwrap());
        }
    }

    #[test]
    fn regions_that_do_not_fit_are_errors() {
        let says = |keys: &str| refusal(BOXES, SIZE, &format!("kind = \"top_down\"\n{ROOT}\n{keys}"));
        let two =
            |a: &str, b: &str| says(&format!("regions = [{{ eye = [0, 9, 9], {a} }}, {{ eye = [0, 9, 9], {b} }}]"));
        let fine = "rect = [0.1, 0.1, 0.3, 0.3]";
        assert!(two(fine, "rect = [0.4, 0.1, 0.6, 0.3]").contains("camera.regions.1: overlaps region 0"));
        assert!(two(fine, "rect = [0.6, 0.1, 0.5, 0.3]").contains("camera.regions.1.rect: the first corner"));
        assert!(
            two(fine, "polygon = [[0.5, 0.5], [0.9, 0.9], [0.9, 0.5], [0.5, 0.9]]")
                .contains("no side crossing another")
        );
        assert!(two(fine, "polygon = [[0.5, 0.5], [0.9, 0.5], [0.5, 0.505]]").contains("too sharp or narrow"));
        assert!(
            two(fine, "polygon = [[0.5, 0.5], [0.9, 0.5], [0.5, 0.8]], rect = [0, 0, 1, 1]").contains("either rect")
        );
        assert!(two(fine, "rect = [0.6, 0.6, 0.8, 0.8], vfov = 0").contains("camera.regions.1.vfov = 0"));
        assert!(
            two(fine, "rect = [0.6, 0.6, 0.8, 0.8], target = [0, 9, 9]").contains("camera.regions.1: eye and target")
        );
        assert!(says("regions = []\nlayout = \"cross\"").contains("leave vfov out"));
        let cube = |rect: &str| {
            let root = "kind = \"top_down\"\nlayout = \"cross\"\neye = [0, 4, 8]\ntarget = [0, 4, 0]";
            refusal(BOXES, SIZE, &format!("{root}\nregions = [{{ rect = {rect}, eye = [0, 9, 9] }}]"))
        };
        assert!(cube("[0.0, 0.0, 0.1, 0.1]").contains("lies in no face"));
        assert!(cube("[0.25, 0.4, 0.45, 0.6]").contains("leaves its face"));
    }
}

//! What `track` promises: targets are seen where they would be without occluders, and where nothing hides them the view is
//! the plain one.

use crate::common;

use anamorph::internals::camera::{Camera, Curve};
use anamorph::internals::geometry::mesh::Mesh;
use anamorph::internals::scene::Scene;
use common::continuity::{POINT_ROUNDING, assert_joined, assert_seamless, assert_smooth};
use common::file::{refusal, scene_of};
use glam::{DMat3, DVec2, DVec3};

const SIZE: (u32, u32) = (80, 60);
const EYE: DVec3 = DVec3::new(0.0, 4.0, 20.0);
const VIEW: &str = "eye = [0, 4, 20]\ntarget = [0, 2, 0]\nvfov = 40";

/// A floor, and a wall of three boxes across it at z = 5.
const WALL: &str = r#"
[[mesh]]
builtin = "plane"
scale = 20
[[mesh]]
builtin = "box"
scale = [12, 4, 1]
translate = [-1, 2, 5]
[[mesh]]
builtin = "box"
scale = [1, 1, 1]
translate = [6.5, 0.5, 5]
"#;

fn scene(meshes: &str, keys: &str) -> Scene {
    scene_of(meshes, SIZE, &format!("kind = \"track\"\n{VIEW}\n{keys}")).unwrap()
}

/// The image place (px) of a point in the plain view, by the pinhole's formula.
fn place(point: DVec3) -> DVec2 {
    let f = (DVec3::new(0.0, 2.0, 0.0) - EYE).normalize();
    let r = f.cross(DVec3::Y).normalize();
    let u = r.cross(f);
    let k = 20f64.to_radians().tan();
    let v = point - EYE;
    let half = SIZE.1 as f64 / 2.0;
    DVec2::new(SIZE.0 as f64 / 2.0 + half * v.dot(r) / (k * v.dot(f)), half - half * v.dot(u) / (k * v.dot(f)))
}

/// All of the rays through an image place, layer by layer.
fn chain_at(camera: &Camera, place: DVec2) -> Vec<Curve> {
    let pixel = place.floor();
    let offset = place - pixel - 0.5;
    let moved = camera.with_sample_offset(offset.x, offset.y);
    let (i, j) = (pixel.x as u32, pixel.y as u32);
    (0..camera.layers.len()).map(|layer| moved.curve(layer, i, j).unwrap().1).collect()
}

/// Where the segment first meets the mesh, by every triangle in turn; the ends included.
fn first_hit(mesh: &Mesh, from: DVec3, to: DVec3) -> Option<f64> {
    let d = to - from;
    let hit = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|k| mesh.positions[k as usize]);
        let m = DMat3::from_cols(b - a, c - a, -d);
        if m.determinant() == 0.0 {
            return None;
        }
        let x = m.inverse() * (from - a);
        (x.x >= 0.0 && x.y >= 0.0 && x.x + x.y <= 1.0 && (0.0..=1.0).contains(&x.z)).then_some(x.z)
    };
    mesh.triangles.iter().filter_map(hit).reduce(f64::min)
}

/// Straight parts that a curve is taken for here; the camera tries its detours with fewer.
const PARTS: usize = 64;

/// Asserts that the rays at the target's plain place run to it, and meet nothing on the way but what is within `radius`.
fn assert_seen(scene: &Scene, camera: &Camera, at: DVec3, radius: f64) {
    let chain = chain_at(camera, place(at));
    let line: Vec<DVec3> = chain.iter().flat_map(|c| (0..=PARTS).map(|k| c.at(k as f64 / PARTS as f64))).collect();
    for pair in line.windows(2) {
        let segment = pair[1] - pair[0];
        let length2 = segment.length_squared();
        let t = if length2 > 0.0 { ((at - pair[0]).dot(segment) / length2).clamp(0.0, 1.0) } else { 0.0 };
        // the target's middle is on the line, at its own place: 0 px off
        let arrived = (pair[0] + t * segment - at).length() <= POINT_ROUNDING * 100.0;
        let end = if arrived { at } else { pair[1] };
        if let Some(t) = first_hit(&scene.mesh, pair[0], end) {
            let hit = pair[0].lerp(end, t);
            assert!((hit - at).length() <= radius + 1e-6, "{hit} is before {at}");
            return;
        }
        if arrived {
            return;
        }
    }
    panic!("the rays at {} miss {at}", place(at));
}

fn assert_plain(camera: &Camera, layer: usize, (i, j): (u32, u32), plain: &Camera) {
    let ray = plain.ray(i, j).unwrap();
    let e = ray.direction.normalize();
    for p in camera.curve(layer, i, j).unwrap().1.points() {
        let off = *p - ray.origin;
        assert!(
            (off - off.dot(e) * e).length() <= POINT_ROUNDING * (1.0 + p.length()) * 10.0,
            "layer {layer} at {i},{j}: {p}"
        );
    }
}

fn plain() -> Camera {
    scene_of(WALL, SIZE, &format!("kind = \"pinhole\"\n{VIEW}")).unwrap().camera().unwrap()
}

const BENDS: [&str; 4] = ["", "longitudinal = 3", "join = \"bezier\"", "bend = \"up\""];

#[test]
fn a_hidden_target_is_seen_at_its_place() {
    for keys in BENDS {
        for (at, radius) in
            [(DVec3::new(-2.0, 1.0, -3.0), 0.8), (DVec3::new(1.5, 0.7, 2.0), 0.0), (DVec3::new(-4.0, 0.5, 0.0), 0.4)]
        {
            let scene =
                scene(WALL, &format!("targets = [{{ at = {:?}, radius = {radius:?} }}]\n{keys}", at.to_array()));
            let camera = scene.camera().unwrap();
            let target_hidden = first_hit(&scene.mesh, EYE, at).is_some();
            assert!(target_hidden && camera.layers.len() >= 4, "{keys}");
            assert_seen(&scene, &camera, at, radius);
            // at the target and behind it, rays are the plain ones
            let (last, plain) = (camera.layers.len() - 1, plain());
            for (i, j) in (0..60).flat_map(|j| (0..80).map(move |i| (i, j))) {
                assert_plain(&camera, last, (i, j), &plain);
            }
        }
    }
}

#[test]
fn the_picture_has_no_seam_and_no_crossing_rays() {
    for keys in BENDS {
        let camera =
            scene(WALL, &format!("targets = [{{ at = [-2, 1, -3], radius = 0.8 }}]\n{keys}")).camera().unwrap();
        let layers = camera.layers.len();
        assert_eq!(assert_joined(&camera, 1), 3 * (layers - 1) * 80 * 60, "{keys}");
        assert!(assert_seamless(&camera, 2) > 20);
        assert!(!camera.notes.iter().any(|n| n.contains("cross")), "{keys}: {:?}", camera.notes);
    }
    assert_smooth(&scene(WALL, "targets = [{ at = [-2, 1, -3], radius = 0.8 }]\njoin = \"bezier\"").camera().unwrap());
}

#[test]
fn far_from_the_target_the_view_is_plain() {
    let camera = scene(WALL, "targets = [{ at = [-4, 0.5, 0], radius = 0.3 }]\nbend = \"up\"").camera().unwrap();
    let plain = plain();
    let at = place(DVec3::new(-4.0, 0.5, 0.0));
    // two columns of pixels on the right are more than the band away: it is as wide as the shift is high, half as much again
    for (i, j) in (0..60).flat_map(|j| [78, 79].map(|i| (i, j))) {
        assert!(i as f64 - at.x > 30.0);
        (0..camera.layers.len()).for_each(|layer| assert_plain(&camera, layer, (i, j), &plain));
    }
}

#[test]
fn where_nothing_hides_a_target_the_camera_is_the_plain_view() {
    let visible = "targets = [{ at = [0, 1, 9], radius = 0.5 }, { at = [0, 8, -3] }]";
    let (camera, plain) = (scene(WALL, visible).camera().unwrap(), plain());
    assert_eq!(camera.layers.len(), 1);
    assert_eq!(camera.t_range, plain.t_range);
    for (i, j) in (0..60).flat_map(|j| (0..80).map(move |i| (i, j))) {
        assert_eq!(camera.ray(i, j), plain.ray(i, j));
    }
    // a hidden target comes out from behind the wall: the view is plain again
    let layers = |x: f64| {
        scene(WALL, &format!("targets = [{{ at = [{x:?}, 1, 0], radius = 0.2 }}]")).camera().unwrap().layers.len()
    };
    assert_eq!([3.0, 7.6, 8.5].map(layers), [4, 1, 1]);
}

#[test]
fn several_targets_are_seen_however_they_meet_and_part() {
    // two hidden targets come together along the wall and part again, one nearer than the other
    for step in 0..=8 {
        let x = 4.0 - step as f64;
        let at = [DVec3::new(-x, 0.8, -2.0), DVec3::new(x - 1.0, 0.9, 0.5)];
        let keys = format!(
            "targets = [{{ at = {:?}, radius = 0.3 }}, {{ at = {:?}, radius = 0.3 }}]",
            at[0].to_array(),
            at[1].to_array()
        );
        let scene = scene(WALL, &keys);
        let camera = scene.camera().unwrap();
        assert!(camera.layers.len() > 4, "step {step}");
        assert_seamless(&camera, step);
        assert_joined(&camera, step);
        for (k, at) in at.into_iter().enumerate() {
            if !camera.notes.iter().any(|n| n.contains(&format!("target {k} is behind"))) {
                assert_seen(&scene, &camera, at, 0.3);
            }
        }
        // apart by more than both together, both are seen
        let apart = place(at[0]).distance(place(at[1])) > 6.0;
        assert!(!apart || !camera.notes.iter().any(|n| n.contains("is behind")), "step {step}: {:?}", camera.notes);
    }
}

#[test]
fn a_visible_target_stays_where_it_is_beside_a_hidden_one() {
    let (hidden, visible) = (DVec3::new(1.0, 0.8, 0.0), DVec3::new(1.4, 5.6, 0.0));
    let keys =
        format!("targets = [{{ at = {:?}, radius = 0.3 }}, {{ at = {:?} }}]", hidden.to_array(), visible.to_array());
    let scene = scene(WALL, &keys);
    let camera = scene.camera().unwrap();
    assert!(camera.layers.len() >= 4);
    assert_seen(&scene, &camera, hidden, 0.3);
    assert_seen(&scene, &camera, visible, 0.0);
}

#[test]
fn morphed_to_0_it_is_the_plain_view() {
    let (camera, plain) =
        (scene(WALL, "targets = [{ at = [-2, 1, -3] }]\nmorph = 0\njoin = \"bezier\"").camera().unwrap(), plain());
    for (i, j) in (0..60).flat_map(|j| (0..80).map(move |i| (i, j))) {
        (0..camera.layers.len()).for_each(|layer| assert_plain(&camera, layer, (i, j), &plain));
    }
}

#[test]
fn wrong_targets_are_errors() {
    let says = |keys: &str| refusal(WALL, SIZE, &format!("kind = \"track\"\n{VIEW}\n{keys}"));
    assert!(says("targets = [{ at = [0, 1, 0], radius = -1 }]").contains("camera.targets.0.radius"));
    assert!(says("targets = [{ at = [0, 1, 0] }]\nbend = \"around\"").contains("camera.bend: use bend"));
}

#[test]
fn unreachable_targets_leave_the_plain_view_and_the_other_targets() {
    // nothing leads into a closed box, and what is behind the eye is not in the picture
    let boxed = format!("{WALL}[[mesh]]\nbuiltin = \"box\"\nscale = 2\ntranslate = [0, 1.5, 0]\n");
    let (inside, behind, hidden) = ("{ at = [0, 1.5, 0] }", "{ at = [0, 1, 30] }", DVec3::new(-4.0, 0.5, 0.0));
    let reached = "{ at = [-4, 0.5, 0], radius = 0.4 }";
    let plain = plain();
    for (targets, says) in [
        (inside.to_owned(), vec!["target 0 is not tracked: every detour around its occluders is blocked"]),
        (behind.to_owned(), vec!["target 0 is not tracked: it lies behind or around the eye"]),
        (format!("{behind}, {inside}"), vec!["target 0 is not", "target 1 is not"]),
    ] {
        let camera = scene(&boxed, &format!("targets = [{targets}]")).camera().unwrap();
        assert_eq!(camera.unfulfilled.len(), says.len());
        assert!(
            camera.unfulfilled.iter().zip(says).all(|(request, says)| request.starts_with(says)),
            "{:?}",
            camera.unfulfilled
        );
        assert!(!camera.notes.iter().any(|note| note.contains("nothing hides")), "{:?}", camera.notes);
        for (i, j) in (0..60).flat_map(|j| (0..80).map(move |i| (i, j))) {
            assert_eq!(camera.ray(i, j), plain.ray(i, j));
        }
    }
    // a target that can be reached is tracked as if it were alone
    let all = scene(&boxed, &format!("targets = [{inside}, {reached}]"));
    let alone = scene(&boxed, &format!("targets = [{reached}]"));
    let (camera, other) = (all.camera().unwrap(), alone.camera().unwrap());
    assert_seen(&all, &camera, hidden, 0.4);
    assert!(camera.unfulfilled.len() == 1 && other.unfulfilled.is_empty());
    for (i, j) in (0..60).flat_map(|j| (0..80).map(move |i| (i, j))) {
        for layer in 0..camera.layers.len() {
            assert_eq!(camera.curve(layer, i, j), other.curve(layer, i, j));
        }
    }
}

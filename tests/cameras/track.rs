//! What `track` promises: targets are seen where they would be without occluders, and where nothing hides them the view is
//! the plain one.

use crate::common;

use anamorph::internals::camera::{Camera, Curve, Rays};
use anamorph::internals::geometry::mesh::Mesh;
use anamorph::internals::scene::Scene;
use common::continuity::{POINT_ROUNDING, assert_joined, assert_seamless, assert_smooth};
use common::file::{refusal, scene_of};
use glam::{DMat3, DVec2, DVec3};

pub(super) const SIZE: (u32, u32) = (80, 60);
const EYE: DVec3 = DVec3::new(0.0, 4.0, 20.0);
pub(super) const VIEW: &str = "eye = [0, 4, 20]\ntarget = [0, 2, 0]\nvfov = 40";

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
    scene_in(SIZE, meshes, keys)
}

pub(super) fn scene_in(size: (u32, u32), meshes: &str, keys: &str) -> Scene {
    scene_of(meshes, size, &format!("kind = \"track\"\n{VIEW}\n{keys}")).unwrap()
}

fn place(point: DVec3) -> DVec2 {
    place_in(SIZE, point)
}

/// The image place (px) of a point in the plain view, by the pinhole's formula.
pub(super) fn place_in(size: (u32, u32), point: DVec3) -> DVec2 {
    let f = (DVec3::new(0.0, 2.0, 0.0) - EYE).normalize();
    let r = f.cross(DVec3::Y).normalize();
    let u = r.cross(f);
    let k = 20f64.to_radians().tan();
    let v = point - EYE;
    let half = size.1 as f64 / 2.0;
    DVec2::new(size.0 as f64 / 2.0 + half * v.dot(r) / (k * v.dot(f)), half - half * v.dot(u) / (k * v.dot(f)))
}

/// All of the rays through an image place, layer by layer.
fn chain_at(camera: &Camera, place: DVec2) -> Vec<Curve> {
    let pixel = place.floor();
    let offset = place - pixel - 0.5;
    let moved = camera.with_sample_offset(offset.x, offset.y);
    let (i, j) = (pixel.x as u32, pixel.y as u32);
    (0..camera.layers.len()).map(|layer| moved.curve(layer, i, j).unwrap().1).collect()
}

/// Where the segment first meets the mesh, by every triangle and sphere in turn; the ends included.
fn first_hit(mesh: &Mesh, from: DVec3, to: DVec3) -> Option<f64> {
    let d = to - from;
    let hit = |(id, t): (usize, &[u32; 3])| {
        let [a, b, c] = t.map(|k| mesh.positions[k as usize]);
        if let Some(radius) = mesh.radius(id as u32) {
            let (along, off) = (d.dot(a - from), (a - from).cross(d).length_squared());
            let half = (d.length_squared() * radius * radius - off).sqrt();
            let ends = [along - half, along + half].map(|s| s / d.length_squared());
            return ends.into_iter().find(|s| (0.0..=1.0).contains(s));
        }
        let m = DMat3::from_cols(b - a, c - a, -d);
        if m.determinant() == 0.0 {
            return None;
        }
        let x = m.inverse() * (from - a);
        (x.x >= 0.0 && x.y >= 0.0 && x.x + x.y <= 1.0 && (0.0..=1.0).contains(&x.z)).then_some(x.z)
    };
    mesh.triangles.iter().enumerate().filter_map(hit).reduce(f64::min)
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

/// Spheres hide targets as boxes do, and are targets: of their own size too, which do not hide themselves.
#[test]
fn spheres_are_walked_round() {
    let at = DVec3::new(0.0, 1.0, -3.0);
    let spheres = |list: &str| format!("[[mesh]]\nbuiltin = \"plane\"\nscale = 20\n[[spheres]]\ncenters = [{list}]\n");
    let target = format!("[{}, {}, {}, 0.6]", at.x, at.y, at.z);
    let row = "[-3, 1.5, 4, 1.8], [0, 1.5, 5, 2], [3, 1.5, 6, 1.8]";
    for keys in BENDS {
        let keys = format!("targets = [{{ at = {:?}, radius = 0.6 }}]\n{keys}", at.to_array());
        let seen = scene(&spheres(&target), &keys).camera().unwrap();
        assert!(seen.layers.len() == 1 && seen.unfulfilled.is_empty(), "{keys}: {:?}", seen.unfulfilled);
        let hiding = scene(&spheres(&format!("{row}, {target}")), &keys);
        let camera = hiding.camera().unwrap();
        let hit = EYE.lerp(at, first_hit(&hiding.mesh, EYE, at).unwrap());
        assert!((hit - at).length() > 1.0 && camera.layers.len() >= 4, "{keys}: {hit} {:?}", camera.unfulfilled);
        assert_seen(&hiding, &camera, at, 0.6);
        assert_seamless(&camera, 5);
    }
    // straight before the eye a target's nearest place is as deep as its front
    let level = "kind = \"track\"\neye = [0, 1, 20]\ntarget = [0, 1, 0]\nvfov = 40\ntargets = [{ at = [0, 1, 0], radius = 0.7 }]";
    let layers = |more: &str| {
        let scene = scene_of(&spheres(&format!("[0, 1, 0, 0.7]{more}")), SIZE, level).unwrap();
        let camera = scene.camera().unwrap();
        (camera.layers.len(), camera.unfulfilled.len())
    };
    assert_eq!(layers(""), (1, 0));
    assert!(matches!(layers(", [0, 1, 9, 1]"), (4.., 0)), "{:?}", layers(", [0, 1, 9, 1]"));
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
    // a hidden target comes out from behind the wall: when it is 3.75 px beside it, the view is plain again
    let layers = |x: f64| {
        scene(WALL, &format!("targets = [{{ at = [{x:?}, 2, 0], radius = 0.2 }}]")).camera().unwrap().layers.len()
    };
    assert_eq!([3.0, 7.6, 8.5].map(layers), [4, 4, 1]);
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
    let many = vec!["{ at = [0, 1, 0] }"; 33].join(", ");
    assert!(says(&format!("targets = [{many}]")).contains("33 targets; use 32 at most"));
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

/// How deep a point lies in the view.
pub(super) fn depth(point: DVec3) -> f64 {
    (point - EYE).dot((DVec3::new(0.0, 2.0, 0.0) - EYE).normalize())
}

/// Where a pixel's rays are at so many depths.
pub(super) fn points_at(camera: &Camera, (i, j): (u32, u32), depths: impl Iterator<Item = f64>) -> Vec<DVec3> {
    let chain: Vec<Curve> = (0..camera.layers.len()).map(|layer| camera.curve(layer, i, j).unwrap().1).collect();
    let line: Vec<DVec3> = match camera.layers.len() {
        1 => vec![EYE, EYE + 100.0 * chain[0].tangent(0.0) / depth(EYE + chain[0].tangent(0.0))],
        _ => chain.iter().flat_map(|c| (0..=8).map(|k| c.at(k as f64 / 8.0))).collect(),
    };
    let at = |z: f64| {
        let at = |pair: &[DVec3]| {
            let (a, b) = (depth(pair[0]), depth(pair[1]));
            (a <= z && z <= b && a < b).then(|| pair[0].lerp(pair[1], (z - a) / (b - a)))
        };
        line.windows(2).find_map(at).unwrap_or_else(|| panic!("no depth {z} at {i},{j}"))
    };
    depths.map(at).collect()
}

/// Rays' places in a frame: in the plain view, px, for some pixels and depths.
pub(super) fn places(camera: &Camera) -> Vec<DVec2> {
    let size = (camera.width, camera.height);
    let pixels = (1..size.1).step_by(4).flat_map(|j| (1..size.0).step_by(4).map(move |i| (i, j)));
    let depths = || (2..=40).step_by(2).map(f64::from);
    pixels.flat_map(|pixel| points_at(camera, pixel, depths())).map(|p| place_in(size, p)).collect()
}

/// How far rays and targets move in the picture from frame to frame, at most, px; and the notes of all frames.
fn motion(meshes: &str, keys: &str, targets: impl Fn(f64) -> Vec<(DVec3, f64)>) -> ([f64; 2], Vec<String>) {
    let (mut last, mut most, mut notes) = (None::<(Vec<DVec2>, Vec<DVec2>)>, [0.0f64; 2], Vec::new());
    for step in 0..=48 {
        let targets = targets(step as f64 / 48.0);
        let list: Vec<String> =
            targets.iter().map(|(at, r)| format!("{{ at = {:?}, radius = {r:?} }}", at.to_array())).collect();
        let camera = scene(meshes, &format!("targets = [{}]\n{keys}", list.join(", "))).camera().unwrap();
        notes.extend(camera.unfulfilled.iter().map(|n| format!("{step}: {n}")));
        let now = (places(&camera), targets.iter().map(|(at, _)| place(*at)).collect::<Vec<_>>());
        if let Some((rays, at)) = &last {
            let moved = |a: &[DVec2], b: &[DVec2]| a.iter().zip(b).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
            let m = [moved(rays, &now.0), moved(at, &now.1)];
            most = [most[0].max(m[0]), most[1].max(m[1])];
        }
        last = Some(now);
    }
    (most, notes)
}

/// A long wall at z = 5, and a floor.
const LONG_WALL: &str = r#"
[[mesh]]
builtin = "plane"
scale = 40
[[mesh]]
builtin = "box"
scale = [60, 4, 1]
translate = [0, 2, 5]
"#;

/// A house at z = 5, as wide as high, and a floor.
pub(super) const HOUSE: &str = r#"
[[mesh]]
builtin = "plane"
scale = 40
[[mesh]]
builtin = "box"
scale = [5, 4, 1]
translate = [0, 2, 5]
"#;

/// How far rays move at most, in parts of the largest motion of a target, where one target passes before another: rays
/// change from one shift to the other over 0.7 of a core of 3.4 px, and the targets pass at twice their speed. Measured:
/// 7.0.
const PASSED: f64 = 8.0;
/// The same where something begins or ceases to hide a target: its shift, 22 px in the second case, over 1/16 of the
/// image's height, 3.75 px, is 5.9. Measured: 6.3; where shifts do not begin to grow before they are needed, 19.
const APPEARING: f64 = 7.0;

#[test]
#[ignore = "slow: make test-all"]
fn rays_move_little_while_targets_approach_pass_and_part() {
    let pass = |z: [f64; 4]| {
        move |s: f64| {
            vec![
                (DVec3::new(10.0 * s - 5.0, 0.8, z[0] + s * (z[1] - z[0])), 0.4),
                (DVec3::new(5.0 - 10.0 * s, 0.9, z[2] + s * (z[3] - z[2])), 0.4),
            ]
        }
    };
    let one = |x: [f64; 2]| move |s: f64| vec![(DVec3::new(x[0] + s * (x[1] - x[0]), 0.8, -3.0), 0.4)];
    type Path = Box<dyn Fn(f64) -> Vec<(DVec3, f64)>>;
    let cases: Vec<(&str, &str, &str, Path, f64)> = vec![
        ("pass", LONG_WALL, "bend = \"up\"", Box::new(pass([-4.0, -4.0, 0.0, 0.0])), PASSED),
        ("pass near", LONG_WALL, "bend = \"up\"", Box::new(pass([-1.0, -1.0, 0.0, 0.0])), 2.5),
        ("change order", LONG_WALL, "", Box::new(pass([-4.0, 0.0, 0.0, -4.0])), 2.5),
        ("come out", HOUSE, "bend = \"up\"", Box::new(one([0.0, 8.0])), APPEARING),
        ("from left to right", HOUSE, "", Box::new(one([-8.0, 8.0])), APPEARING),
        ("leave the picture", LONG_WALL, "bend = \"up\"", Box::new(one([0.0, 16.0])), 1.0),
    ];
    for (name, meshes, keys, path, most) in cases {
        let ([rays, targets], unfulfilled) = motion(meshes, keys, path);
        println!("{name}: rays {rays:.3} px, targets {targets:.3} px, ratio {:.2}", rays / targets);
        assert!(unfulfilled.is_empty(), "{name}: {unfulfilled:?}");
        assert!(rays <= most * targets, "{name}: rays move by {rays} px, targets by {targets} px");
    }
}

/// Pieces of the layer with the most.
fn most_pieces(camera: &Camera) -> usize {
    let of = |rays: &Rays| if let Rays::Pieces(p) = rays { p.pieces.len() } else { 0 };
    camera.layers.iter().map(of).max().unwrap()
}

#[test]
#[ignore = "slow: make test-all"]
fn segments_bound_the_pieces_of_a_picture_without_seams() {
    let (near, far) = ("{ at = [-4, 0.5, 0], radius = 0.3 }", "{ at = [2.5, 0.8, -2], radius = 0.3 }");
    let beside = "{ at = [-3.2, 0.6, -1], radius = 0.3 }";
    for (targets, segments, seen) in [
        (near.to_owned(), 9, vec![DVec3::new(-4.0, 0.5, 0.0)]),
        (near.to_owned(), 20, vec![DVec3::new(-4.0, 0.5, 0.0)]),
        (format!("{near}, {far}"), 20, vec![]),
        (format!("{near}, {beside}"), 9, vec![]),
        (format!("{near}, {beside}, {far}"), 40, vec![]),
    ] {
        for bend in ["bend = \"up\"", "join = \"bezier\""] {
            let scene = scene(WALL, &format!("targets = [{targets}]\nsegments = {segments}\n{bend}"));
            let camera = scene.camera().unwrap();
            assert!(camera.layers.len() >= 4, "{targets}: {:?}", camera.unfulfilled);
            assert!(most_pieces(&camera) <= 2 * segments, "{targets}: {} pieces", most_pieces(&camera));
            assert_joined(&camera, 3);
            assert!(assert_seamless(&camera, 4) > 10);
            assert!((0..60).all(|j| (0..80).all(|i| camera.curve(0, i, j).is_some())));
            seen.iter().for_each(|at| assert_seen(&scene, &camera, *at, 0.3));
        }
    }
    // a core, four segments around it, four around those
    let few = scene(WALL, &format!("targets = [{near}]\nsegments = 9")).camera().unwrap();
    assert_eq!(most_pieces(&few), 18);
    let says = refusal(WALL, SIZE, &format!("kind = \"track\"\n{VIEW}\ntargets = [{near}]\nsegments = 8"));
    assert!(says.contains("camera.segments") && says.contains("from 9 to"), "{says}");
}

#[test]
fn more_hidden_targets_than_layers_leave_the_last_in_the_plain_view() {
    let target = |k: usize| format!("{{ at = [{}, 0.5, {}], radius = 0.1 }}", k as f64 - 5.0, 0.3 * k as f64 - 3.0);
    let list: Vec<String> = (0..7).map(target).collect();
    let camera = scene(LONG_WALL, &format!("targets = [{}]", list.join(", "))).camera().unwrap();
    assert!(camera.layers.len() <= 16);
    assert_eq!(camera.unfulfilled.len(), 2, "{:?}", camera.unfulfilled);
    let says = |k: usize| format!("target {k} is not tracked: with it, rays would have");
    assert!(camera.unfulfilled[0].starts_with(&says(6)) && camera.unfulfilled[1].starts_with(&says(5)));
}

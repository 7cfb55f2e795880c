//! Composites whose cameras show objects of their own (`master`, `objects`), let others show where they hit nothing, or are blended across
//! borders (`feather`): closed forms, one camera's own frames, and frames against the reference.

use super::composite::{OWN_SIZE, composite_of, straight_and_ended, write_mask};
use super::project_named::BOX;
use crate::common;

use anamorph::internals::camera::Camera;
use anamorph::internals::camera::composition::Composition;
use anamorph::internals::camera::exposure::{Exposure, LineOrder, Lines, Readout};
use anamorph::internals::engine::Rendered;
use anamorph::internals::engine::RunOptions;
use anamorph::internals::engine::plan::Wanted;
use anamorph::internals::geometry::generate;
use anamorph::internals::geometry::load::Object;
use anamorph::internals::geometry::mesh::Mesh;
use anamorph::internals::geometry::place::merge;
use anamorph::internals::geometry::time_steps::{TimeStep, TimeSteps};
use anamorph::internals::image::frame::{Channel, Frame, NO_ID, Plane};
use anamorph::internals::reference::image::{explain, image};
use anamorph::internals::scene::Scene;
use anamorph::internals::scene::light::{AmbientOcclusion, Light};
use common::file::{camera_of, load};
use common::gpu::{check, engine_on, hits};
use common::rng::Rng;
use common::soup;
use common::written::{assert_refused, camera};
use glam::{DVec2, DVec3};
use std::sync::Arc;

const SIZE: (u32, u32) = (64, 48);

const FRONT: &str = "{ kind = 'pinhole', eye = [0, 0, 4], target = [0, 0, 0], vfov = 40 }";
/// From the right, so that the same places of the image show other places of the scene.
const RIGHT: &str = "{ kind = 'pinhole', eye = [3, 0.5, 3], target = [0.3, 0, 0], vfov = 40 }";
const SLITS: &str = "{ kind = 'cross_slit', slits = [{ distance = 4, angle = 20 }, { distance = 2.5, angle = 100 }], \
                     eye = [0, 0, 4], target = [0, 0, 0], height = 2 }";
const FISHEYE: &str = "{ kind = 'fisheye', eye = [0.1, 0.2, 3], target = [0, 0, 0], fov = 120, frame = 'full' }";
const ABOVE: &str = "{ kind = 'orthographic', eye = [0, 4, 0], target = [0, 0, 0], up = [0, 0, -1], height = 3 }";
const CURVED: &str =
    "{ kind = 'twist', eye = [0, 0, 4], target = [0, 0, 0], angle = 60, near = 1, far = 7, degree = 3 }";

fn composite(rest: &str, members: &[String]) -> String {
    let tables: Vec<String> = members.iter().map(|member| format!("{{ {member} }}")).collect();
    format!("kind = 'composite'\n{rest}\ncameras = [{}]", tables.join(", "))
}

fn member(of: &str, keys: &str) -> String {
    format!("camera = {of}{}{keys}", if keys.is_empty() { "" } else { ", " })
}

/// A scene of these objects.
fn scene_of(objects: Vec<(&str, Mesh)>) -> Scene {
    let names: Vec<Object> =
        objects.iter().map(|(name, mesh)| Object { name: (*name).into(), triangles: mesh.triangles.len() }).collect();
    let meshes = objects.into_iter().map(|(_, mesh)| mesh).collect();
    Scene { objects: names, ..common::scene(merge(meshes).unwrap()) }
}

fn moved(mut mesh: Mesh, by: DVec3, scale: f64) -> Mesh {
    mesh.positions.iter_mut().for_each(|p| *p = scale * *p + by);
    mesh
}

/// An exact sphere: it takes the place of a triangle.
fn sphere(centre: DVec3, radius: f64) -> Mesh {
    let mut mesh = generate::icosphere(0);
    mesh.positions = vec![centre];
    mesh.triangles = vec![[0; 3]];
    mesh.radii = vec![radius];
    (mesh.normals, mesh.corner_normals) = (Vec::new(), Vec::new());
    mesh.material_of.truncate(1);
    mesh
}

/// All channels but `certified`, and the picture.
fn everything(scene: &Scene, camera: &Camera) -> Wanted {
    Wanted { srgb8: true, ..Wanted::of(scene.channels(camera)) }
}

fn rendered(scene: &Scene, camera: &Camera) -> Option<Rendered> {
    let mut engine = engine_on(|_| {})?;
    Some(engine.render(scene, camera, &everything(scene, camera), &RunOptions::default()).unwrap())
}

/// The words of a channel.
fn words(rendered: &Rendered, channel: Channel) -> Vec<u32> {
    match rendered.frame.planes.iter().find(|(c, _)| *c == channel) {
        Some((_, Plane::F32(values))) => values.iter().map(|v| v.to_bits()).collect(),
        Some((_, Plane::U32(values))) => values.clone(),
        None => panic!("{channel:?} is missing"),
    }
}

fn composition(camera: &Camera) -> &Composition {
    camera.composition.as_ref().unwrap()
}

/// The rows of an image are taken one after the other during a frame.
fn row_by_row() -> Exposure {
    let lines = Lines { first: 0.0, line_time: 1.0 / f64::from(SIZE.1), order: LineOrder::Down, count: SIZE.1 };
    Exposure { readout: Readout::Lines(lines), shutter: 0.0, is_even: false }
}

/// Two cameras see moving objects, each pixel at its own time: the master's depths are those of that time, too.
#[test]
fn moving_objects_hide_each_other_by_their_places_at_the_time_of_the_pixel() {
    let mut rng = Rng(4);
    let cloud = |rng: &mut Rng| soup(rng, 150, 0.5);
    let mut scene = scene_of(vec![("a", cloud(&mut rng)), ("b", cloud(&mut rng)), ("ball", sphere(DVec3::Z, 0.4))]);
    let objects = &scene.objects;
    let first_of_b = 3 * objects[0].triangles;
    // b passes through a, towards the first camera, while the rows are taken
    let at = |z: f64| TimeStep {
        positions: (0..scene.mesh.positions.len())
            .map(|k| scene.mesh.positions[k] + DVec3::Z * if k < first_of_b { 0.0 } else { z })
            .collect(),
        normals: scene.mesh.normals.clone(),
    };
    scene.steps = TimeSteps::new(vec![0.0, 1.0], vec![at(-1.5), at(1.5)]).map(Arc::new);
    let still = scene.clone();
    scene.exposure = row_by_row();
    for (name, members) in [
        ("pieces", [member(FRONT, "objects = ['a']"), member(RIGHT, "objects = ['b', 'ball']")]),
        ("curves and a field", [member(FISHEYE, "objects = ['b', 'ball']"), member(CURVED, "objects = ['a']")]),
    ] {
        let camera = camera_of("", SIZE, &composite("master = 0", &members)).unwrap();
        let Some((frame, ..)) = check(name, &scene, &camera) else { return };
        let owners = |k: u32| frame.u32(Channel::PieceId).unwrap().iter().filter(|id| **id == k).count();
        assert!(owners(0) > 200 && owners(1) > 200, "{name}: {} and {}", owners(0), owners(1));
        let of_start = image(&still, &camera, &[Channel::TriangleId]);
        let moved = frame.u32(Channel::TriangleId).unwrap().iter().zip(of_start.u32(Channel::TriangleId).unwrap());
        assert!(moved.filter(|(a, b)| a != b).count() > 300, "{name}: nothing moved");
    }
}

/// The place where a ray enters a sphere.
fn entered(camera: &Camera, (i, j): (u32, u32), (centre, radius): (DVec3, f64)) -> Option<DVec3> {
    let ray = camera.ray(i, j)?;
    let (d, m) = (ray.direction.normalize(), centre - ray.origin);
    let under = radius * radius - m.cross(d).length_squared();
    (under >= 0.0 && m.dot(d) > 0.0).then(|| ray.origin + (m.dot(d) - under.sqrt()) * d)
}

#[test]
fn of_two_spheres_seen_by_two_cameras_the_one_nearer_to_the_master_hides_the_other() {
    // the second camera sees its sphere where the first one sees its own; which is nearer changes from one side to the other
    let balls = [(DVec3::new(-0.6, -0.2, 0.4), 0.6), (DVec3::new(-0.7, 0.0, 0.4), 0.7)];
    let scene = scene_of(vec![("a", sphere(balls[0].0, balls[0].1)), ("b", sphere(balls[1].0, balls[1].1))]);
    let members = [member(FRONT, "objects = ['a']"), member(RIGHT, "objects = ['b']")];
    for master in [0, 1] {
        let camera = camera(&composite(&format!("master = {master}"), &members), SIZE);
        let both = &composition(&camera).members;
        let reference = image(&scene, &camera, &[Channel::TriangleId, Channel::PieceId]);
        let frame = rendered(&scene, &camera);
        let mut seen = [0; 6];
        for (i, j) in (0..SIZE.1).flat_map(|j| (0..SIZE.0).map(move |i| (i, j))) {
            let hits = [0, 1].map(|k| entered(&both[k].camera, (i, j), balls[k]));
            let ray = both[master].camera.ray(i, j).unwrap();
            let depth = |x: DVec3| (x - ray.origin).dot(ray.direction.normalize());
            let (owner, class) = match hits {
                [None, None] => (None, 0),
                [Some(_), None] => (Some(0), 1),
                [None, Some(_)] => (Some(1), 2),
                [Some(a), Some(b)] if depth(a) <= depth(b) => (Some(0), 3),
                [Some(_), Some(_)] => (Some(1), 4),
            };
            seen[class] += 1;
            // the other one's own depth, from its own eye, would choose otherwise
            if let [Some(a), Some(b)] = hits {
                let own = [(a, 0), (b, 1)].map(|(x, k)| (x - both[k].camera.ray(i, j).unwrap().origin).length());
                seen[5] += usize::from((own[0] <= own[1]) != (depth(a) <= depth(b)));
            }
            let at = (j * SIZE.0 + i) as usize;
            let id = owner.map_or(NO_ID, |k| k as u32);
            assert_eq!(reference.u32(Channel::TriangleId).unwrap()[at], id, "{i},{j} by the reference");
            assert_eq!(reference.u32(Channel::PieceId).unwrap()[at], id, "{i},{j} by the reference");
            assert_eq!(explain(&scene, &camera, i, j).triangle, owner.map(|k| k as u32), "{i},{j}");
            let Some(frame) = &frame else { continue };
            let f32s = |channel| frame.frame.f32(channel).unwrap()[at];
            assert_eq!(frame.frame.u32(Channel::TriangleId).unwrap()[at], id, "{i},{j}");
            assert_eq!(frame.frame.u32(Channel::PieceId).unwrap()[at], id, "{i},{j}");
            assert_eq!(frame.frame.u32(Channel::ObjectId).unwrap()[at], id, "{i},{j}");
            if let Some(x) = owner.and_then(|k| hits[k]) {
                let place = [Channel::PositionX, Channel::PositionY, Channel::PositionZ].map(f32s);
                assert!((DVec3::from(place.map(f64::from)) - x).length() < 1e-4, "{i},{j}: {place:?}, not {x}");
            }
        }
        println!("master {master}: {seen:?}");
        assert!(seen.iter().all(|count| *count > 20), "{seen:?}");
    }
}

/// Balls and a cloud of triangles over a floor, some behind others.
fn still_life() -> Scene {
    let ball = |x: f64, y: f64, z: f64, r: f64| moved(generate::icosphere(3), DVec3::new(x, y, z), r);
    let mut floor = generate::icosphere(0);
    floor.positions = [(-2.0, -2.0), (2.0, -2.0), (2.0, 2.0), (-2.0, 2.0)].map(|(x, z)| DVec3::new(x, -0.8, z)).into();
    floor.triangles = vec![[0, 2, 1], [0, 3, 2]];
    (floor.normals, floor.corner_normals) = (Vec::new(), Vec::new());
    floor.material_of.truncate(2);
    scene_of(vec![
        ("floor", floor),
        ("ball#0", ball(-0.5, -0.3, 0.4, 0.5)),
        ("ball#1", ball(0.6, -0.2, -0.2, 0.6)),
        ("cloud", soup(&mut Rng(7), 160, 0.3)),
    ])
}

#[test]
fn frames_are_right_by_margin() {
    let scene = still_life();
    let star = "region = { kind = 'polygon', points = [[0.5, 0.05], [0.6, 0.4], [0.95, 0.5], [0.6, 0.6], [0.5, 0.95], [0.05, 0.5]] }";
    let box_ = "region = { kind = 'rectangle', from = [0.2, 0.3], to = [0.8, 0.85] }";
    let three = [member(FRONT, ""), member(RIGHT, "objects = ['ball']"), member(SLITS, "objects = ['cl*d']")];
    let ranked = [
        member(FRONT, "objects = ['ball#0', 'floor'], priority = 1"),
        member(RIGHT, &format!("objects = ['ball#1'], priority = 2, {star}, feather = 6")),
        member(FISHEYE, "objects = ['*'], priority = -1"),
    ];
    let framed = [
        member(ABOVE, &format!("objects = ['cloud'], frame = 'region', {box_}, feather = 3.5")),
        member(FRONT, "objects = ['ball']"),
        member(CURVED, "objects = ['*'], priority = -1"),
    ];
    let feathered = [
        member(ABOVE, &format!("{star}, feather = 5")),
        member(FISHEYE, &format!("{box_}, feather = 9.5")),
        member(FRONT, ""),
    ];
    for (name, rest, members) in [
        ("objects", "master = 0", &three),
        ("by the slits", "master = 2", &three),
        ("ranked", "master = 0", &ranked),
        ("framed, before a curved one", "master = 0", &framed),
        ("feathered", "", &feathered),
    ] {
        let camera = camera(&composite(rest, members), SIZE);
        let Some((counts, hits)) = composed(name, &scene, &camera) else { return };
        assert!(hits > 700 && counts.iter().all(|count| *count > 20), "{name}: {counts:?} {hits}");
    }
}

/// Asserts that the frame of a camera of three is right; how many pixels show each of the three, and how many hit something.
fn composed(name: &str, scene: &Scene, camera: &Camera) -> Option<([usize; 3], usize)> {
    assert!(camera.layered().is_some());
    let (frame, judged, seen) = check(name, scene, camera)?;
    let safe = judged.safe.iter().filter(|is_safe| **is_safe).count();
    let pieces = frame.u32(Channel::PieceId).unwrap();
    let counts = [0, 1, 2].map(|k| pieces.iter().filter(|piece| **piece == k).count());
    println!("{name}: {} hits, {safe} safe, {counts:?}, {seen}", hits(&frame));
    // colours, to what the host's rounding of a sum of two shares may be off
    let off = [Channel::R, Channel::G, Channel::B].map(|channel| {
        let (a, b) = (frame.f32(channel).unwrap(), judged.truth.f32(channel).unwrap());
        let both = a.iter().zip(b).zip(&judged.safe).filter(|(_, is_safe)| **is_safe);
        both.map(|((a, b), _)| (a - b).abs()).fold(0f32, f32::max)
    });
    println!("{name}: colours off by {off:?}");
    assert!(safe > 1500 && off.iter().all(|off| *off < COLOUR_ERROR), "{name}: {safe} {off:?}");
    Some((counts, hits(&frame)))
}

/// Three to each composite, from all over a list of cameras of every kind, all of which are seen.
#[test]
fn cameras_of_every_kind_show_objects_of_their_own() {
    let folder = tempfile::tempdir().unwrap();
    let [straight, ended] = straight_and_ended(folder.path());
    let star =
        "region = { kind = 'polygon', points = [[0.5, 0], [0.6, 0.4], [1, 0.5], [0.6, 0.6], [0.5, 1], [0, 0.5]] }";
    let box_ = "region = { kind = 'rectangle', from = [0.2, 0.3], to = [0.8, 0.85] }";
    let objects = ["", "objects = ['ball']", "objects = ['cl*d']"].map(String::from);
    let behind = ["objects = ['*']\npriority = -1", "objects = ['ball']", "objects = ['cl*d']"].map(String::from);
    let ranked = [
        behind[0].clone(),
        format!("objects = ['ball#1']\npriority = 2\n{star}\nfeather = 6"),
        "objects = ['ball#0', 'floor']\npriority = 1".into(),
    ];
    let feathered =
        [String::new(), format!("priority = 2\n{star}\nfeather = 5"), format!("priority = 1\n{box_}\nfeather = 9.5")];
    let scene = still_life();
    let mut number = 0;
    for (list, ways) in [
        (&straight, [("master = 0", &objects), ("master = 2", &ranked), ("", &feathered)]),
        (&ended, [("", &feathered), ("master = 0", &behind), ("", &feathered)]),
    ] {
        let count = list.len().div_ceil(3);
        for k in 0..count {
            let (rest, keys) = ways[k % 3];
            let mut three = [0, 1, 2].map(|n| &list[(k + n * count) % list.len()]);
            if rest == "master = 0" {
                // a master's rays are straight; its t needs no end
                three[0] = &straight[k];
            }
            let own = three.iter().zip(keys).map(|((camera, _), keys)| (camera.as_str(), keys.clone()));
            let camera = camera_of(BOX, OWN_SIZE, &composite_of(rest, own)).unwrap();
            let name = format!("{rest} {:?}", three.map(|(_, camera)| camera.kind));
            let Some((counts, hits)) = composed(&name, &scene, &camera) else { return };
            assert!(hits > 700 && counts.iter().all(|count| *count > 20), "{name}: {counts:?} {hits}");
            number += 1;
        }
    }
    assert!(number >= 12, "{number} composites");
}

/// A headlight's colour at safe pixels: cosines of normals and views in f32.
const COLOUR_ERROR: f32 = 1e-4;

/// The light of a scene in which objects cast shadows on each other.
fn lit(scene: Scene) -> Scene {
    let light = Light { casts_shadows: true, ..Light::distant(DVec3::new(-1.0, -2.0, -1.5)) };
    Scene { lights: vec![light], ambient_occlusion: Some(AmbientOcclusion { rays: 8, reach: 1.0 }), ..scene }
}

#[test]
fn equal_cameras_show_what_one_shows_with_the_shadows_of_all() {
    assert_equal_cameras_show_what_one_shows(&lit(still_life()));
}

/// What a camera does not show casts its shadow from where it is at the time of the pixel.
#[test]
fn equal_cameras_show_what_one_shows_of_moving_things() {
    let mut scene = lit(still_life());
    let mesh = &scene.mesh;
    let at = |x: f64| TimeStep {
        positions: mesh
            .positions
            .iter()
            .enumerate()
            .map(|(k, p)| *p + DVec3::X * if k < 4 { 0.0 } else { x })
            .collect(),
        normals: mesh.normals.clone(),
    };
    scene.steps = TimeSteps::new(vec![0.0, 1.0], vec![at(-0.6), at(0.6)]).map(Arc::new);
    scene.exposure = row_by_row();
    assert_equal_cameras_show_what_one_shows(&scene);
}

fn assert_equal_cameras_show_what_one_shows(scene: &Scene) {
    let members = [member(FRONT, ""), member(FRONT, "objects = ['ball']"), member(FRONT, "objects = ['cloud']")];
    let composed = camera(&composite("master = 0", &members), SIZE);
    let one = composition(&composed).members[0].camera.clone();
    let channels = [Channel::TriangleId, Channel::ObjectId, Channel::R, Channel::G, Channel::B];
    let [by_three, by_one] = [&composed, &*one].map(|camera| image(scene, camera, &channels));
    assert_eq!(by_three.planes, by_one.planes);
    let lonely = scene.of_each_camera(composition(&composed))[1].clone().into_owned();
    let lonely = image(&Scene { casters: None, ..lonely }, &one, &channels);
    let differ = |k: usize| lonely.f32(Channel::R).unwrap()[k] != by_one.f32(Channel::R).unwrap()[k];
    let ids = (by_one.u32(Channel::TriangleId).unwrap(), lonely.u32(Channel::TriangleId).unwrap());
    let shaded = (0..ids.0.len()).filter(|k| ids.0[*k] == ids.1[*k] && ids.0[*k] != NO_ID && differ(*k)).count();
    assert!(shaded > 30, "shadows of others at {shaded} pixels");
    let (Some(by_three), Some(by_one)) = (rendered(scene, &composed), rendered(scene, &one)) else { return };
    for channel in [Channel::TriangleId, Channel::ObjectId, Channel::R, Channel::G, Channel::B, Channel::A] {
        assert_eq!(words(&by_three, channel), words(&by_one, channel), "{channel:?}");
    }
    assert_eq!(by_three.srgb8, by_one.srgb8);
}

#[test]
fn a_camera_that_hits_nothing_lets_the_next_one_show() {
    let scene = still_life();
    let members = [member(CURVED, "objects = ['*']"), member(RIGHT, "objects = ['ball#1'], priority = 1")];
    let camera = camera(&composite("master = 1", &members), SIZE);
    let [curved, right] = [0, 1].map(|k| composition(&camera).members[k].camera.clone());
    let scenes = scene.of_each_camera(composition(&camera));
    let frames = (rendered(&scene, &camera), rendered(&scene, &curved), rendered(&scenes[1], &right));
    let (Some(composed), Some(behind), Some(front)) = frames else { return };
    let ids = words(&front, Channel::TriangleId);
    let hits = ids.iter().filter(|id| **id != NO_ID).count();
    assert!(hits > 200 && ids.len() - hits > 1000, "{hits}");
    for channel in scene.channels(&camera).into_iter().filter(|c| *c != Channel::PieceId) {
        let (own, a, b) = (words(&composed, channel), words(&front, channel), words(&behind, channel));
        for k in 0..ids.len() {
            let expected = if ids[k] == NO_ID { b[k] } else { a[k] };
            assert_eq!(own[k], expected, "{channel:?} at {k}");
        }
    }
    let picture = |rendered: &Rendered, k: usize| rendered.srgb8.as_ref().unwrap()[4 * k..4 * k + 4].to_vec();
    for (k, id) in ids.iter().enumerate() {
        assert_eq!(picture(&composed, k), picture(if *id == NO_ID { &behind } else { &front }, k), "{k}");
    }
}

#[test]
fn what_no_camera_names_is_seen_by_the_master() {
    let scene = still_life();
    for (members, expected) in [
        // all name some: the floor is the master's, as well as its own
        (
            ["objects = ['cloud']", "objects = ['ball']"],
            [vec![true, false, false, true], vec![false, true, true, false]],
        ),
        // one names none: the rest is its own
        (["objects = ['cloud']", ""], [vec![false, false, false, true], vec![true, true, true, false]]),
        (["", "objects = ['ball#1', 'cloud']"], [vec![true, true, false, false], vec![false, false, true, true]]),
        (["objects = ['*']", ""], [vec![true; 4], vec![false; 4]]),
        (["objects = ['*']", "objects = ['ball']"], [vec![true; 4], vec![false, true, true, false]]),
        (["", ""], [vec![true; 4], vec![true; 4]]),
        // a master that names nothing shows nothing
        (["objects = []", ""], [vec![false; 4], vec![true; 4]]),
        (["objects = []", "objects = ['ball']"], [vec![false; 4], vec![false, true, true, false]]),
    ] {
        let members = [member(FRONT, members[0]), member(RIGHT, members[1])];
        let camera = camera(&composite("master = 0", &members), SIZE);
        assert_eq!(composition(&camera).shows(&scene.objects), expected, "{members:?}");
        for (own, shows) in scene.of_each_camera(composition(&camera)).iter().zip(&expected) {
            assert_eq!(own.mesh.triangles.len(), scene.mesh.triangles.len());
            assert_eq!(own.casters.is_some(), !shows.iter().all(|is_shown| *is_shown));
        }
    }
}

/// It decides what hides what as a master would that shows something.
#[test]
fn a_master_may_be_there_for_its_depth_alone() {
    let scene = still_life();
    let shown = [member(FRONT, "objects = ['ball']"), member(RIGHT, "")];
    let with_helper = [&[member(FRONT, "objects = []")], &shown[..]].concat();
    let [plain, helped] = [&shown[..], &with_helper].map(|members| camera(&composite("master = 0", members), SIZE));
    let Some((counts, _)) = composed("helped", &scene, &helped) else { return };
    assert!(counts[0] == 0 && counts[1] > 100 && counts[2] > 100, "{counts:?}");
    let [Some(plain_frame), Some(frame)] = [&plain, &helped].map(|camera| rendered(&scene, camera)) else { return };
    for channel in scene.channels(&helped) {
        let pairs = std::iter::zip(words(&plain_frame, channel), words(&frame, channel));
        let next = |k: u32| if channel == Channel::PieceId && k != NO_ID { k + 1 } else { k };
        assert!(pairs.into_iter().all(|(a, b)| next(a) == b), "{channel:?}");
    }
}

#[test]
fn colours_are_blended_across_a_border_and_nothing_else_is() {
    // one wall that glows, seen by a camera in front of it, and another one by one behind
    let wall = |z: f64, colour: [f32; 3]| {
        let mut mesh = generate::icosphere(0);
        mesh.positions = [(-9.0, -9.0), (9.0, -9.0), (9.0, 9.0), (-9.0, 9.0)].map(|(x, y)| DVec3::new(x, y, z)).into();
        mesh.triangles = vec![[0, 1, 2], [0, 2, 3]];
        (mesh.normals, mesh.corner_normals) = (Vec::new(), Vec::new());
        mesh.material_of.truncate(2);
        for material in &mut mesh.materials {
            (material.diffuse, material.emissive) = ([0.0; 3], colour);
        }
        mesh
    };
    let (red, blue) = ([0.75, 0.25, 0.0], [0.0, 0.5, 1.0]);
    let scene = scene_of(vec![("red", wall(-1.0, red)), ("blue", wall(1.0, blue))]);
    let to_red = "{ kind = 'pinhole', eye = [0, 0, 0], target = [0, 0, -1], vfov = 60 }";
    let to_blue = "{ kind = 'pinhole', eye = [0, 0, 0], target = [0, 0, 1], vfov = 60 }";
    let folder = tempfile::tempdir().unwrap();
    // the middle quarter of the image, of four texels, and of many that are not square
    let masks = [(4, 4), (12, 16)].map(|(w, h)| {
        let is_in = |x: u32, y: u32| (w / 4..3 * w / 4).contains(&x) && (h / 4..3 * h / 4).contains(&y);
        let folder = folder.path().join(format!("{w}"));
        std::fs::create_dir(&folder).unwrap();
        write_mask(&folder, (w, h), is_in);
        format!("region = {{ kind = 'mask', file = '{}/mask.png' }}", folder.display())
    });
    let rectangle = "region = { kind = 'rectangle', from = [0.25, 0.25], to = [0.75, 0.75] }";
    let [low, high] = [DVec2::new(16.0, 12.0), DVec2::new(48.0, 36.0)];
    for (region, feather, master) in [
        (rectangle, 0.0, ""),
        (rectangle, 8.0, ""),
        (rectangle, 5.5, ""),
        (rectangle, 8.0, "master = 0"),
        (&masks[0], 8.0, ""),
        (&masks[1], 11.0, ""),
    ] {
        let keys = format!("{region}, priority = 1, feather = {feather:?}");
        let camera = camera(&composite(master, &[member(to_blue, ""), member(to_red, &keys)]), SIZE);
        assert_eq!(camera.layered().is_some(), feather > 0.0 || !master.is_empty());
        let truth =
            image(&scene, &camera, &[Channel::R, Channel::G, Channel::B, Channel::TriangleId, Channel::PieceId]);
        let frame = rendered(&scene, &camera).map(|rendered| rendered.frame);
        let mut blended = 0;
        for (i, j) in (0..SIZE.1).flat_map(|j| (0..SIZE.0).map(move |i| (i, j))) {
            let place = DVec2::new(f64::from(i) + 0.5, f64::from(j) + 0.5);
            // inside the distance to the nearest side, outside that to the rectangle
            let inside = (place - low).min(high - place).min_element();
            let outside = (low - place).max(place - high).max(DVec2::ZERO).length();
            let depth = if outside > 0.0 { -outside } else { inside };
            let is_in = depth >= 0.0;
            let share =
                if feather > 0.0 { (0.5 + depth / feather).clamp(0.0, 1.0) } else { f64::from(u8::from(is_in)) };
            blended += usize::from(share > 0.0 && share < 1.0);
            let at = (j * SIZE.0 + i) as usize;
            for frame in [Some(&truth), frame.as_ref()].into_iter().flatten() {
                for (k, channel) in [Channel::R, Channel::G, Channel::B].into_iter().enumerate() {
                    let expected = share * f64::from(red[k]) + (1.0 - share) * f64::from(blue[k]);
                    let got = f64::from(frame.f32(channel).unwrap()[at]);
                    assert!((got - expected).abs() < 1e-6, "{feather} {i},{j} {channel:?}: {got}, not {expected}");
                }
                assert_eq!(frame.u32(Channel::PieceId).unwrap()[at], u32::from(is_in), "{i},{j}");
                assert_eq!(frame.u32(Channel::TriangleId).unwrap()[at] < 2, is_in, "{i},{j}");
            }
        }
        assert_eq!(blended > 100, feather > 0.0, "{blended}");
    }
}

/// Two roundings to 2^-24 of coordinates within 8 units of a camera.
const ROUNDING: f32 = 16.0 / (1 << 24) as f32;

#[test]
fn channels_but_colours_are_those_without_a_feather() {
    let scene = still_life();
    let star = "region = { kind = 'polygon', points = [[0.5, 0.05], [0.6, 0.4], [0.95, 0.5], [0.6, 0.6], [0.5, 0.95], [0.05, 0.5]] }";
    let of = |camera: &str| camera.replace(" }", ", t_range = [0, 9] }");
    for (a, b) in [(FISHEYE.to_owned(), FRONT.to_owned()), (of(FRONT), CURVED.to_owned())] {
        let cameras = ["", ", feather = 9"]
            .map(|keys| camera(&composite("", &[member(&a, &format!("{star}{keys}")), member(&b, "")]), SIZE));
        let [Some(plain), Some(feathered)] = [0, 1].map(|k| rendered(&scene, &cameras[k])) else { return };
        assert!(cameras[0].layered().is_none() && cameras[1].layered().is_some());
        // by how much a normal turns when a corner of its triangle moves: twice the inverse of the least height
        let tilt = |id: u32| {
            if id == NO_ID {
                return 1.0;
            }
            let [a, b, c] = scene.corners_at(id, Default::default());
            let longest = (b - a).length().max((c - b).length()).max((a - c).length());
            (2.0 * longest / (b - a).cross(c - a).length()).max(1.0) as f32
        };
        let tilts: Vec<f32> = words(&plain, Channel::TriangleId).into_iter().map(tilt).collect();
        for channel in scene.channels(&cameras[0]) {
            let is_colour = matches!(channel, Channel::R | Channel::G | Channel::B);
            let pairs = std::iter::zip(words(&plain, channel), words(&feathered, channel));
            // what is found in f64 has the same bits; the rest is rounded relative to where each camera is
            let differ = match (channel.is_id(), channel) {
                (true, _) | (_, Channel::A | Channel::Z | Channel::T | Channel::BaryU | Channel::BaryV) => {
                    pairs.filter(|(a, b)| a != b).count()
                }
                _ => {
                    let off = pairs.map(|(a, b)| (f32::from_bits(a) - f32::from_bits(b)).abs());
                    off.zip(&tilts).filter(|(off, tilt)| *off > ROUNDING * **tilt).count()
                }
            };
            assert_eq!(differ > 0, is_colour, "{a} {channel:?}: {differ} pixels differ");
        }
    }
}

#[test]
fn the_number_of_its_camera_is_each_pixels_piece() {
    let scene = still_life();
    let box_ = |x: f64| format!("region = {{ kind = 'rectangle', from = [{x:?}, 0], to = [1, 1] }}");
    for (members, is_curved) in [
        (
            [
                member(FRONT, "priority = -1"),
                member(ABOVE, &box_(0.5)),
                member(SLITS, &format!("priority = 1, {}", box_(0.75))),
            ],
            false,
        ),
        (
            [
                member(CURVED, "priority = -1"),
                member(&FRONT.replace(" }", ", t_range = [0, 9] }"), &box_(0.5)),
                member(&ABOVE.replace(" }", ", t_range = [0, 9] }"), &format!("priority = 1, {}", box_(0.75))),
            ],
            true,
        ),
    ] {
        let camera = camera(&composite("", &members), SIZE);
        assert!(camera.is_curved() == is_curved && camera.layered().is_none());
        let truth = image(&scene, &camera, &[Channel::PieceId, Channel::TriangleId]);
        let frame = rendered(&scene, &camera).map(|rendered| rendered.frame);
        for frame in [Some(&truth), frame.as_ref()].into_iter().flatten() {
            let (pieces, ids) = (frame.u32(Channel::PieceId).unwrap(), frame.u32(Channel::TriangleId).unwrap());
            let mut counts = [0; 3];
            for (k, (piece, id)) in pieces.iter().zip(ids).enumerate().filter(|(_, (_, id))| **id != NO_ID) {
                let expected = [0, 0, 1, 2][k % SIZE.0 as usize / 16];
                assert_eq!(*piece, expected, "{k} sees {id}");
                counts[expected as usize] += 1;
            }
            assert!(counts.iter().all(|count| *count > 50), "{counts:?}");
        }
    }
}

#[test]
fn samples_are_composed_one_by_one() {
    use anamorph::internals::jobs::Backend;
    let scene = still_life();
    let members = [member(FRONT, ""), member(RIGHT, "objects = ['ball']")];
    let camera: Arc<Camera> = Arc::new(camera(&composite("master = 0", &members), SIZE));
    let Some(mut engine) = engine_on(|_| {}) else { return };
    let wanted = everything(&scene, &camera);
    let several = Wanted { samples: 4, ..wanted.clone() };
    let of =
        |backend: &mut Backend| backend.render(&scene, &camera, &several, &RunOptions::default(), &mut |_| {}).unwrap();
    let (by_engine, by_reference) = (of(&mut Backend::Compute(&mut engine, None)), of(&mut Backend::Reference));
    let (a, b) = (by_engine.frame.f32(Channel::A).unwrap(), by_reference.frame.f32(Channel::A).unwrap());
    let between = b.iter().filter(|a| **a > 0.0 && **a < 1.0).count();
    let differ = a.iter().zip(b).filter(|(a, b)| a != b).count();
    println!("{between} pixels between, {differ} differ");
    assert!(between > 100, "{between}");
    // a sample within rounding of an edge
    assert!(differ <= 4, "{differ}");
    let centre = engine.render(&scene, &*camera, &wanted, &RunOptions::default()).unwrap();
    assert_eq!(words(&by_engine, Channel::TriangleId), words(&centre, Channel::TriangleId));
}

#[test]
fn errors_say_what_to_do() {
    let with = |rest: &str, keys: &str| composite(rest, &[member(FRONT, keys), member(RIGHT, "")]);
    let region = "region = { kind = 'rectangle', from = [0, 0], to = [0.5, 1] }";
    let inner = format!("{{ {} }}", with("master = 0", "").replace('\n', ", "));
    for (text, expected) in [
        (with("master = 2", ""), "camera.master: expected a whole number from 0 to 1"),
        (with("master = 'front'", ""), "a whole number from 0 to 1"),
        (
            with("", "objects = ['a']"),
            "camera.cameras.0: objects need a camera that says which of them hides which; add master",
        ),
        (with("master = 0", "objects = 'a'"), "camera.cameras.0.objects: "),
        (with("", "feather = 4"), "camera.cameras.0.feather: colours are blended along the border of a region"),
        (
            with("", &format!("{region}, feather = -1")),
            "camera.cameras.0.feather: -1 px; a strip is 0 to 65536 px wide",
        ),
        (
            composite("master = 0", &[member(CURVED, ""), member(FRONT, "")]),
            "camera.master: camera 0 has curved rays; depth is along straight ones",
        ),
        (composite("", &[member(&inner, "")]), "camera.cameras.0.camera.kind: a composite with master or feather"),
    ] {
        assert_refused(&text, expected);
    }
    let camera = camera(&with("master = 0", "objects = ['ball', 'bowl*']"), SIZE);
    let error = composition(&camera).check(&still_life().objects).unwrap_err();
    assert_eq!(
        error.to_string(),
        "camera.cameras.0.objects: no object is named \"bowl*\"; objects: \"floor\" \"ball#0\" \"ball#1\" \"cloud\""
    );
    let Some(mut engine) = engine_on(|_| {}) else { return };
    let wanted = Wanted::of(vec![Channel::TriangleId]);
    let got = engine.render(&still_life(), &camera, &wanted, &RunOptions::default()).err().unwrap();
    assert_eq!(got.to_string(), error.to_string());
}

/// A pixel is as certain as the frames of the cameras that decide which camera it shows, and not certain if depths decide.
#[test]
fn what_is_proven_is_the_reference_s() {
    let scene = still_life();
    let Some(mut engine) = engine_on(|_| {}) else { return };
    let left = "region = { kind = 'rectangle', from = [0, 0], to = [0.5, 1] }";
    for (name, rest, members) in [
        ("regions", "", [member(FRONT, &format!("feather = 6, {left}")), member(RIGHT, "")]),
        ("priorities", "master = 0", [member(FRONT, ""), member(RIGHT, "objects = ['ball'], priority = 1")]),
        ("depths", "master = 0", [member(FRONT, ""), member(RIGHT, "objects = ['ball']")]),
    ] {
        let camera = camera(&composite(rest, &members), SIZE);
        let wanted = Wanted::of(vec![Channel::TriangleId, Channel::Certified]);
        let rendered = engine.render(&scene, &camera, &wanted, &RunOptions::default()).unwrap();
        let truth = image(&scene, &camera, &[Channel::TriangleId]);
        let [proven, seen] = [Channel::Certified, Channel::TriangleId].map(|channel| words(&rendered, channel));
        let truth = truth.u32(Channel::TriangleId).unwrap();
        let wrong = (0..proven.len()).filter(|k| proven[*k] > 0 && seen[*k] != truth[*k]).count();
        let hits = (0..proven.len()).filter(|k| seen[*k] != NO_ID);
        let (all, certain) = hits.fold((0, 0), |(all, certain), k| (all + 1, certain + usize::from(proven[k] > 0)));
        println!("{name}: {certain} of {all} hits proven, {wrong} wrongly");
        assert_eq!(wrong, 0, "{name}");
        // depths decide wherever both cameras hit something
        assert!(if name == "depths" { certain < all } else { 2 * certain > all }, "{name}: {certain} of {all}");
    }
}

/// Light that a mirror sends past an object reaches no floor, whichever camera shows the object.
#[test]
fn objects_that_a_camera_does_not_show_are_in_the_way_of_caustics() {
    let text = |objects: &str| {
        format!(
            r#"image = {{ width = 64, height = 48 }}
[[mesh]]
name = "floor"
builtin = "plane"
size = 12
[[mesh]]
name = "ball"
builtin = "icosphere"
level = 2
scale = 0.4
translate = [0.5, 0.8, 0.3]
[camera]
kind = "composite"
master = 0
cameras = [
  {{ camera = {{ kind = "pinhole", eye = [0, 3, 6], target = [0, 0, 0], vfov = 45 }} }},
  {{ camera = {{ kind = "pinhole", eye = [0, 3, 6], target = [0, 0, 0], vfov = 45 }}, objects = [{objects}] }}]
[caustics]
flux = 30
map = [100, 100]
light = {{ kind = "reflection",
  eye = {{ kind = "pinhole", eye = [0, 1.5, 0], target = [0, 3, 0], up = [0, 0, 1], vfov = 60 }},
  mirror = {{ shape = "quadric", vertex = [0, 3, 0], axis = [0, -1, 0], curvature = 0, radius = 2 }} }}
receivers = [{{ origin = [-2, 0, 2], u = [4, 0, 0], v = [0, 0, -4], texels = [40, 40] }}]
"#
        )
    };
    let Some(mut engine) = engine_on(|_| {}) else { return };
    let channels = [Channel::R, Channel::TriangleId];
    let mut render = |objects: &str| {
        let scene = load(&text(objects)).unwrap();
        let camera = scene.camera().unwrap();
        let by_engine =
            engine.render(&scene, &camera, &Wanted::of(channels.to_vec()), &RunOptions::default()).unwrap().frame;
        (by_engine, image(&scene, &camera, &channels))
    };
    let ((split, truth), (whole, _)) = (render("'ball'"), render(""));
    let red = |frame: &Frame, k: usize| frame.f32(Channel::R).unwrap()[k];
    let ids = |frame: &Frame| frame.u32(Channel::TriangleId).unwrap().to_vec();
    assert!(ids(&split) == ids(&whole) && ids(&split).iter().any(|id| *id >= 2 && *id != NO_ID));
    // both cameras stand in one place: the picture is that of one camera that shows all
    assert!((0..64 * 48).all(|k| red(&split, k) == red(&whole, k)));
    let off = (0..64 * 48).filter(|k| (red(&split, *k) - red(&truth, *k)).abs() > 1e-4).count();
    // edges that pass through a pixel within rounding
    assert!(off <= 4, "{off} pixels have another color than the reference's");
}

//! Capsules: closed forms, agreement with the reference through cameras of all kinds, light, time, and seams between their parts.

use crate::common;
use anamorph::internals::camera::Camera;
use anamorph::internals::camera::exposure::{Exposure, LineOrder, Lines, Readout};
use anamorph::internals::camera::kinds::orthographic::Orthographic;
use anamorph::internals::camera::spec::CameraKind;
use anamorph::internals::engine::RunOptions;
use anamorph::internals::engine::plan::Wanted;
use anamorph::internals::geometry::mesh::Mesh;
use anamorph::internals::geometry::place;
use anamorph::internals::geometry::spheres::{Join, round_of};
use anamorph::internals::geometry::time_steps::{TimeStep, TimeSteps};
use anamorph::internals::image::frame::{Channel, NO_ID};
use anamorph::internals::input::Limits;
use anamorph::internals::scene::Scene;
use common::cameras::{MeshShape, glc_of_each_class, mesh_camera, pinhole, raymap};
use common::file::{camera_of, load};
use common::gpu::{Without, assert_right, assert_same_without_f64, check, engine, hits, ids, render, render_with};
use common::layered::{chain, wavy};
use common::rng::Rng;
use common::{ALL_T, FORWARD, camera, scene, soup};
use glam::DVec3;
use std::sync::Arc;

const SIZE: (u32, u32) = (80, 60);

fn capsules(list: &[([DVec3; 2], f64)]) -> Mesh {
    let points = list.iter().flat_map(|(ends, _)| *ends).collect();
    let radii = list.iter().flat_map(|(_, radius)| [*radius; 2]).collect();
    round_of(points, radii, None, Some(Join::Pairs), Limits::default()).unwrap()
}

/// Capsules of many sizes and lengths about the origin, among triangles.
fn mixed(rng: &mut Rng) -> Mesh {
    let one = |rng: &mut Rng| {
        let (end, length) = (rng.vector(), 10f64.powf(0.2 - 3.0 * rng.unit()));
        ([end, end + length * rng.vector()], 10f64.powf(-0.8 - 1.5 * rng.unit()))
    };
    let list: Vec<([DVec3; 2], f64)> = (0..120).map(|_| one(rng)).collect();
    place::merge(vec![soup(rng, 40, 0.4), capsules(&list)]).unwrap()
}

/// Parallel rays show a rod as all places within its radius of its segment, and along its axis as a disc.
#[test]
fn an_orthographic_image_is_a_stadium_or_a_disc() {
    let rod = [DVec3::new(-0.9, -0.3, -1.0), DVec3::new(0.7, 0.5, 0.5)];
    let upright = [DVec3::new(0.2, 0.1, -2.0), DVec3::new(0.2, 0.1, 1.0)];
    let kind = Orthographic { eye: DVec3::new(0.0, 0.0, 5.0), target: DVec3::ZERO, up: DVec3::Y, height: 3.0 };
    let camera = camera(CameraKind::new("orthographic", kind), SIZE, FORWARD);
    for ends in [rod, upright] {
        let radius = 0.4;
        let scene = scene(capsules(&[(ends, radius)]));
        let Some(mut engine) = engine(&camera, Without::Nothing) else { return };
        let wanted = Wanted::of(vec![Channel::TriangleId, Channel::Z, Channel::NormalZ]);
        let frame = engine.render(&scene, &camera, &wanted, &RunOptions::default()).unwrap().frame;
        // other tests, and `check` below, wait for it
        drop(engine);
        let [a, b] = ends.map(|p| p.truncate());
        let mut shown = 0;
        for (k, id) in ids(&frame).iter().enumerate() {
            let (i, j) = (k as u32 % SIZE.0, k as u32 / SIZE.0);
            let x = 3.0 / 60.0 * (f64::from(i) + 0.5 - 40.0);
            let y = 3.0 / 60.0 * (30.0 - f64::from(j) - 0.5);
            let p = glam::DVec2::new(x, y);
            let share = (p - a).dot(b - a) / (b - a).length_squared();
            let nearest = if share.is_finite() { a + share.clamp(0.0, 1.0) * (b - a) } else { a };
            let inside = radius - (p - nearest).length();
            if inside.abs() > 1e-12 {
                assert_eq!(*id != NO_ID, inside > 0.0, "pixel {i},{j} lies {inside} inside");
                shown += usize::from(*id != NO_ID);
            }
            if *id != NO_ID {
                let [z, n] = [Channel::Z, Channel::NormalZ].map(|channel| f64::from(frame.f32(channel).unwrap()[k]));
                // the place lies on the surface, straight below the camera, and its normal points away from the segment
                let place = DVec3::new(x, y, 5.0 - z);
                let axis = ends[1] - ends[0];
                let along = ((place - ends[0]).dot(axis) / axis.length_squared()).clamp(0.0, 1.0);
                let offset = place - (ends[0] + along * axis);
                assert!((offset.length() - radius).abs() < 4e-6 * 8.0, "pixel {i},{j}: {}", offset.length());
                assert!((n - offset.z / radius).abs() < 1e-4, "pixel {i},{j}: {n}");
            }
        }
        assert!(shown > 150, "{shown}");
        check("orthographic", &scene, &camera);
    }
}

#[test]
fn cameras_of_all_kinds_agree_with_the_reference() {
    let mut rng = Rng(32);
    let scene = scene(mixed(&mut rng));
    let size = (64, 48);
    let mut cameras: Vec<(String, Camera)> =
        glc_of_each_class().into_iter().map(|(name, kind)| (name.to_owned(), camera(kind, size, FORWARD))).collect();
    let of = |text: &str| camera_of("", size, text).unwrap();
    for (k, discontinuous) in [false, true].into_iter().enumerate() {
        let shape = MeshShape { discontinuous, ..MeshShape::default() };
        cameras.push((format!("mesh {shape:?}"), camera(mesh_camera(k as u64, 4, 3, shape), size, ALL_T)));
        cameras.push((format!("chain of {}", k + 2), chain(9 + k as u64, k + 2, (3, 2), MeshShape::default(), size)));
    }
    for degree in 1..=3 {
        cameras.push((format!("curves of degree {degree}"), wavy(degree, 0.7, degree == 2, size)));
    }
    cameras.push(("raymap".into(), raymap(size.0, size.1, FORWARD)));
    let pose = "eye = [0.5, 1.2, 2.5]\ntarget = [0, 0, 0]";
    cameras.push(("fisheye".into(), of(&format!("kind = \"fisheye\"\nfov = 170\n{pose}"))));
    cameras.push(("cylinder".into(), of(&format!("kind = \"cylinder\"\nvfov = 70\n{pose}"))));
    let eye = "eye = { kind = \"pinhole\", eye = [0, 0, 5], target = [0, 0, 0], vfov = 40 }";
    for keys in [
        "kind = \"reflection\"\nmirror = { shape = \"sphere\", center = [0, 0, 1.5], radius = 0.5, count = 60 }",
        "kind = \"refraction\"\nlens = { shape = \"sphere\", center = [0, 0, 1.5], radius = 0.5 }\nior = 1.3",
    ] {
        cameras.push((keys.to_owned(), of(&format!("{keys}\n{eye}"))));
    }
    for (name, camera) in &cameras {
        let Some((frame, judged, _)) = check(name, &scene, camera) else { return };
        let round = ids(&frame).iter().filter(|id| **id != NO_ID && scene.mesh.radius(**id).is_some()).count();
        let safe = judged.safe.iter().filter(|safe| **safe).count();
        println!("{name}: {round} pixels of capsules, {safe} safe");
        assert!(round > 50 && safe > 64 * 48 / 4, "{name}: {round} {safe}");
    }
}

/// A polyline of capsules bends at its points: no ray passes between two, and none meets a seam twice.
#[test]
fn a_tube_of_many_capsules_has_no_gaps() {
    let at = |k: usize| {
        let a = 0.2 * k as f64;
        DVec3::new(a.cos(), 0.03 * k as f64 - 1.0, a.sin())
    };
    let points: Vec<DVec3> = (0..64).map(at).collect();
    let mesh = round_of(points, vec![0.2; 64], None, Some(Join::Line), Limits::default()).unwrap();
    assert_eq!(mesh.triangles.len(), 63);
    let scene = scene(mesh);
    for camera in [
        camera(pinhole(DVec3::new(0.2, 0.3, 4.0), DVec3::ZERO, 45.0), SIZE, FORWARD),
        wavy(3, 0.4, false, SIZE),
        camera(glc_of_each_class()[3].1.clone(), SIZE, FORWARD),
    ] {
        let Some((frame, ..)) = check("tube", &scene, &camera) else { return };
        assert!(hits(&frame) > 400, "{}", hits(&frame));
    }
}

/// The back of a capsule shows from inside, through its side and through both balls, unless it has none.
#[test]
fn the_inside_of_a_capsule_shows_if_it_has_two_sides() {
    for two_sided in [true, false] {
        let mut mesh = capsules(&[([DVec3::new(-2.0, 0.0, 0.0), DVec3::new(2.0, 0.3, 0.0)], 1.0)]);
        mesh.materials[0].two_sided = two_sided;
        let scene = scene(mesh);
        for target in [DVec3::new(0.3, 0.0, -1.0), DVec3::new(3.0, 0.1, 0.0), DVec3::new(-3.0, 0.2, 0.4)] {
            let camera = camera(pinhole(DVec3::new(0.1, 0.0, 0.2), target, 100.0), SIZE, FORWARD);
            let Some((frame, ..)) = check("inside", &scene, &camera) else { return };
            assert_eq!(hits(&frame), if two_sided { (SIZE.0 * SIZE.1) as usize } else { 0 });
        }
    }
}

#[test]
fn capsules_are_lit_and_cast_shadows() {
    let text = "image = { width = 80, height = 60 }\n[[light]]\ndirection = [-1, -2, -1]\nshadows = true\n\
        [ambient_occlusion]\ndistance = 2\nrays = 16\n[[mesh]]\nbuiltin = \"plane\"\nsize = 8\n\
        [[spheres]]\ncenters = [[-1.5, 0.5, 0], [1.5, 1.2, 0.5], [0, 2, -1], [0.2, 0.4, 1.2]]\njoin = \"line\"\nradius = 0.35\n\
        colors = [[0.9, 0.2, 0.1], [0.1, 0.8, 0.3], [0.2, 0.3, 0.9], [1, 1, 1]]\nroughness = 0.4\n\
        [camera]\nkind = \"pinhole\"\neye = [1, 3, 7]\ntarget = [0, 0.7, 0]\nvfov = 40\n";
    let scene = load(text).unwrap();
    let camera = scene.camera().unwrap();
    let Some((frame, judged, _)) = check("lit", &scene, &camera) else { return };
    for channel in [Channel::R, Channel::G, Channel::B] {
        let (shown, truth) = (frame.f32(channel).unwrap(), judged.truth.f32(channel).unwrap());
        let wrong = (0..shown.len()).filter(|k| judged.safe[*k] && (shown[*k] - truth[*k]).abs() > 2e-3).count();
        // an edge of a shadow is no edge of a visible triangle
        assert!(wrong <= shown.len() / 100, "{wrong} of {} pixels", shown.len());
    }
}

/// Both ends of a capsule move, each in its own way, while the image is taken.
#[test]
fn capsules_that_move_are_right() {
    let mut rng = Rng(5);
    let mesh = mixed(&mut rng);
    let at = |by: f64| TimeStep {
        positions: mesh
            .positions
            .iter()
            .enumerate()
            .map(|(k, p)| *p + by * DVec3::new(0.3, (k % 3) as f64 * 0.2, 0.1))
            .collect(),
        normals: mesh.normals.clone(),
    };
    let steps = TimeSteps::new(vec![-0.5, 0.0, 0.5], vec![at(-0.5), at(0.1), at(0.5)]).map(Arc::new);
    let readout = Readout::Lines(Lines {
        first: -0.5,
        line_time: 1.0 / f64::from(SIZE.1),
        order: LineOrder::Down,
        count: SIZE.1,
    });
    let scene = Scene { steps, exposure: Exposure { readout, ..Exposure::default() }, ..scene(mesh) };
    for (name, camera) in [
        ("pinhole", camera(pinhole(DVec3::new(0.2, 0.3, 3.0), DVec3::ZERO, 50.0), SIZE, FORWARD)),
        ("pieces", camera(mesh_camera(1, 4, 3, MeshShape::default()), SIZE, ALL_T)),
        ("curves", wavy(2, 0.4, false, SIZE)),
    ] {
        let Some((frame, ..)) = check(name, &scene, &camera) else { return };
        assert!(hits(&frame) > 500, "{name}: {}", hits(&frame));
    }
}

#[test]
#[ignore = "slow: make test-all"]
fn all_arithmetic_shows_the_same_capsules() {
    let scene = scene(mixed(&mut Rng(3)));
    let pieces = camera(glc_of_each_class()[3].1.clone(), (64, 64), FORWARD);
    for (name, camera) in
        [("pieces", pieces), ("field", raymap(64, 64, FORWARD)), ("curves", wavy(2, 0.4, false, (64, 64)))]
    {
        let Some(frame) = render(&scene, &camera) else { return };
        // f64 in words takes long to compile, for curves minutes
        if name == "field" {
            assert_same_without_f64(name, &scene, &camera, &frame);
        }
        let without = render_with(&scene, &camera, Without::Int64Atomics, &RunOptions::default());
        let Some(rendered) = without else { return };
        assert_right(&format!("{name} without 64-bit atomics"), &scene, &camera, &rendered.frame);
    }
}

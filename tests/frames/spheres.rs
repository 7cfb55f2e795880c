//! Spheres: closed forms, agreement with the reference through cameras of all kinds, random scenes, light, time, and errors.

use crate::common;
use anamorph::internals::input::{Limits, Loading};

use anamorph::internals::camera::Camera;
use anamorph::internals::camera::exposure::{Exposure, LineOrder, Lines, Readout};
use anamorph::internals::camera::kinds::glc::Glc;
use anamorph::internals::camera::kinds::orthographic::Orthographic;
use anamorph::internals::camera::spec::CameraKind;
use anamorph::internals::engine::plan::Wanted;
use anamorph::internals::engine::{Arithmetic, RunOptions};
use anamorph::internals::geometry::mesh::Mesh;
use anamorph::internals::geometry::place;
use anamorph::internals::geometry::spheres::spheres_of;
use anamorph::internals::gpu::kernels::Variant;
use anamorph::internals::image::frame::{Channel, Frame, NO_ID};
use anamorph::internals::reference::image::image;
use anamorph::internals::scene::Scene;
use common::any::{any_moving, any_with_spheres, with_spheres};
use common::cameras::{MeshShape, glc_of_each_class, mesh_camera, pinhole, raymap};
use common::file::{camera_of, load, scene_of};
use common::gpu::{Without, assert_right, assert_same_without_f64, check, hits, ids, render, render_with};
use common::layered::{chain, wavy};
use common::rng::Rng;
use common::{ALL_T, FORWARD, camera, scene, soup};
use glam::{DVec2, DVec3};
use std::sync::Arc;

const SIZE: (u32, u32) = (80, 60);

fn balls(list: &[(DVec3, f64)]) -> Mesh {
    spheres_of(list.iter().map(|s| s.0).collect(), list.iter().map(|s| s.1).collect(), None, Limits::default()).unwrap()
}

/// The frames of the reference and, with an adapter, of the engine, all channels.
fn frames(scene: &Scene, camera: &Camera) -> Vec<Frame> {
    let mut channels = Channel::ALL.to_vec();
    channels.extend(Channel::MORE.iter().filter(|c| **c != Channel::Certified && !c.is_of_z()));
    let rendered = common::gpu::engine(camera, Without::Nothing).map(|mut engine| {
        engine.render(scene, camera, &Wanted::of(channels.clone()), &RunOptions::default()).unwrap().frame
    });
    [image(scene, camera, &channels)].into_iter().chain(rendered).collect()
}

fn each_pixel() -> impl Iterator<Item = (u32, u32, usize)> {
    (0..SIZE.1).flat_map(|j| (0..SIZE.0).map(move |i| (i, j, (j * SIZE.0 + i) as usize)))
}

/// Asserts that a frame shows the sphere exactly where `inside` is above 0, except within a tolerance of it.
fn assert_silhouette(frame: &Frame, tolerance: f64, inside: impl Fn(f64, f64) -> f64) {
    let mut tested = [0, 0];
    for (i, j, k) in each_pixel() {
        let (a, b) = ((f64::from(i) + 0.5) / f64::from(SIZE.0), (f64::from(j) + 0.5) / f64::from(SIZE.1));
        let inside = inside(2.0 * a - 1.0, 1.0 - 2.0 * b);
        if inside.abs() > tolerance {
            let is_seen = ids(frame)[k] != NO_ID;
            assert_eq!(is_seen, inside > 0.0, "pixel {i},{j} lies {inside} inside");
            tested[usize::from(is_seen)] += 1;
        }
    }
    assert!(tested.iter().all(|n| *n > 200), "{tested:?}");
}

/// A rounding of f64 in numbers up to a hundred.
const ROUNDED: f64 = 1e-13;

/// f32's rounding of a number up to eight, and of what it comes from.
const SHOWN: f64 = 4e-6;

/// Seen by parallel rays a ball is a disc, and each of its places as near as the ball is high there.
#[test]
fn an_orthographic_image_is_a_disc_of_known_depth() {
    let (centre, radius) = (DVec3::new(0.3, -0.2, -1.0), 1.4);
    let scene = scene(balls(&[(centre, radius)]));
    let kind = Orthographic { eye: DVec3::new(0.0, 0.0, 5.0), target: DVec3::ZERO, up: DVec3::Y, height: 4.0 };
    let camera = camera(CameraKind::new("orthographic", kind), SIZE, FORWARD);
    let place = |x: f64, y: f64| DVec2::new(2.0 * x * 80.0 / 60.0, 2.0 * y);
    for frame in frames(&scene, &camera) {
        let off = |x: f64, y: f64| place(x, y) - centre.truncate();
        assert_silhouette(&frame, ROUNDED, |x, y| radius - off(x, y).length());
        let plane = |channel| frame.f32(channel).unwrap();
        for (i, j, k) in each_pixel().filter(|(.., k)| ids(&frame)[*k] != NO_ID) {
            let [x, y] = [(f64::from(i) + 0.5) / 40.0 - 1.0, 1.0 - (f64::from(j) + 0.5) / 30.0];
            let off = off(x, y);
            let high = (radius * radius - off.length_squared()).sqrt();
            let normal = off.extend(high) / radius;
            let point = centre + radius * normal;
            let seen = |channels: [Channel; 3]| DVec3::from(channels.map(|c| f64::from(plane(c)[k])));
            assert!((f64::from(plane(Channel::Z)[k]) - (5.0 - point.z)).abs() < SHOWN, "pixel {i},{j}");
            let places = seen([Channel::PositionX, Channel::PositionY, Channel::PositionZ]);
            assert!((places - point).abs().max_element() < SHOWN, "pixel {i},{j}: {places} {point}");
            // the root of a small height loses half of its digits, and so does the normal there
            let normals = seen([Channel::NormalX, Channel::NormalY, Channel::NormalZ]);
            assert!((normals - normal).abs().max_element() < 1e-6, "pixel {i},{j}: {normals} {normal}");
            assert_eq!([plane(Channel::BaryU)[k], plane(Channel::BaryV)[k]], [0.0; 2]);
        }
    }
}

/// The outline of a ball through a pinhole is the conic (c . d)^2 = d . d (c . c - r^2).
#[test]
fn a_pinhole_s_outline_is_a_conic() {
    let (centre, radius) = (DVec3::new(1.5, 0.8, -4.0), 1.7);
    let scene = scene(balls(&[(centre, radius)]));
    let camera = camera(pinhole(DVec3::ZERO, DVec3::NEG_Z, 60.0), SIZE, FORWARD);
    let k = 30f64.to_radians().tan();
    for frame in frames(&scene, &camera) {
        assert_silhouette(&frame, 1e-11, |x, y| {
            let d = DVec3::new(x * k * 80.0 / 60.0, y * k, -1.0);
            let along = centre.dot(d);
            along.abs() * along - d.length_squared() * (centre.length_squared() - radius * radius)
        });
    }
}

/// A line camera that moves along x sees each slice of a ball, a circle, from the line's own place.
#[test]
fn a_pushbroom_sees_slices() {
    let (centre, radius) = (DVec3::new(-0.4, 0.5, -2.5), 1.2);
    let scene = scene(balls(&[(centre, radius)]));
    let (width, height) = (2.2, 0.9);
    let near = [DVec3::new(-width, 0.0, 0.0), DVec3::new(width, 0.0, 0.0), DVec3::new(-width, 0.0, 0.0)];
    let far = [DVec3::new(-width, height, -1.0), DVec3::new(width, height, -1.0), DVec3::new(-width, -height, -1.0)];
    let camera = camera(CameraKind::new("glc", Glc { near, far }), SIZE, FORWARD);
    for frame in frames(&scene, &camera) {
        assert_silhouette(&frame, 1e-12, |x, y| {
            let slice = radius * radius - (width * x - centre.x).powi(2);
            let beside = (-centre.z * height * y - centre.y) / (1.0 + (height * y).powi(2)).sqrt();
            slice - beside * beside
        });
    }
}

/// Through two slits: rays from the x axis to a line parallel to y at the distance 2, z downwards, go on in both directions.
#[test]
fn a_cross_slit_sees_what_its_two_slits_do() {
    let (centre, radius) = (DVec3::new(0.3, -0.2, -4.0), 0.8);
    let scene = scene(balls(&[(centre, radius)]));
    let at = |x: f64, y: f64| (DVec3::new(x, 0.0, 0.0), DVec3::new(0.0, 0.6 * y, -2.0));
    let corners = [at(-1.0, 1.0), at(1.0, 1.0), at(-1.0, -1.0)];
    let glc = Glc { near: corners.map(|c| c.0), far: corners.map(|c| c.1) };
    let camera = camera(CameraKind::new("glc", glc), SIZE, FORWARD);
    for frame in frames(&scene, &camera) {
        assert_silhouette(&frame, 1e-12, |x, y| {
            let (p, q) = at(x, y);
            let d = (q - p).normalize();
            radius - (centre - p).cross(d).length()
        });
    }
}

/// Spheres of many sizes about the origin, and triangles between them.
fn mixed(rng: &mut Rng) -> Mesh {
    let ball = |rng: &mut Rng| (rng.vector(), 10f64.powf(-0.3 - 2.5 * rng.unit()));
    let list: Vec<(DVec3, f64)> = (0..120).map(|_| ball(rng)).collect();
    place::merge(vec![soup(rng, 40, 0.4), balls(&list)]).unwrap()
}

#[test]
fn cameras_of_all_kinds_agree_with_the_reference() {
    let mut rng = Rng(31);
    let scene = scene(mixed(&mut rng));
    let size = (64, 48);
    let mut cameras: Vec<(String, Camera)> =
        glc_of_each_class().into_iter().map(|(name, kind)| (name.to_owned(), camera(kind, size, FORWARD))).collect();
    let of = |text: &str| camera_of("", size, text).unwrap();
    let shapes = [
        MeshShape::default(),
        MeshShape { normalize: true, weights: true, discontinuous: false },
        MeshShape { discontinuous: true, ..MeshShape::default() },
    ];
    for (k, shape) in shapes.into_iter().enumerate() {
        cameras.push((format!("mesh {shape:?}"), camera(mesh_camera(k as u64, 4, 3, shape), size, ALL_T)));
        cameras.push((format!("chain of {}", k + 2), chain(9 + k as u64, k + 2, (3, 2), MeshShape::default(), size)));
    }
    for degree in 1..=3 {
        cameras.push((format!("curves of degree {degree}"), wavy(degree, 0.7, degree == 2, size)));
    }
    cameras.push(("raymap".into(), raymap(size.0, size.1, FORWARD)));
    let seen = "eye = [0.5, 1.2, 2.5]\ntarget = [0, 0, 0]";
    for keys in [
        "kind = \"fisheye\"\nfov = 170",
        "kind = \"cylinder\"\nvfov = 70",
        "kind = \"sphere\"",
        "kind = \"panini\"\nfov = 120",
    ] {
        cameras.push((keys.to_owned(), of(&format!("{keys}\n{seen}"))));
    }
    for keys in [
        "kind = \"reflection\"\neye = { kind = \"pinhole\", eye = [0, 0, 5], target = [0, 0, 0], vfov = 40 }\n\
         mirror = { shape = \"sphere\", center = [0, 0, 1.5], radius = 0.5, count = 60 }",
        "kind = \"refraction\"\neye = { kind = \"pinhole\", eye = [0, 0, 5], target = [0, 0, 0], vfov = 40 }\n\
         lens = { shape = \"sphere\", center = [0, 0, 1.5], radius = 0.5 }\nior = 1.3",
    ] {
        cameras.push((keys.to_owned(), of(keys)));
    }
    for (name, camera) in &cameras {
        let Some((frame, judged, _)) = check(name, &scene, camera) else { return };
        let spheres = ids(&frame).iter().filter(|id| **id != NO_ID && scene.mesh.radius(**id).is_some()).count();
        let safe = judged.safe.iter().filter(|safe| **safe).count();
        println!("{name}: {spheres} pixels of spheres, {safe} safe");
        assert!(spheres > 50 && safe > 64 * 48 / 4, "{name}: {spheres} {safe}");
    }
}

#[test]
fn random_scenes_of_spheres_and_triangles_have_the_reference_s_ids() {
    for number in 0..120 {
        let (scene, camera) = any_with_spheres(&mut Rng(70_000 + number), (32, 32));
        if check(&format!("scene {number}, {}", camera.kind), &scene, &camera).is_none() {
            return;
        }
    }
}

/// From inside a sphere its back is seen, unless it has none.
#[test]
fn the_inside_of_a_sphere_is_seen_if_it_shows_both_sides() {
    for two_sided in [true, false] {
        let mut mesh = balls(&[(DVec3::new(0.1, 0.2, 0.0), 3.0), (DVec3::new(0.0, 0.0, -1.0), 0.5)]);
        mesh.materials[0].two_sided = two_sided;
        let scene = scene(mesh);
        let camera = camera(pinhole(DVec3::new(0.0, 0.0, 1.0), DVec3::ZERO, 70.0), SIZE, FORWARD);
        for frame in frames(&scene, &camera) {
            let count = |id: u32| ids(&frame).iter().filter(|own| **own == id).count();
            assert!(count(1) > 200, "{}", count(1));
            assert_eq!((count(0) > 0, count(NO_ID) > 0), (two_sided, !two_sided));
        }
        assert!(check("inside", &scene, &camera).is_none_or(|(frame, ..)| hits(&frame) > 200));
    }
}

/// A range of t that ends inside of a sphere cuts it open.
#[test]
fn spheres_are_cut_by_the_range_of_t() {
    let scene = scene(balls(&[(DVec3::ZERO, 1.0)]));
    let kind = Orthographic { eye: DVec3::new(0.0, 0.0, 5.0), target: DVec3::ZERO, up: DVec3::Y, height: 3.0 };
    for (range, z) in [([0.0, 4.5], 4.0), ([4.5, 9.0], 6.0), ([4.0, 6.0], 4.0), ([6.0, 6.0], 6.0)] {
        let camera = camera(CameraKind::new("orthographic", kind.clone()), SIZE, range);
        // through the middle
        let place = (SIZE.1 / 2 * SIZE.0 + SIZE.0 / 2) as usize;
        for frame in frames(&scene, &camera) {
            let seen = frame.f32(Channel::Z).unwrap()[place];
            // half a pixel off the middle
            assert!(range[0] == range[1] || (seen - z).abs() < 2e-3, "{range:?}: {seen}");
        }
        check(&format!("{range:?}"), &scene, &camera);
    }
}

/// Equal spheres, and a sphere and a triangle that are met at one t: the lower id is seen.
#[test]
fn of_what_is_level_the_lower_id_is_seen() {
    let twice = [(DVec3::ZERO, 1.0), (DVec3::ZERO, 1.0)];
    let scene = scene(balls(&twice));
    let camera = camera(pinhole(DVec3::new(0.2, 0.1, 4.0), DVec3::ZERO, 40.0), SIZE, FORWARD);
    for frame in frames(&scene, &camera) {
        assert!(ids(&frame).iter().all(|id| [0, NO_ID].contains(id)) && hits(&frame) > 500);
    }
}

#[test]
#[ignore = "slow: make test-all"]
fn all_arithmetic_sees_the_same_spheres() {
    let scene =
        scene(balls(&[(DVec3::ZERO, 0.5), (DVec3::new(0.4, 0.3, 0.2), 0.1), (DVec3::new(-0.6, 0.1, 0.3), 0.002)]));
    let pieces = camera(glc_of_each_class()[3].1.clone(), (64, 64), FORWARD);
    for (name, camera) in
        [("pieces", pieces), ("field", raymap(64, 64, FORWARD)), ("curves", wavy(2, 0.4, false, (64, 64)))]
    {
        let Some(frame) = render(&scene, &camera) else { return };
        // f64 in words takes long to compile, for curves minutes
        if name == "field" {
            assert_same_without_f64(name, &scene, &camera, &frame);
        }
        let Some(rendered) = render_with(&scene, &camera, Without::Int64Atomics, &RunOptions::default()) else {
            return;
        };
        assert_right(&format!("{name} without 64-bit atomics"), &scene, &camera, &rendered.frame);
        if camera.is_curved() {
            continue;
        }
        let run = RunOptions { arithmetic: Arithmetic::Double, ..RunOptions::default() };
        let Some(rendered) = render_with(&scene, &camera, Without::Nothing, &run) else { return };
        assert!(ids(&rendered.frame) == ids(&frame), "{name}: all rechecked sees other spheres");
    }
}

#[test]
fn a_hundred_thousand_spheres_are_right() {
    let mut rng = Rng(12);
    let list: Vec<(DVec3, f64)> = (0..100_000).map(|_| (rng.vector(), 0.002 + 0.004 * rng.unit())).collect();
    let scene = scene(balls(&list));
    let camera = camera(glc_of_each_class()[3].1.clone(), (96, 96), FORWARD);
    let Some((frame, ..)) = check("a hundred thousand", &scene, &camera) else { return };
    assert!(hits(&frame) > 4000, "{}", hits(&frame));
}

/// Light falls on spheres and is kept off by them, as the reference has it.
#[test]
fn spheres_are_lit_and_cast_shadows() {
    let text = "image = { width = 80, height = 60 }\n[[light]]\ndirection = [-1, -2, -1]\nshadows = true\n\
        [[light]]\nposition = [2, 4, 3]\ncolor = [3, 2, 1]\nshadows = true\n[ambient_occlusion]\ndistance = 2\nrays = 16\n\
        [[mesh]]\nbuiltin = \"plane\"\nsize = 8\n[[spheres]]\ncenters = [[0, 1, 0], [1.4, 0.5, 0.6, 0.5], [-1.5, 0.7, 0.9, 0.7]]\n\
        radius = 1\ncolors = [[0.9, 0.2, 0.1], [0.1, 0.8, 0.3], [0.2, 0.3, 0.9]]\nroughness = 0.4\n\
        [camera]\nkind = \"pinhole\"\neye = [1, 3, 7]\ntarget = [0, 0.7, 0]\nvfov = 40\n";
    let scene = load(text).unwrap();
    let camera = scene.camera().unwrap();
    let Some((frame, judged, _)) = check("lit", &scene, &camera) else { return };
    for channel in [Channel::R, Channel::G, Channel::B] {
        let (seen, truth) = (frame.f32(channel).unwrap(), judged.truth.f32(channel).unwrap());
        let wrong = (0..seen.len()).filter(|k| judged.safe[*k] && (seen[*k] - truth[*k]).abs() > 2e-3).count();
        // a shadow's edge is no edge of what is seen
        assert!(wrong <= seen.len() / 100, "{wrong} of {} pixels", seen.len());
    }
    let [albedo, truth] = frames(&scene, &camera).try_into().unwrap_or_else(|_| panic!("two frames"));
    for channel in [Channel::AlbedoR, Channel::AlbedoG, Channel::AlbedoB] {
        let (seen, truth) = (albedo.f32(channel).unwrap(), truth.f32(channel).unwrap());
        // a few roundings of weights
        assert!(seen.iter().zip(truth).all(|(a, b)| (a - b).abs() <= 4.0 * f32::EPSILON));
    }
}

/// A ball above a plane under light from straight above: its shadow is a disc of its own radius.
#[test]
fn a_ball_s_shadow_is_a_disc() {
    let text = format!(
        "image = {{ width = {}, height = {} }}\n[[light]]\ndirection = [0, 0, -1]\nshadows = true\n\
         [[mesh]]\nbuiltin = \"plane\"\nsize = 9\nrotate = [90, 0, 0]\n[[spheres]]\ncenters = [[0.3, 0.1, 4.5]]\nradius = 1.1\n\
         [camera]\nkind = \"orthographic\"\neye = [0, 0, 2]\ntarget = [0, 0, 0]\nheight = 4\n",
        SIZE.0, SIZE.1
    );
    let scene = load(&text).unwrap();
    let camera = scene.camera().unwrap();
    for frame in frames(&scene, &camera) {
        let light = frame.f32(Channel::R).unwrap();
        for (i, j, k) in each_pixel() {
            let place = DVec2::new((f64::from(i) + 0.5 - 40.0) / 15.0, (30.0 - f64::from(j) - 0.5) / 15.0);
            let inside = 1.1 - (place - DVec2::new(0.3, 0.1)).length();
            if inside.abs() > 1e-4 {
                assert_eq!(light[k] < 0.2, inside > 0.0, "pixel {i},{j}: {} at {inside}", light[k]);
            }
        }
    }
}

/// Three units to the right in a frame, read row by row: a ball leans.
#[test]
fn a_ball_that_moves_is_seen_where_it_is_at_each_row() {
    let text = format!(
        "image = {{ width = {}, height = {} }}\n[[spheres]]\ncenters = [[0, 0, 0]]\nradius = 1.2\n\
         translate = [{{ frame = 0, value = [-1.5, 0, 0] }}, {{ frame = 1, value = [1.5, 0, 0] }}]\n\
         [camera]\nkind = \"orthographic\"\neye = [0, 0, 5]\ntarget = [0, 0, 0]\nheight = 4\nline_time = {}\n",
        SIZE.0,
        SIZE.1,
        1.0 / 60.0
    );
    let scene = load(&text).unwrap();
    assert!(scene.steps.is_some());
    let camera = scene.camera().unwrap();
    for frame in frames(&scene, &camera) {
        // a time is rounded to 2^-24 of a step, three units
        assert_silhouette(&frame, 4e-7, |x, y| {
            let row = 30.0 * (1.0 - y) - 0.5;
            let middle = -1.5 + 3.0 * row / 60.0;
            1.2 - DVec2::new(2.0 * x * 80.0 / 60.0 - middle, 2.0 * y).length()
        });
    }
}

#[test]
#[ignore = "slow: make test-all"]
fn random_scenes_of_spheres_that_move_have_the_reference_s_ids() {
    for number in 0..40 {
        let mut rng = Rng(80_000 + number);
        let (mut scene, camera) = any_moving(&mut rng, (32, 32));
        let steps = scene.steps.take();
        with_spheres(&mut rng, &mut scene);
        // of the triangles first, if their vertices still come first
        let moving = steps.filter(|_| scene.mesh.radius(0).is_none());
        scene.steps = moving;
        if check(&format!("scene {number}, {}", camera.kind), &scene, &camera).is_none() {
            return;
        }
    }
    let mut scene = scene(mixed(&mut Rng(3)));
    let mut rng = Rng(4);
    let step = |by: f64, rng: &mut Rng| anamorph::internals::geometry::time_steps::TimeStep {
        positions: scene.mesh.positions.iter().map(|p| *p + by * rng.vector()).collect(),
        normals: Vec::new(),
    };
    let steps = vec![step(0.0, &mut rng), step(0.5, &mut rng), step(0.5, &mut rng)];
    scene.steps = anamorph::internals::geometry::time_steps::TimeSteps::new(vec![0.0, 0.4, 1.0], steps).map(Arc::new);
    let lines = Lines { first: 0.0, line_time: 1.0 / 48.0, order: LineOrder::Down, count: 48 };
    scene.exposure = Exposure { readout: Readout::Lines(lines), shutter: 0.0, is_even: false };
    for (name, kind) in glc_of_each_class() {
        check(name, &scene, &camera(kind, (48, 48), FORWARD));
    }
}

#[test]
fn nothing_of_it_is_in_a_frame_without_spheres() {
    use anamorph::internals::engine::stage::all_kernels;
    let has_spheres = |variant: Variant| {
        let all = all_kernels(variant, &[Channel::T]);
        all.iter().any(|kernel| kernel.files.iter().any(|file| file.path.contains("round")))
    };
    for variant in Variant::every(true, true) {
        assert_eq!(has_spheres(variant), variant.has_round(), "{variant:?}");
    }
    assert!(!scene(soup(&mut Rng(1), 3, 0.1)).mesh.has_spheres());
}

/// Places, copies and turns.
#[test]
fn spheres_are_placed_as_meshes_are() {
    let spheres = "[[spheres]]\ncenters = [[1, 0, 0], [0, 2, 0]]\nradius = 0.5\nscale = 2\nrotate = [0, 0, 90]\ntranslate = [0, 0, 1]\n\
        places = [[[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]], [[0, -3, 0, 9], [3, 0, 0, 0], [0, 0, 3, 0]]]\n\
        [[mesh]]\nbuiltin = \"box\"\n";
    let scene = scene_of(spheres, SIZE, "kind = \"pinhole\"\neye = [0, 0, 9]\ntarget = [0, 0, 0]\nvfov = 40").unwrap();
    let mesh = &scene.mesh;
    // after the triangles of the box, though their table comes first
    let own: Vec<(DVec3, f64)> = (12..16)
        .map(|id| (mesh.positions[mesh.triangles[id as usize][0] as usize], mesh.radius(id).unwrap()))
        .collect();
    let expected = [
        (DVec3::new(0.0, 2.0, 1.0), 1.0),
        (DVec3::new(-4.0, 0.0, 1.0), 1.0),
        (DVec3::new(3.0, 0.0, 3.0), 3.0),
        (DVec3::new(9.0, -12.0, 3.0), 3.0),
    ];
    assert_eq!(own, expected);
    assert_eq!((mesh.radius(11), mesh.radius(16)), (None, None));
    let names: Vec<(&str, usize)> = scene.objects.iter().map(|o| (o.name.as_str(), o.triangles)).collect();
    assert_eq!(names, [("box", 12), ("spheres#0", 2), ("spheres#1", 2)]);
}

#[test]
fn files_of_spheres_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    let header = "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n";
    let colors = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
    write("plain.ply", &format!("{header}end_header\n1 2 3\n4 5 6\n"));
    write(
        "full.ply",
        &format!(
            "{header}property float scalar_radius\n{colors}element face 0\nproperty list uchar int vertex_indices\nend_header\n1 2 3 0.5 255 0 0\n4 5 6 0.25 0 255 255\n"
        ),
    );
    write("points.xyz", "# some\n1 2 3\n4 5 6\n");
    let npy = |name: &str, shape: &[u64], numbers: &[f64]| {
        anamorph::internals::image::write_npy_f64(&folder.path().join(name), shape, numbers).unwrap();
    };
    npy("three.npy", &[2, 3], &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
    npy("four.npy", &[2, 4], &[1.0, 2.0, 3.0, 0.5, 4.0, 5.0, 6.0, 0.25]);
    npy("five.npy", &[1, 5], &[1.0; 5]);
    npy("nan.npy", &[1, 4], &[1.0, f64::NAN, 3.0, 0.5]);
    npy("flat.npy", &[1, 4], &[1.0, 2.0, 3.0, 0.0]);
    npy("colors.npy", &[2, 3], &[1.0, 0.0, 0.0, 0.0, 1.0, 1.0]);
    let load = |keys: &str| {
        let path = folder.path().join("scene.toml");
        let camera = "[camera]\nkind = \"pinhole\"\neye = [0, 0, 9]\ntarget = [0, 0, 0]\nvfov = 40\n";
        std::fs::write(&path, format!("image = {{ width = 8, height = 6 }}\n[[spheres]]\n{keys}\n{camera}")).unwrap();
        Scene::load(&path, &[], 0.0, &Loading::default())
    };
    let mesh = |keys: &str| load(keys).unwrap().mesh;
    for (keys, radii, color) in [
        ("file = 'plain.ply'\nradius = 0.5", [0.5, 0.5], None),
        ("file = 'full.ply'", [0.5, 0.25], Some([[1.0, 0.0, 0.0], [0.0, 1.0, 1.0]])),
        ("file = 'full.ply'\ncolor = [0.1, 0.2, 0.3]", [0.5, 0.25], None),
        ("file = 'points.xyz'\nradius = 2", [2.0, 2.0], None),
        ("file = 'three.npy'\nradius = 2\ncolors = 'colors.npy'", [2.0, 2.0], Some([[1.0, 0.0, 0.0], [0.0, 1.0, 1.0]])),
        ("file = 'four.npy'", [0.5, 0.25], None),
        ("centers = [[1, 2, 3, 0.5], [4, 5, 6]]\nradius = 0.25", [0.5, 0.25], None),
    ] {
        let mesh = mesh(keys);
        assert_eq!(mesh.positions, [DVec3::new(1.0, 2.0, 3.0), DVec3::new(4.0, 5.0, 6.0)], "{keys}");
        assert_eq!((&mesh.radii[..], mesh.corner_colors.is_empty()), (&radii[..], color.is_none()), "{keys}");
        for (id, color) in color.into_iter().flatten().enumerate() {
            assert_eq!(mesh.colors_of(id), [color; 3], "{keys}");
        }
    }
    for (keys, says) in [
        ("", "spheres.0: spheres need file = \"NAME.ply\" or centers"),
        ("file = 'plain.ply'\ncenters = [[0, 0, 0]]", "spheres have either a file or centers"),
        ("file = 'missing.ply'", "missing.ply"),
        ("file = 'plain.ply'", "spheres plain: there are no radii in the file; add radius = 0.1"),
        ("file = 'plain.ply'\nradius = 0", "spheres.0.radius: 0 is out of range; use a number above 0"),
        ("file = 'plain.ply'\nradius = -1", "spheres.0.radius: -1 is out of range"),
        ("file = 'plain.obj'\nradius = 1", "unknown kind of file for spheres; use .ply, .npy, .csv, .txt or .xyz"),
        ("file = 'five.npy'\nradius = 1", "the array's shape is [1, 5]; it must be N x 3 or N x 4"),
        ("file = 'nan.npy'", "spheres nan: sphere 0 lies at"),
        ("file = 'flat.npy'", "spheres flat: sphere 0 has the radius 0; use a number above 0"),
        ("file = 'three.npy'\nradius = 1\ncolors = [[1, 1, 1]]", "spheres three: 1 colours for 2 spheres"),
        ("file = 'three.npy'\nradius = 1\ncolors = [[1, 2, 1]]", "colours lie in [0, 1]"),
        ("centers = [[0, 0, 0]]", "spheres: center 0 has no radius; add radius = 0.1"),
        ("centers = [[0, 0]]\nradius = 1", "spheres.0.centers.0: expected a centre, as [x, y, z]"),
        ("centers = [[0, 0, nan]]\nradius = 1", "spheres.0.centers.0.2: expected a finite number"),
        ("centers = [[0, 0, 0, -2]]", "spheres.0.centers.0.3: -2 is out of range"),
        ("centers = [[0, 0, 0]]\nradius = 1\nscale = [1, 2, 1]", "spheres.0.scale: the scale stretches spheres"),
        ("centers = [[0, 0, 0]]\nradius = 1\nscale = 0", "spheres.0.scale: the scale stretches spheres"),
        (
            "centers = [[0, 0, 0]]\nradius = 1\nplaces = [[[1, 0, 0, 0], [0, 2, 0, 0], [0, 0, 1, 0]]]",
            "spheres spheres: matrix 0 of places stretches spheres",
        ),
        ("centers = [[0, 0, 0]]\nradius = 1\ntexture = 'a.png'", "unknown key \"texture\" in spheres.0"),
        ("centers = [[0, 0, 0]]\nradius = 1\nsmooth = true", "unknown key \"smooth\" in spheres.0"),
    ] {
        let error = load(keys).expect_err(keys);
        let text = error.to_string();
        assert!(error.exit_code() == 2 && !text.contains('\n') && text.contains(says), "{keys}: {text}");
    }
}

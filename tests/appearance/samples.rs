//! Several samples per pixel in one frame: each sees what a frame of its own sees, through every kind of straight rays. Nothing to do
//! without an adapter.

use crate::common;
use crate::pictures;
use crate::textures::masked_shapes;

use anamorph::internals::camera::Camera;
use anamorph::internals::engine::combinations::at_once;
use anamorph::internals::engine::plan::Wanted;
use anamorph::internals::engine::plan::samples::sample_offsets;
use anamorph::internals::engine::{Capacities, Engine, Rendered, RunOptions};
use anamorph::internals::geometry::generate::icosphere;
use anamorph::internals::image::frame::{Channel, NO_ID};
use anamorph::internals::scene::Scene;
use common::cameras::{MeshShape, glc_of_each_class, mesh_camera, raymap};
use common::file::camera_of;
use common::gpu::{engine_on, ids, limit_bindings};
use common::layered::chain;
use common::polygon::{self, area, pixel_about};
use common::rng::Rng;
use common::{FORWARD, camera, mesh, moved, scene, soup};
use glam::{DVec2, DVec3};
use pictures::{Colours, box_filtered, colours, psnr};

const SIZE: (u32, u32) = (61, 45);

/// Through the middle of the scenes here, all around.
const FISHEYE: &str = "kind = \"fisheye\"\neye = [0.3, 0.2, 2.5]\ntarget = [0, 0, 0]\nfov = 100\nframe = \"full\"";

/// Three cameras whose regions meet within pixels.
const COMPOSITE: &str = "kind = \"composite\"\ncameras = [
    { camera = { kind = \"pinhole\", eye = [0, 0, 4], target = [0, 0, 0], vfov = 40 }, region = { kind = \"polygon\", points = [[0, 0], [0.7, 0.1], [0.2, 0.9]] } },
    { camera = { kind = \"fisheye\", eye = [0.3, 0.2, 2.5], target = [0, 0, 0], fov = 100 }, region = { kind = \"rectangle\", from = [0.1, 0.1], to = [0.61, 0.97] } },
    { camera = { kind = \"orthographic\", eye = [0, 0, 4], target = [0, 0, 0], height = 3 }, region = { kind = \"rectangle\", from = [0.3, 0], to = [1, 0.81] } }]";

fn cameras() -> Vec<(&'static str, Camera)> {
    let shape = MeshShape::default();
    let meshes = [
        ("mesh of 16 x 16", MeshShape { weights: true, ..shape }, 16),
        ("discontinuous mesh", MeshShape { discontinuous: true, ..shape }, 8),
        ("mesh of pieces as small as pixels", shape, 50),
    ];
    let glc = glc_of_each_class().into_iter().map(|(name, kind)| (name, camera(kind, SIZE, FORWARD)));
    let mesh = |(name, shape, side)| (name, camera(mesh_camera(1, side, side, shape), SIZE, FORWARD));
    let more = [
        ("chain", chain(3, 3, (4, 3), shape, SIZE)),
        ("ray map", raymap(SIZE.0, SIZE.1, FORWARD)),
        ("fisheye", camera_of("", SIZE, FISHEYE).unwrap()),
        ("composite", camera_of("", SIZE, COMPOSITE).unwrap()),
    ];
    glc.chain(meshes.map(mesh)).chain(more).collect()
}

/// Large and small triangles, slivers and ones that pass through each other.
fn crowd() -> Scene {
    let mut rng = Rng(4);
    let mut all = soup(&mut rng, 60, 0.8);
    let mut slivers = soup(&mut rng, 100, 0.01);
    slivers.positions.iter_mut().for_each(|p| p.x *= 30.0);
    for part in [soup(&mut rng, 300, 0.05), slivers, moved(icosphere(2), DVec3::new(0.213, 0.107, -0.3))] {
        let first = all.positions.len() as u32;
        all.positions.extend(&part.positions);
        all.triangles.extend(part.triangles.iter().map(|t| t.map(|v| v + first)));
        all.material_of.extend(vec![0; part.triangles.len()]);
    }
    scene(mesh(all.positions, all.triangles))
}

fn sampled(engine: &mut Engine, scene: &Scene, camera: &Camera, samples: u32, run: &RunOptions) -> Rendered {
    assert!(at_once(scene, camera, samples));
    let channels = [Channel::R, Channel::G, Channel::B, Channel::A, Channel::TriangleId].to_vec();
    let wanted = Wanted { samples, sample_ids: true, ..Wanted::of(channels) };
    engine.render(scene, camera, &wanted, run).unwrap()
}

/// Triangles that the samples of all pixels see, by a frame each.
fn one_by_one(engine: &mut Engine, scene: &Scene, camera: &Camera, samples: u32) -> Vec<Vec<u32>> {
    let wanted = Wanted::of(vec![Channel::TriangleId]);
    let frame = |place: DVec2| {
        let moved = camera.with_sample_offset(place.x, place.y);
        ids(&engine.render(scene, &moved, &wanted, &RunOptions::default()).unwrap().frame).to_vec()
    };
    sample_offsets(samples).into_iter().map(frame).collect()
}

#[test]
fn every_sample_sees_what_a_frame_of_its_own_sees() {
    let scene = crowd();
    assert_samples_are_frames(&scene, true, &[4, 5, 16]);
    assert_samples_are_frames(&scene, false, &[5]);
}

#[test]
fn samples_look_through_holes_of_alpha_masks() {
    assert_samples_are_frames(&masked_shapes(), true, &[5]);
}

/// With or without subgroups of eight threads.
fn assert_samples_are_frames(scene: &Scene, lanes: bool, counts: &[u32]) {
    let Some(mut engine) = engine_on(|gpu| gpu.has.lanes &= lanes) else { return };
    for (name, camera) in cameras() {
        for &samples in counts {
            let seen = sampled(&mut engine, scene, &camera, samples, &RunOptions::default());
            let separate = one_by_one(&mut engine, scene, &camera, samples);
            let pixels = (SIZE.0 * SIZE.1) as usize;
            let edges = seen.counts.edges;
            println!("{name}, {samples} samples: {edges} of {pixels} pixels are edge pixels");
            assert_eq!(seen.sample_ids.len(), samples as usize);
            for (n, (own, separate)) in seen.sample_ids.iter().zip(&separate).enumerate() {
                let differ: Vec<usize> = (0..pixels).filter(|&k| own[k] != separate[k]).collect();
                assert!(differ.is_empty(), "{name}: sample {n} of pixels {differ:?}");
            }
            let covered = |k: usize| seen.sample_ids.iter().filter(|ids| ids[k] != NO_ID).count();
            let alpha = seen.frame.f32(Channel::A).unwrap();
            assert!((0..pixels).all(|k| alpha[k] == covered(k) as f32 / samples as f32), "{name}: coverage");
        }
    }
}

/// Several layers of rays per pixel are held as curves are.
#[test]
fn layers_of_rays_take_a_frame_a_sample() {
    let Some(mut engine) = engine_on(|_| {}) else { return };
    let text = "kind = \"occlusion\"\neye = [0, 0, 4]\ntarget = [0, 0, 0]\nvfov = 45\nnear = 2\nfar = 6\ndistortion = [0.05, 0.1]";
    let (scene, camera) = (scene(icosphere(2)), camera_of("", SIZE, text).unwrap());
    assert!(camera.layers.len() > 1);
    assert_takes_a_frame_per_sample(&mut engine, &scene, &camera);
}

/// The ids of samples are there for a mirror with an atlas, too, and change no other channel.
#[test]
fn samples_of_a_mirror_with_an_atlas_have_ids() {
    let Some(mut engine) = engine_on(|_| {}) else { return };
    let text = "kind = \"reflection\"\neye = { kind = \"pinhole\", eye = [0, 1, 5], target = [0, 0, 0], vfov = 40 }\n\
        mirror = { builtin = \"icosphere\", level = 1, scale = 0.6 }\nfacets = \"flat\"\natlas = 16";
    let (scene, camera) = (crowd(), camera_of("", SIZE, text).unwrap());
    let with_ids = vec![Channel::A, Channel::Z, Channel::TriangleId, Channel::NormalX];
    let mut render = |channels: Vec<Channel>, samples: u32, sample_ids: bool| {
        let wanted = Wanted { samples, sample_ids, ..Wanted::of(channels) };
        engine.render(&scene, &camera, &wanted, &RunOptions::default()).unwrap()
    };
    let expected = render(with_ids, 1, false);
    let seen = render(vec![Channel::A, Channel::Z, Channel::NormalX], 1, true);
    assert!(seen.sample_ids == [ids(&expected.frame)] && seen.sample_ids[0].iter().any(|id| *id != NO_ID));
    for channel in [Channel::A, Channel::Z, Channel::NormalX] {
        assert_eq!(seen.frame.f32(channel), expected.frame.f32(channel), "{channel:?}");
    }
    let of_samples = render(vec![Channel::A], 4, true);
    let covered = |k: usize| of_samples.sample_ids.iter().filter(|ids| ids[k] != NO_ID).count();
    let alpha = of_samples.frame.f32(Channel::A).unwrap();
    assert!((0..alpha.len()).all(|k| alpha[k] >= covered(k) as f32 / 4.0) && of_samples.sample_ids.len() == 4);
}

/// Samples of one image are those of frames, coverage is their mean, and the rest is of pixel centers.
fn assert_takes_a_frame_per_sample(engine: &mut Engine, scene: &Scene, camera: &Camera) {
    assert!(!at_once(scene, camera, 4));
    let wanted = Wanted { samples: 4, sample_ids: true, ..Wanted::of(vec![Channel::A, Channel::TriangleId]) };
    let all = engine.render(scene, camera, &wanted, &RunOptions::default()).unwrap();
    assert!(all.sample_ids == one_by_one(engine, scene, camera, 4));
    let covered = |k: usize| all.sample_ids.iter().filter(|ids| ids[k] != NO_ID).count();
    let alpha = all.frame.f32(Channel::A).unwrap();
    assert!((0..alpha.len()).all(|k| alpha[k] == covered(k) as f32 / 4.0));
    assert!(alpha.iter().any(|a| *a > 0.0 && *a < 1.0));
    let centers = engine.render(scene, camera, &Wanted::of(vec![Channel::TriangleId]), &RunOptions::default()).unwrap();
    assert!(ids(&all.frame) == ids(&centers.frame));
}

#[test]
fn rays_all_over_the_scene_take_a_frame_a_sample() {
    let plain = raymap(64, 64, FORWARD);
    let display = "kind = \"lightfield\"\ncenter = [0, 0, 2]\nnormal = [0, 0, 1]\nup = [0, 1, 0]\nwidth = 2\nheight = 2\nviews = [8, 8]\nfov = 40";
    let incoherent = camera_of("", (64, 64), display).unwrap();
    let Some(mut engine) = engine_on(|_| {}) else { return };
    let scene = crowd();
    assert_takes_a_frame_per_sample(&mut engine, &scene, &incoherent);
    let wanted = Wanted { samples: 4, ..Wanted::of(vec![Channel::A]) };
    let run = RunOptions::default();
    let mut frames = engine.prepare(&scene, &plain, &wanted, &run).unwrap();
    assert!(frames.aim(&incoherent).is_err());
    // those of centres come in the image's own order
    let wanted = Wanted { sample_ids: true, ..Wanted::of(vec![Channel::TriangleId]) };
    let seen = engine.render(&scene, &incoherent, &wanted, &run).unwrap();
    assert!(seen.sample_ids[0] == ids(&seen.frame) && seen.sample_ids[0].iter().any(|id| *id != NO_ID));
}

#[test]
fn samples_follow_the_camera() {
    let scene = crowd();
    let kinds = glc_of_each_class();
    let [first, second] = [3, 4].map(|k| camera(kinds[k].1.clone(), SIZE, FORWARD));
    let maps = [100, 90].map(|fov| camera_of("", SIZE, &FISHEYE.replace("100", &fov.to_string())).unwrap());
    let Some(mut engine) = engine_on(|_| {}) else { return };
    for [first, second] in [[first, second], maps] {
        let wanted = Wanted { samples: 4, sample_ids: true, ..Wanted::of(vec![Channel::A]) };
        let mut frames = engine.prepare(&scene, &first, &wanted, &RunOptions::default()).unwrap();
        frames.aim(&second).unwrap();
        let aimed = frames.finish().unwrap();
        let anew = engine.render(&scene, &second, &wanted, &RunOptions::default()).unwrap();
        assert!(aimed.sample_ids == anew.sample_ids && aimed.frame == anew.frame, "{}", second.kind);
    }
}

/// A ball before walls of large triangles: about a tenth of all pixels are edge pixels.
fn ball() -> Scene {
    let mut all = icosphere(3);
    let walls = soup(&mut Rng(11), 8, 1.5);
    let first = all.positions.len() as u32;
    all.positions.extend(walls.positions.iter().map(|p| *p - DVec3::Z));
    all.triangles.extend(walls.triangles.iter().map(|t| t.map(|v| v + first)));
    all.corner_normals.extend(vec![[anamorph::internals::gpu::layout::NONE; 3]; walls.triangles.len()]);
    all.material_of.extend(vec![0; walls.triangles.len()]);
    scene(all)
}

/// What pictures of so many samples come to, counted or by areas, against the truth.
fn decibels(
    engine: &mut Engine,
    scene: &Scene,
    camera: &Camera,
    truth: &Colours,
    (samples, analytic): (u32, bool),
) -> f64 {
    let wanted = Wanted { samples, analytic, ..Wanted::of(pictures::COLOUR.to_vec()) };
    let seen = engine.render(scene, camera, &wanted, &RunOptions::default()).unwrap();
    psnr(&colours(&seen.frame), truth)
}

#[test]
#[ignore = "slow: make test-all"]
fn sixteen_samples_come_near_the_box_filter() {
    let scene = ball();
    let Some(mut engine) = engine_on(|_| {}) else { return };
    for (name, camera) in cameras() {
        let truth = box_filtered(&scene, &camera, 64);
        let settings = [(1, false), (4, false), (16, false), (16, true)];
        let errors = settings.map(|setting| decibels(&mut engine, &scene, &camera, &truth, setting));
        println!("{name}: {errors:.1?} dB at 1, 4 and 16 samples, and 16 by areas");
        assert!(errors[2] >= 35.0 && errors[1] > errors[0] && errors[2] > errors[0], "{name}: {errors:?}");
        assert!(errors[3] >= 35.0, "{name}: {errors:?}");
    }
}

/// What no sample sees has no area: that of small triangles goes to what lies behind, unless samples are many.
#[test]
#[ignore = "slow: make test-all"]
fn areas_of_large_triangles_come_nearer_than_as_many_samples_counted() {
    let scene = scene(soup(&mut Rng(11), 8, 1.5));
    let Some(mut engine) = engine_on(|_| {}) else { return };
    for (name, camera) in cameras() {
        let truth = box_filtered(&scene, &camera, 144);
        for samples in [4, 16] {
            let settings = [(samples, false), (samples, true)];
            let [counted, areas] = settings.map(|setting| decibels(&mut engine, &scene, &camera, &truth, setting));
            println!("{name}, {samples} samples: {counted:.1} dB counted, {areas:.1} dB by areas");
            assert!(areas > counted, "{name}: {counted} dB counted, {areas} dB by areas");
        }
    }
}

/// Places are found in f32 from numbers of at most 4, in some ten roundings, and pixels are 1/24 wide.
const AREA_ERROR: f64 = 10.0 * 4.0 * 24.0 / 16_777_216.0;

#[test]
fn coverage_is_the_area_of_what_is_seen() {
    let Some(mut engine) = engine_on(|_| {}) else { return };
    let text = "kind = \"orthographic\"\neye = [0, 0, 4]\ntarget = [0, 0, 0]\nheight = 2";
    let camera = camera_of("", (48, 48), text).unwrap();
    let corner = |x: f64, y: f64| DVec3::new(x, y, 0.0);
    let on_image = |p: DVec3| DVec2::new(24.0 * (p.x + 1.0) - 0.5, 24.0 * (1.0 - p.y) - 0.5);
    let triangle = [corner(-0.83, -0.61), corner(0.77, -0.39), corner(0.11, 0.93)];
    let counted = Wanted { samples: 16, ..Wanted::of(vec![Channel::A]) };
    let areas = Wanted { analytic: true, ..counted.clone() };
    let behind = triangle.map(|p| corner(-p.x, -0.8 * p.y) - DVec3::Z);
    let alone = scene(mesh(triangle.to_vec(), vec![[0, 1, 2]]));
    let before = scene(mesh([triangle, behind].concat(), vec![[0, 1, 2], [3, 4, 5]]));
    // down the image, so that what goes around counterclockwise there goes around clockwise here
    let on_image = |corners: [DVec3; 3]| corners.map(on_image).into_iter().rev().collect::<Vec<_>>();
    let [triangle, behind] = [triangle, behind].map(on_image);
    for (name, scene) in [("alone", alone), ("before another", before)] {
        let [some, alpha] = [&counted, &areas].map(|wanted| {
            let seen = engine.render(&scene, &camera, wanted, &RunOptions::default()).unwrap();
            seen.frame.f32(Channel::A).unwrap().to_vec()
        });
        let mut borders = 0;
        for (k, alpha) in alpha.iter().enumerate() {
            // of which samples see both the triangle and nothing
            if some[k] > 0.0 && some[k] < 1.0 {
                let pixel = DVec2::new((k % 48) as f64, (k / 48) as f64);
                let square = pixel_about(pixel);
                let of = |outline: &[DVec2]| area(&polygon::common(outline.to_vec(), &square));
                let beside = of(&behind) - of(&polygon::common(behind.clone(), &triangle));
                let area = of(&triangle) + if name == "alone" { 0.0 } else { beside };
                borders += 1;
                assert!((f64::from(*alpha) - area).abs() <= AREA_ERROR, "{name}, pixel {pixel}: {alpha} for {area}");
            }
        }
        assert!(borders > 50, "{name}: {borders}");
    }
}

#[test]
fn areas_are_of_several_samples_and_of_all_triangles_at_once() {
    let Some(mut engine) = engine_on(|_| {}) else { return };
    let (_, kind) = glc_of_each_class().swap_remove(3);
    let camera = camera(kind, SIZE, FORWARD);
    let areas = |samples| Wanted { samples, analytic: true, ..Wanted::of(vec![Channel::A]) };
    let refused = engine.render(&crowd(), &camera, &areas(1), &RunOptions::default()).unwrap_err().to_string();
    assert!(refused.contains("use at least 2"), "{refused}");
    let Some(mut small) = engine_on(|gpu| limit_bindings(gpu, 1 << 15)) else { return };
    let many = scene(soup(&mut Rng(5), 3000, 0.2));
    let refused = small.render(&many, &camera, &areas(4), &RunOptions::default()).unwrap_err().to_string();
    assert!(refused.contains("all triangles in one table"), "{refused}");
}

/// Curves, and a mirror.
const ONE_BY_ONE: [&str; 2] = [
    "kind = \"twist\"\neye = [0.2, 0.3, 4]\ntarget = [0, 0, 0]\nvfov = 40\ndegree = 3\nangle = 40",
    r#"kind = "reflection"
eye = { kind = "pinhole", eye = [0.2, 0.4, 4], target = [0, 0, 0], vfov = 40 }
mirror = { shape = "sphere", center = [0.9, 0.6, 1.2], radius = 0.6 }
depth = 1"#,
];

#[test]
#[ignore = "slow: make test-all"]
fn sixteen_frames_come_as_near_where_each_sample_takes_one() {
    let scene = ball();
    let Some(mut engine) = engine_on(|_| {}) else { return };
    for text in ONE_BY_ONE {
        let camera = camera_of("", SIZE, text).unwrap();
        assert!(!at_once(&scene, &camera, 16));
        let wanted = Wanted { samples: 16, ..Wanted::of(vec![Channel::R, Channel::G, Channel::B]) };
        let frame = engine.render(&scene, &camera, &wanted, &RunOptions::default()).unwrap().frame;
        let error = psnr(&colours(&frame), &box_filtered(&scene, &camera, 256));
        println!("{}: {error:.1} dB", camera.kind);
        assert!(error >= 35.0, "{}: {error:.1} dB", camera.kind);
    }
}

#[test]
fn a_pixel_without_an_edge_pays_one_sample() {
    let (_, kind) = glc_of_each_class().swap_remove(3);
    let camera = camera(kind, SIZE, FORWARD);
    let corners = [DVec3::new(-90.0, -90.0, 0.1), DVec3::new(90.0, -90.0, 0.2), DVec3::new(0.0, 90.0, 0.3)];
    let behind = corners.iter().map(|p| DVec3::new(p.x / 100.0, p.y / 100.0, p.z - 1.0));
    let positions = corners.iter().copied().chain(behind).collect();
    let Some(mut engine) = engine_on(|_| {}) else { return };
    // all of a small triangle lies behind a large one
    let hidden = scene(mesh(positions, vec![[0, 1, 2], [3, 4, 5]]));
    let seen = sampled(&mut engine, &hidden, &camera, 16, &RunOptions::default());
    assert!(ids(&seen.frame).iter().all(|id| *id == 0));
    assert_eq!(seen.counts.edges, 0);
    // and a line of pixels holds the border of a half plane
    let half = scene(mesh(
        vec![DVec3::new(0.013, -90.0, 0.0), DVec3::new(90.0, 0.0, 0.0), DVec3::new(0.013, 90.0, 0.0)],
        vec![[0, 1, 2]],
    ));
    let seen = sampled(&mut engine, &half, &camera, 16, &RunOptions::default());
    assert_eq!(seen.counts.edges, u64::from(SIZE.1));
}

/// Of shares of four samples, added up chunk by chunk: in f32, of at most 1, a product, a sum and a quotient each.
const SUM_ERROR: f64 = 4.0 * 3.0 / 16_777_216.0;

#[test]
#[ignore = "slow: make test-all"]
fn lists_grow_and_bands_and_chunks_join_to_the_same_samples() {
    // their rows take more than a small binding holds
    let scene = scene(soup(&mut Rng(5), 3000, 0.2));
    let (_, kind) = glc_of_each_class().swap_remove(3);
    // a row of tiles of a ray map takes 24 bytes per sample
    for (camera, limit) in [(camera(kind, SIZE, FORWARD), 1 << 15), (raymap(SIZE.0, SIZE.1, FORWARD), 1 << 16)] {
        let Some(mut whole) = engine_on(|_| {}) else { return };
        let ample = sampled(&mut whole, &scene, &camera, 4, &RunOptions::default());
        let few = Capacities { queue: 1, work: 1, tasks: 1, pairs: 1, recheck_items: 1, edges: 1 };
        let run = RunOptions { capacities: Some(few), ..Default::default() };
        let small = |limit: u64| engine_on(|gpu| limit_bindings(gpu, limit));
        let without = |int64: bool| engine_on(|gpu| gpu.has.atomics64 &= int64);
        for (name, engine) in [
            ("lists of one item", engine_on(|_| {})),
            ("small bindings", small(limit)),
            ("32-bit atomics", without(false)),
        ] {
            let Some(mut engine) = engine else { return };
            let other = sampled(&mut engine, &scene, &camera, 4, &run);
            assert!(other.sample_ids == ample.sample_ids, "{name}");
            let off = colours(&other.frame)
                .into_iter()
                .zip(colours(&ample.frame))
                .flat_map(|(a, b)| (0..3).map(move |k| (a[k] - b[k]).abs()));
            let largest = off.fold(0.0, f64::max);
            assert!(largest <= SUM_ERROR, "{name}: {largest:e}");
            assert_eq!(other.frame.f32(Channel::A), ample.frame.f32(Channel::A), "{name}");
        }
    }
}

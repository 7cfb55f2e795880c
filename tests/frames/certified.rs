//! The channel `certified`: what is proven is right, most is proven, and nothing that cannot be is.

use crate::common;

use anamorph::internals::camera::Camera;
use anamorph::internals::engine::plan::Wanted;
use anamorph::internals::engine::{Capacities, RunOptions};
use anamorph::internals::geometry::place;
use anamorph::internals::image::frame::{Channel, Frame, NO_ID};
use anamorph::internals::reference::image::image;
use anamorph::internals::scene::Scene;
use common::cameras::{MeshShape, glc_of_each_class, mesh_camera, pinhole, raymap};
use common::file::camera_of;
use common::gpu::{Without, engine, engine_on, ids, limit_bindings, words};
use common::rng::Rng;
use common::{ALL_T, FORWARD, camera, mesh, scene, soup};
use glam::{DMat3, DVec3};

const SIZE: (u32, u32) = (101, 77);

/// Share of an ordinary picture that is proven, measured: 1.
const PROVEN_LEAST: f64 = 0.999;

fn wanted() -> Wanted {
    Wanted::of(vec![Channel::TriangleId, Channel::Certified])
}

fn certified(scene: &Scene, camera: &Camera, without: Without) -> Option<Frame> {
    Some(engine(camera, without)?.render(scene, camera, &wanted(), &RunOptions::default()).unwrap().frame)
}

fn proven(frame: &Frame) -> &[u32] {
    frame.u32(Channel::Certified).unwrap()
}

fn share(frame: &Frame, at_least: u32) -> f64 {
    proven(frame).iter().filter(|p| **p >= at_least).count() as f64 / proven(frame).len() as f64
}

/// The pixels that are proven to have a triangle that the reference does not see there.
fn wrong(scene: &Scene, camera: &Camera, frame: &Frame) -> Vec<usize> {
    let truth = image(scene, camera, &[Channel::TriangleId]);
    (0..ids(frame).len()).filter(|&k| proven(frame)[k] > 0 && ids(frame)[k] != ids(&truth)[k]).collect()
}

fn cameras() -> Vec<(String, Camera)> {
    let glcs = glc_of_each_class().into_iter().map(|(name, kind)| (name.to_owned(), camera(kind, SIZE, FORWARD)));
    let weighted = MeshShape { weights: true, ..MeshShape::default() };
    let more = [
        ("negative t", camera(pinhole(DVec3::new(0.0, 0.0, 0.1), DVec3::X, 60.0), SIZE, ALL_T)),
        ("mesh", camera(mesh_camera(1, 16, 16, MeshShape::default()), SIZE, FORWARD)),
        ("weighted mesh", camera(mesh_camera(2, 5, 5, weighted), SIZE, FORWARD)),
        ("ray map", raymap(SIZE.0, SIZE.1, FORWARD)),
        (
            "curves",
            camera_of("", SIZE, "kind = \"twist\"\neye = [0, 0.3, 4]\nvfov = 40\ndegree = 3\nangle = 70").unwrap(),
        ),
        (
            "chain",
            camera_of(
                "",
                SIZE,
                "kind = \"occlusion\"\neye = [0, 1.2, 5]\nvfov = 40\nnear = 4\nfar = 6\ndistortion = [0.05, 0.1]",
            )
            .unwrap(),
        ),
    ];
    glcs.chain(more.map(|(name, camera)| (name.to_owned(), camera))).collect()
}

/// A ball among small triangles, turned so that no edge lies along a line of pixels.
fn crowd() -> Scene {
    let mut ball = anamorph::internals::geometry::generate::icosphere(3);
    let turn = DMat3::from_rotation_x(0.3) * DMat3::from_rotation_z(0.2);
    ball.positions.iter_mut().for_each(|p| *p = 0.7 * turn * *p);
    scene(place::merge(vec![ball, soup(&mut Rng(1), 240, 0.3)]).unwrap())
}

#[test]
fn most_of_an_ordinary_picture_is_proven_and_nothing_proven_is_wrong() {
    for (name, camera) in cameras() {
        for without in [Without::Nothing, Without::Int64Atomics] {
            assert_most_is_proven_and_right(&name, &camera, without);
        }
    }
}

/// Kernels with f64 in words take a software adapter long to compile: one of them.
#[test]
#[ignore = "slow: make test-all"]
fn most_is_proven_without_f64_too() {
    let (name, camera) = cameras().into_iter().find(|(name, _)| name == "pinhole").unwrap();
    assert_most_is_proven_and_right(&name, &camera, Without::F64);
}

fn assert_most_is_proven_and_right(name: &str, camera: &Camera, without: Without) {
    let scene = crowd();
    let Some(frame) = certified(&scene, camera, without) else { return };
    let wrong = wrong(&scene, camera, &frame);
    println!("{name}, without {without:?}: {:.4} by f32, {:.4} in all", share(&frame, 2), share(&frame, 1));
    assert!(wrong.is_empty(), "{name}: {} proven pixels are wrong, the first is {}", wrong.len(), wrong[0]);
    assert!(share(&frame, 1) >= PROVEN_LEAST, "{name}, without {without:?}: {} proven", share(&frame, 1));
}

/// Two walls whose order f64 cannot tell from their stored corners, and far enough apart that it can.
#[test]
fn an_order_within_rounding_is_not_proven() {
    let wall = |z: f64| [DVec3::new(-3.0, -3.1, z), DVec3::new(3.3, -3.0, z), DVec3::new(0.1, 4.0, z)];
    let eye = camera(pinhole(DVec3::new(0.1, 0.2, 4.0), DVec3::new(0.1, 0.2, 0.0), 20.0), SIZE, FORWARD);
    for (gap, share_least, share_most) in [(1e-16, 0.0, 0.0), (1e-5, 1.0, 1.0)] {
        let walls = scene(mesh([wall(0.0), wall(gap)].concat(), vec![[0, 1, 2], [3, 4, 5]]));
        let Some(frame) = certified(&walls, &eye, Without::Nothing) else { return };
        assert!((share_least..=share_most).contains(&share(&frame, 1)), "{gap}: {}", share(&frame, 1));
    }
}

/// A height field with a vertex `off` px from the ray of every third pixel.
fn field(off: f64) -> Scene {
    const SIDE: u32 = 24;
    let px = 2.0 / 72.0;
    let mut rng = Rng(5);
    let at = |n: u32| [n % (SIDE + 1), n / (SIDE + 1)].map(|k| (f64::from(3 * k) + 0.5) * px - 1.0);
    let vertex = |n: u32| DVec3::new(at(n)[0], -at(n)[1], 0.0) + DVec3::new(off * px, off * px, 0.3) * rng.vector();
    let positions = (0..(SIDE + 1) * (SIDE + 1)).map(vertex).collect();
    let cell = |n: u32| {
        let a = n / SIDE * (SIDE + 1) + n % SIDE;
        [[a, a + SIDE + 1, a + 1], [a + 1, a + SIDE + 1, a + SIDE + 2]]
    };
    scene(mesh(positions, (0..SIDE * SIDE).flat_map(cell).collect()))
}

#[test]
fn a_pixel_whose_ray_meets_a_vertex_is_not_proven_and_one_beside_it_is_by_the_recheck() {
    let along_z = "kind = \"orthographic\"\neye = [0, 0, 2]\ntarget = [0, 0, 0]\nheight = 2";
    let eye = camera_of("", (72, 72), along_z).unwrap();
    for off in [0.0, 1e-6] {
        let field = field(off);
        let Some(frame) = certified(&field, &eye, Without::Nothing) else { return };
        assert!(wrong(&field, &eye, &frame).is_empty());
        println!("{off:e} px: {:.4} by f32, {:.4} in all", share(&frame, 2), share(&frame, 1));
        for (k, p) in proven(&frame).iter().enumerate() {
            let [i, j] = [k % 72, k / 72];
            let is_at_vertex = i % 3 == 0 && j % 3 == 0;
            assert_eq!(is_at_vertex && *p == 0, is_at_vertex && off == 0.0, "{off:e} px: pixel {i},{j} is {p}");
        }
        if off > 0.0 {
            assert_eq!(share(&frame, 1), 1.0);
        }
    }
}

/// A wrong id where all is proven is seen: the comparison can fail.
#[test]
fn a_planted_error_is_wrong() {
    let scene = crowd();
    let eye = camera(pinhole(DVec3::new(0.0, 0.0, 4.0), DVec3::ZERO, 40.0), SIZE, FORWARD);
    let Some(mut frame) = certified(&scene, &eye, Without::Nothing) else { return };
    let at = ids(&frame).iter().position(|id| *id != NO_ID).unwrap();
    let (_, plane) = frame.planes.iter_mut().find(|p| p.0 == Channel::TriangleId).unwrap();
    if let anamorph::internals::image::frame::Plane::U32(ids) = plane {
        ids[at] += 1;
    }
    assert_eq!(wrong(&scene, &eye, &frame), [at]);
}

/// Lists that grow, small bindings that split the image and the scene, and jobs one after the other: one map.
#[test]
#[ignore = "slow: make test-all"]
fn the_map_is_the_same_however_the_frame_is_split() {
    let scene = scene(soup(&mut Rng(9), 3000, 0.1));
    let Some(mut in_bands) = engine_on(|gpu| limit_bindings(gpu, 1 << 16)) else { return };
    for (name, camera) in cameras() {
        let Some(whole) = certified(&scene, &camera, Without::Nothing) else { return };
        let small = RunOptions {
            capacities: Some(Capacities { queue: 1, work: 1, tasks: 1, pairs: 1, recheck_items: 1, edges: 1 }),
            ..Default::default()
        };
        let frame = in_bands.render(&scene, &camera, &wanted(), &small).unwrap().frame;
        let differ = words(&frame).iter().zip(words(&whole)).filter(|(a, b)| **a != *b).count();
        assert_eq!(differ, 0, "{name}: {differ} words differ");
    }
}

#[test]
fn what_proves_nothing_says_so_in_a_line() {
    let scene = crowd();
    let eye = camera(pinhole(DVec3::new(0.0, 0.0, 4.0), DVec3::ZERO, 40.0), SIZE, FORWARD);
    let Some(mut engine) = engine(&eye, Without::Nothing) else { return };
    let by = RunOptions { rival: Some(anamorph_lab::rivals::parse("raytrace").unwrap()), ..Default::default() };
    let error = engine.render(&scene, &eye, &wanted(), &by).unwrap_err().to_string();
    assert!(error.contains("raytrace cannot certify pixels") && !error.contains('\n'), "{error}");
    let mirror = "kind = \"reflection\"\neye = { kind = \"pinhole\", eye = [0, 0, 5], target = [0, 0, 0], vfov = 40 }\n\
        mirror = { shape = \"sphere\", center = [0, 0, 0], radius = 1 }";
    let mirror = camera_of("", SIZE, mirror).unwrap();
    let error = engine.render(&scene, &mirror, &wanted(), &RunOptions::default()).unwrap_err().to_string();
    assert!(error.contains("without bounds") && !error.contains('\n'), "{error}");
}

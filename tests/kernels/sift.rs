//! sift: the kernel against its twin from the same bytes, its lists against the tree in f64, and the tree against its own
//! leaves, for cameras of every kind.

use crate::common::cameras::{MeshShape, glc_of_each_class, mesh_camera, pinhole, raymap};
use crate::common::projection::gpu;
use crate::common::rng::Rng;
use crate::common::{ALL_T, FORWARD, camera};
use anamorph::internals::camera::mesh::spec::MeshCameraSpec;
use anamorph::internals::camera::project::Projector;
use anamorph::internals::camera::project::tree::{INNER, Tree, WHOLE};
use anamorph::internals::camera::spec::CameraKind;
use anamorph::internals::camera::{Camera, Curve, CurveMap, Curves, Field, Ray, RayMap, Rays};
use anamorph::internals::engine::plan::beams::Beams;
use anamorph::internals::engine::stage::sift::Sift;
use anamorph_lab::twin::sift::{Bound, sift};
use glam::{DVec2, DVec3};
use std::sync::Arc;

const SIZE: (u32, u32) = (120, 88);

/// All round about the y axis, from a ring of eyes.
#[derive(Debug)]
struct Ring;

impl RayMap for Ring {
    fn ray(&self, a: f64, b: f64) -> Option<Ray> {
        let (sin, cos) = (std::f64::consts::TAU * a).sin_cos();
        let out = DVec3::new(sin, 0.0, -cos);
        Some(Ray { origin: 3.0 * out, direction: out + DVec3::Y * (1.0 - 2.0 * b) })
    }
}

/// Cubic curves from z = 2 to z = -2.
#[derive(Debug)]
struct Bent;

impl CurveMap for Bent {
    fn degree(&self) -> usize {
        3
    }

    fn curve(&self, a: f64, b: f64) -> Option<(u32, Curve)> {
        let q = 2.2 * DVec2::new(a - 0.5 + 0.05 * (9.0 * b).sin(), 0.5 - b);
        let at = |x: f64, z: f64| (1.2 * q + DVec2::new(x, 0.2 * x)).extend(z);
        Some((0, Curve::new(&[at(0.0, 2.0), at(0.9, 0.8), at(-0.5, -0.9), at(0.0, -2.0)])))
    }
}

/// The same rays somewhere else, and everything larger.
fn far_off(kind: CameraKind, by: DVec3, scale: f64) -> CameraKind {
    let Some(mut mesh) = kind.recipe::<MeshCameraSpec>().cloned() else { return kind };
    for v in &mut mesh.vertices {
        (v.near, v.far) = (scale * v.near + by, scale * v.far + by);
    }
    CameraKind::new("mesh", mesh)
}

/// Cameras, and the cube that their points are in: its centre and half its side.
fn cameras() -> Vec<(String, Camera, DVec3, f64)> {
    let mut all: Vec<(String, Camera)> = vec![
        ("pinhole".into(), camera(pinhole(DVec3::new(0.3, 0.4, 4.0), DVec3::ZERO, 40.0), SIZE, FORWARD)),
        ("table".into(), raymap(SIZE.0, SIZE.1, FORWARD)),
        ("segment of a table".into(), raymap(SIZE.0, SIZE.1, [0.4, 0.6])),
        (
            "ring".into(),
            Camera::of("ring", SIZE, ALL_T, Rays::Field(Field::of_map(SIZE.0, SIZE.1, Arc::new(Ring)).unwrap())),
        ),
        (
            "curves".into(),
            Camera::of("projector", SIZE, [0.0, 1.0], Rays::Curves(Curves::new(SIZE.0, SIZE.1, Arc::new(Bent)))),
        ),
    ];
    for (name, kind) in glc_of_each_class() {
        all.push((name.into(), camera(kind, SIZE, ALL_T)));
    }
    for weights in [false, true] {
        let shape = MeshShape { weights, discontinuous: weights, ..Default::default() };
        all.push((format!("{shape:?}"), camera(mesh_camera(3, 20, 15, shape), SIZE, FORWARD)));
    }
    let mut chain = camera(mesh_camera(4, 9, 7, MeshShape::default()), SIZE, [0.0, 1.0]);
    chain.layers.extend(all[4].1.layers.clone());
    all.push(("chain".into(), chain));
    let mut placed: Vec<_> = all.into_iter().map(|(name, camera)| (name, camera, DVec3::ZERO, 0.5)).collect();
    for (by, scale) in [(DVec3::new(1e5, -2e5, 3e5), 1.0), (DVec3::ZERO, 1e-20), (DVec3::splat(3e24), 1e22)] {
        let kind = far_off(mesh_camera(5, 20, 15, MeshShape::default()), by, scale);
        placed.push((format!("at {by}, {scale:e}"), camera(kind, SIZE, FORWARD), by, 0.5 * scale));
    }
    placed
}

fn points(centre: DVec3, half: f64, seed: u64, count: usize) -> Vec<DVec3> {
    let mut rng = Rng(seed);
    // one in eight is outside
    (0..count).map(|k| centre + if k % 8 == 0 { 40.0 * half } else { half } * rng.vector()).collect()
}

fn walked(tree: &Tree, point: DVec3, from: &[u32]) -> Vec<u32> {
    let mut leaves = Vec::new();
    tree.walk(point, from, |leaf| leaves.push(leaf));
    leaves
}

#[test]
fn a_walk_from_the_top_finds_what_every_leaf_by_itself_does() {
    for (name, camera, centre, half) in cameras() {
        for tree in Projector::new(&camera).trees() {
            let leaves: Vec<u32> =
                (0..tree.nodes.len() as u32).filter(|&k| tree.nodes[k as usize].leaf != INNER).collect();
            let (mut met, mut all) = (0, 0);
            for point in points(centre, half, 1, 200) {
                let found = walked(tree, point, WHOLE);
                assert!(found == walked(tree, point, &leaves), "{name}: {point}");
                (met, all) = (met + found.len(), all + leaves.len());
            }
            // the widest beams, those of the discontinuous pieces, are 0.7 of 2.2 wide
            assert!(met > 100 && (leaves.len() == 1 || met < all / 10), "{name}: {met} of {all}");
        }
    }
}

/// A kernel's lists for points of a camera's layer, with what the twin must and may find.
#[test]
fn the_kernel_lists_what_its_twin_must_and_no_more_than_it_may() {
    let Some(gpu) = gpu() else { return };
    for (name, camera, centre, half) in cameras() {
        let projector = Projector::new(&camera);
        let points = points(centre, half, 2, 2000);
        let mut kernel = Sift::new(gpu, &projector).unwrap();
        // the second chunk has as many slots as the first would have needed
        for _ in 0..2 {
            let started = kernel.start(&points).unwrap();
            let found = kernel.finish(started).unwrap();
            for (layer, tree) in projector.trees().enumerate() {
                let beams = Beams::new(tree, usize::MAX);
                let [mut needed, mut listed, mut allowed] = [0; 3];
                for (k, point) in points.iter().enumerate() {
                    let Some(count) = found.count(layer, k) else { panic!("{name}: {point} is in too many beams") };
                    let x = beams.point(*point).map(f64::from);
                    let twin = |bound| sift(&beams.nodes, beams.t_range, [x[0], x[1], x[2]], bound);
                    let (must, may) = (twin(Bound::NEEDED), twin(Bound::ALLOWED));
                    let is_sane = must.len() as u32 <= count && count <= may.len() as u32;
                    assert!(is_sane, "{name}: {point}: {} <= {count} <= {}", must.len(), may.len());
                    (needed, listed, allowed) = (needed + must.len(), listed + count as usize, allowed + may.len());
                    let list = found.nodes(layer, k);
                    if list == WHOLE {
                        continue;
                    }
                    assert!(list.is_sorted() && must.iter().all(|n| list.contains(n)), "{name}: {point}");
                    assert!(list.iter().all(|n| may.contains(n)), "{name}: {point}");
                }
                println!("{name}, layer {layer}: {needed} needed, {listed} listed, {allowed} allowed");
                assert!(needed > 1000, "{name}: {needed}");
            }
        }
    }
}

#[test]
fn lists_hold_all_leaves_of_the_tree_in_f64_and_few_more() {
    let Some(gpu) = gpu() else { return };
    for (name, camera, centre, half) in cameras() {
        let projector = Projector::new(&camera);
        let points = points(centre, half, 3, 2000);
        let mut kernel = Sift::new(gpu, &projector).unwrap();
        let started = kernel.start(&points).unwrap();
        let found = kernel.finish(started).unwrap();
        for (layer, tree) in projector.trees().enumerate() {
            let (mut exact, mut listed) = (0, 0);
            for (k, point) in points.iter().enumerate() {
                let leaves = walked(tree, *point, WHOLE);
                assert!(walked(tree, *point, found.nodes(layer, k)) == leaves, "{name}: {point}");
                exact += leaves.len();
                listed += found.count(layer, k).unwrap() as usize;
            }
            println!("{name}, layer {layer}: {exact} in f64, {listed} in f32");
            // a box in f32 is wider by some 2^-21 of the scene on each side, and beams are at least 1/100 of it wide;
            // at (1e5, ...) too, as boxes are about the anchor
            assert!(listed as f64 <= 1.01 * exact as f64, "{name}: {listed} against {exact}");
        }
    }
}

#[test]
fn trees_that_do_not_fit_are_cut_and_lists_that_run_over_start_at_the_top() {
    let Some(gpu) = gpu() else { return };
    let camera = camera(mesh_camera(3, 20, 15, MeshShape::default()), SIZE, FORWARD);
    let projector = Projector::new(&camera);
    let tree = projector.trees().next().unwrap();
    for most in [1, 7, 100] {
        let beams = Beams::new(tree, most);
        assert!(beams.nodes.len() <= most && beams.nodes.len() * 16 > most, "{most}: {}", beams.nodes.len());
        for point in points(DVec3::ZERO, 0.5, 4, 200) {
            let x = beams.point(point).map(f64::from);
            let list = sift(&beams.nodes, beams.t_range, [x[0], x[1], x[2]], Bound::NEEDED);
            assert!(walked(tree, point, &list) == walked(tree, point, WHOLE), "{most}: {point}");
        }
    }
    // all rays of a ring's row pass its axis, and points that far off are nobody's; after that the next chunk
    let eye = DVec3::new(0.3, 0.4, 4.0);
    let ring = Camera::of("ring", SIZE, ALL_T, Rays::Field(Field::of_map(SIZE.0, SIZE.1, Arc::new(Ring)).unwrap()));
    let projector = Projector::new(&ring);
    let mut kernel = Sift::new(gpu, &projector).unwrap();
    let crowd = vec![0.2 * DVec3::Y, 1e30 * DVec3::ONE, eye, f64::NAN * eye];
    for slots in [8, 256] {
        let started = kernel.start(&crowd).unwrap();
        let found = kernel.finish(started).unwrap();
        assert_eq!((found.nodes(0, 0) == WHOLE, found.nodes(0, 1), found.nodes(0, 3)), (slots == 8, WHOLE, WHOLE));
        assert!(found.count(0, 0).is_some_and(|n| n > 100) && found.count(0, 1).is_none(), "{:?}", found.count(0, 0));
    }
}

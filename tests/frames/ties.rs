//! Rays on edges and through vertices: the engine sees the reference's triangle there too. Skipped without an adapter.
//!
//! Meshes are built from a camera's own rays: corners lie on the rays of pixels, and edges meet those of the pixels between. Nothing is
//! exact in f64, so most rays miss by a rounding the edge that they should meet.

use crate::common;

use anamorph::internals::camera::{Camera, Field, Rays};
use anamorph::internals::engine::RunOptions;
use anamorph::internals::engine::plan::Wanted;
use anamorph::internals::geometry::mesh::Mesh;
use anamorph::internals::image::frame::{Channel, Frame, NO_ID};
use anamorph::internals::reference::image::image;
use anamorph::internals::scene::Scene;
use common::cameras::{MeshShape, glc_of_each_class, mesh_camera, raymap};
use common::file::{camera_of, scene_of};
use common::gpu::{Without, engine, ids};
use common::rng::Rng;
use common::{FORWARD, camera, mesh, scene};
use glam::DVec3;

/// Primes, so that pixel centres are no simple fractions.
const SIZE: (u32, u32) = (97, 61);

/// The frame's triangle ids, and the certified channel if asked for.
fn frame(scene: &Scene, camera: &Camera, without: Without, certified: bool) -> Option<Frame> {
    let channels = [Channel::TriangleId].into_iter().chain(certified.then_some(Channel::Certified)).collect();
    Some(engine(camera, without)?.render(scene, camera, &Wanted::of(channels), &RunOptions::default()).unwrap().frame)
}

/// What the reference sees.
fn truth(scene: &Scene, camera: &Camera) -> Frame {
    image(scene, camera, &[Channel::TriangleId])
}

/// Pixels whose triangle is not the reference's.
fn differing(frame: &Frame, truth: &Frame) -> Vec<usize> {
    (0..ids(frame).len()).filter(|&k| ids(frame)[k] != ids(truth)[k]).collect()
}

/// How the corners of a grid lie along their rays.
#[derive(Debug, Clone, Copy)]
enum Depth {
    /// At one t: edges are straight through the rays between, whatever the camera.
    Even,
    /// At different t: for rays that meet in one point or are parallel, edges still meet the rays between.
    Uneven,
}

/// A grid of triangles over all pixels with a ray, a corner on the ray of every `step`th pixel; diagonals and windings are random.
fn grid(camera: &Camera, step: u32, t: f64, depth: Depth, rng: &mut Rng) -> Mesh {
    let (columns, rows) = (camera.width.div_ceil(step), camera.height.div_ceil(step));
    let mut positions = Vec::new();
    let mut has_ray = Vec::new();
    for (i, j) in (0..rows).flat_map(|j| (0..columns).map(move |i| (i, j))) {
        let t = match depth {
            Depth::Even => t,
            Depth::Uneven => t * (1.0 + 0.1 * rng.signed()),
        };
        let ray = camera.ray(step * i, step * j);
        has_ray.push(ray.is_some());
        positions.push(ray.map_or(DVec3::ZERO, |r| r.origin + t * r.direction));
    }
    let mut triangles = Vec::new();
    for (i, j) in (0..rows - 1).flat_map(|j| (0..columns - 1).map(move |i| (i, j))) {
        let k = j * columns + i;
        let below = k + columns;
        let halves = [[[k, k + 1, below], [below + 1, k + 1, below]], [[k, k + 1, below + 1], [k, below + 1, below]]];
        for [a, b, c] in halves[rng.below(2)] {
            if [a, b, c].iter().all(|&v| has_ray[v as usize]) {
                triangles.push([[a, b, c], [b, c, a], [c, b, a]][rng.below(3)]);
            }
        }
    }
    mesh(positions, triangles)
}

/// Cameras of pieces and of fields; first those whose rays are parallel or meet in one point.
fn cameras() -> Vec<(String, Camera, Depth)> {
    let of = |keys: &str| camera_of("", SIZE, keys).unwrap();
    let view = "eye = [0.3, 1.7, 6.1]\ntarget = [-0.2, 0.1, 0.3]";
    let mut list: Vec<(String, Camera, Depth)> = [
        ("pinhole", format!("kind = \"pinhole\"\n{view}\nvfov = 37"), Depth::Uneven),
        (
            "pinhole along an axis",
            "kind = \"pinhole\"\neye = [0, 0, 6]\ntarget = [0, 0, 0]\nvfov = 40".into(),
            Depth::Uneven,
        ),
        ("orthographic", format!("kind = \"orthographic\"\n{view}\nheight = 3.7"), Depth::Uneven),
        ("sphere", format!("kind = \"sphere\"\n{view}\nlon = [-40, 40]\nlat = [-30, 30]"), Depth::Uneven),
        ("fisheye", format!("kind = \"fisheye\"\n{view}\nfov = 150"), Depth::Uneven),
        ("pencil", format!("kind = \"pencil\"\n{view}\nvfov = 40\nslit = 2"), Depth::Even),
        ("twisted", format!("kind = \"twisted\"\n{view}\nheight = 3\nangle = 20"), Depth::Even),
        (
            "pushbroom",
            "kind = \"pushbroom\"\nstart = [-3.1, 1.3, 5.7]\nend = [2.9, 1.3, 5.7]\nlook = [0, -0.2, -1]\nvfov = 41"
                .into(),
            Depth::Even,
        ),
        (
            "cross-slit",
            "kind = \"glc\"\nnear = [[-1.1, 1, 2], [1.1, 1, 2], [-1.1, -1, 2]]\n\
             far = [[-3.3, 2.1, -2], [3.3, 2.1, -2], [-3.3, -2.1, -2]]"
                .into(),
            Depth::Even,
        ),
    ]
    .map(|(name, keys, depth)| (name.to_owned(), of(&keys), depth))
    .into();
    for (name, kind) in glc_of_each_class() {
        list.push((format!("{name} glc"), camera(kind, SIZE, FORWARD), Depth::Even));
    }
    let weighted = MeshShape { weights: true, ..MeshShape::default() };
    list.push(("mesh".into(), camera(mesh_camera(1, 3, 2, MeshShape::default()), SIZE, FORWARD), Depth::Even));
    list.push(("weighted mesh".into(), camera(mesh_camera(2, 3, 2, weighted), SIZE, FORWARD), Depth::Even));
    list.push(("ray map".into(), raymap(SIZE.0, SIZE.1, FORWARD), Depth::Even));
    list
}

/// Pixels that may differ. Where neighbouring rays bend sharply, as at the rim of a fisheye and between weighted pieces, an edge may happen
/// to run along the perturbation. No edge of the other cameras does.
fn most_differing(name: &str) -> usize {
    usize::from(["fisheye", "weighted mesh"].contains(&name))
}

#[test]
fn rays_on_edges_and_through_corners_see_the_references_triangle() {
    for (name, camera, depth) in cameras() {
        let most = most_differing(&name);
        for (seed, step) in (1..).zip([1, 2, 3, 5]) {
            let grid_scene = scene(grid(&camera, step, 0.7, depth, &mut Rng(seed)));
            let truth = truth(&grid_scene, &camera);
            // other arithmetic where most corners meet, and where fewest do
            let others = [Without::Int64Atomics, Without::F64Depths].into_iter().filter(|_| [1, 5].contains(&step));
            for without in [Without::Nothing].into_iter().chain(others) {
                let Some(frame) = frame(&grid_scene, &camera, without, false) else { return };
                let differ = differing(&frame, &truth);
                let hits = ids(&frame).iter().filter(|id| **id != NO_ID).count();
                let what = format!("{name}, a corner every {step} px, without {without:?}");
                assert!(3 * hits > ids(&frame).len(), "{what}: {hits} hits");
                assert!(differ.len() <= most, "{what}: {} pixels differ, the first is {}", differ.len(), differ[0]);
            }
        }
    }
}

/// Two cameras only: f64 in 32-bit words takes a software adapter long to compile.
#[test]
fn f64_in_words_decides_alike() {
    let all = cameras();
    for name in ["pinhole", "ray map"] {
        let (_, camera, depth) = all.iter().find(|c| c.0 == name).unwrap();
        let grid_scene = scene(grid(camera, 2, 0.7, *depth, &mut Rng(3)));
        let Some(frame) = frame(&grid_scene, camera, Without::F64, false) else { return };
        assert_eq!(differing(&frame, &truth(&grid_scene, camera)), [0; 0], "{name}");
    }
}

/// The lines where a city's walls meet its ground run along rows of pixels of a pushbroom, up to rounding.
#[test]
fn a_citys_walls_meet_the_ground_on_rows_of_pixels() {
    let city = "[[mesh]]\nbuiltin = \"city\"\nseed = 7\ntriangles = 15000";
    let pushbroom = "kind = \"glc\"\nnear = [[-30.5, 26.6, 40], [30.5, 26.6, 40], [-30.5, 10.6, 40]]\n\
        far = [[-30.5, 21, -40], [30.5, 21, -40], [-30.5, -59, -40]]";
    let scene = scene_of(city, (160, 120), pushbroom).unwrap();
    let camera = scene.camera().unwrap();
    let Some(frame) = frame(&scene, &camera, Without::Nothing, false) else { return };
    assert_eq!(differing(&frame, &truth(&scene, &camera)), [0; 0]);
}

/// A single ray, which has no neighbours to be perturbed towards, enters a cube through a corner, an edge or a face's diagonal.
#[test]
fn a_lone_ray_enters_a_closed_mesh_through_its_corners_and_edges() {
    let sign = |bit: u32| if bit == 0 { -1.0 } else { 1.0 };
    let corners = (0..8).map(|k| DVec3::new(sign(k & 1), sign(k & 2), sign(k & 4))).collect();
    let face = |(axis, base): (u32, u32)| {
        let (b, c) = (1 << ((axis + 1) % 3), 1 << ((axis + 2) % 3));
        [[base, base | b, base | b | c], [base, base | b | c, base | c]]
    };
    let faces = (0..3).flat_map(|axis| [(axis, 0), (axis, 1 << axis)]).flat_map(face).collect();
    let cube = scene(mesh(corners, faces));
    // all numbers are exact, so the rays meet these points exactly
    let places = (0..8).map(|k: u32| DVec3::new(f64::from(k & 1), f64::from(k >> 1 & 1), f64::from(k >> 2)) - 1.0);
    for (at, d) in places.flat_map(|at| [DVec3::ONE, DVec3::new(1.0, 2.0, 4.0)].map(|d| (at, d))) {
        if at == DVec3::ZERO {
            continue;
        }
        let field = Field::new(1, 1, &[at - 2.0 * d], &[d]).unwrap();
        let camera = Camera::of("raymap", (1, 1), FORWARD, Rays::Field(field));
        let Some(frame) = frame(&cube, &camera, Without::Nothing, false) else { return };
        assert!(ids(&frame)[0] != NO_ID, "{d} at {at}");
        assert_eq!(differing(&frame, &truth(&cube, &camera)), [0; 0], "{d} at {at}");
    }
}

/// Certified pixels are right, and a pixel whose ray goes through a corner is never certified, since nothing proves its side.
#[test]
fn certified_pixels_are_the_references() {
    for (name, camera, depth) in cameras() {
        let grid_scene = scene(grid(&camera, 2, 0.7, depth, &mut Rng(7)));
        let Some(frame) = frame(&grid_scene, &camera, Without::Nothing, true) else { return };
        let proven = frame.u32(Channel::Certified).unwrap();
        let truth = image(&grid_scene, &camera, &[Channel::TriangleId]);
        let share = proven.iter().filter(|p| **p > 0).count() as f64 / proven.len() as f64;
        println!("{name}: {share:.3} certified");
        for (k, proven) in proven.iter().enumerate() {
            let (i, j) = (k as u32 % SIZE.0, k as u32 / SIZE.0);
            assert!(*proven == 0 || ids(&frame)[k] == ids(&truth)[k], "{name}: {i},{j} is certified");
            let corner = j / 2 * SIZE.0.div_ceil(2) + i / 2;
            let sees_corner = |id: u32| id != NO_ID && grid_scene.mesh.triangles[id as usize].contains(&corner);
            let is_corner = i % 2 == 0 && j % 2 == 0 && sees_corner(ids(&truth)[k]);
            assert!(*proven == 0 || !is_corner, "{name}: {i},{j} goes through a corner and is certified");
        }
    }
}

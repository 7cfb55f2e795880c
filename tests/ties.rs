//! Rays that lie on edges and go through vertices: the engine sees the reference's triangle there too. Nothing to do without an adapter.
//!
//! Meshes are made of a camera's own rays: corners on the rays of pixels, edges through those of the pixels between. Nothing is chosen to
//! be exact in f64, so that most rays miss what they should meet by a rounding, as in any scene made to measure.

mod common;

use anamorph::camera::Camera;
use anamorph::engine::RunOptions;
use anamorph::frame::{Channel, Frame, NO_ID};
use anamorph::plan::Wanted;
use anamorph::reference::image::image;
use anamorph::scene::Scene;
use anamorph::scene::mesh::Mesh;
use common::cameras::{MeshLook, glc_of_each_class, mesh_camera, raymap};
use common::file::{camera_of, scene_of};
use common::gpu::{Without, engine, ids};
use common::rng::Rng;
use common::{FORWARD, camera, mesh, scene};
use glam::DVec3;

/// Not a multiple of anything, so that pixel centres are no simple fractions.
const SIZE: (u32, u32) = (97, 61);

/// The frame with all ids, and what is certified where that is asked for.
fn frame(scene: &Scene, camera: &Camera, without: Without, certified: bool) -> Option<Frame> {
    let channels = [Channel::TriangleId].into_iter().chain(certified.then_some(Channel::Certified)).collect();
    Some(engine(camera, without)?.render(scene, camera, &Wanted::of(channels), &RunOptions::default()).unwrap().frame)
}

/// Pixels where the frame has another triangle than the reference.
fn differing(scene: &Scene, camera: &Camera, frame: &Frame) -> Vec<usize> {
    let truth = image(scene, camera, &[Channel::TriangleId]);
    (0..ids(frame).len()).filter(|&k| ids(frame)[k] != ids(&truth)[k]).collect()
}

/// How the corners of a grid lie along their rays.
#[derive(Debug, Clone, Copy)]
enum Depth {
    /// At one t: edges are straight through the rays between, whatever the camera.
    Even,
    /// At any t near one: through a pinhole, or along parallel rays, edges still meet those between.
    Uneven,
}

/// A sheet of triangles over all pixels that have a ray, a corner on every `step`th pixel's; cut along either diagonal, wound either way.
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
        let cut = [[[k, k + 1, below], [below + 1, k + 1, below]], [[k, k + 1, below + 1], [k, below + 1, below]]];
        for [a, b, c] in cut[rng.below(2)] {
            if [a, b, c].iter().all(|&v| has_ray[v as usize]) {
                triangles.push([[a, b, c], [b, c, a], [c, b, a]][rng.below(3)]);
            }
        }
    }
    mesh(positions, triangles)
}

/// Cameras of pieces and of one ray a pixel; those whose rays are parallel or meet in one point first.
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
    let weighted = MeshLook { weights: true, ..MeshLook::default() };
    list.push(("mesh".into(), camera(mesh_camera(1, 3, 2, MeshLook::default()), SIZE, FORWARD), Depth::Even));
    list.push(("weighted mesh".into(), camera(mesh_camera(2, 3, 2, weighted), SIZE, FORWARD), Depth::Even));
    list.push(("ray map".into(), raymap(SIZE.0, SIZE.1, FORWARD), Depth::Even));
    list
}

/// Pixels that may differ: where the image of a mesh has a kink between pixels, as at the rim of a fisheye and between weighted pieces, an edge
/// may happen to run along the step by which sides are decided; of the others none does.
fn most_differing(name: &str) -> usize {
    usize::from(["fisheye", "weighted mesh"].contains(&name))
}

#[test]
fn rays_on_edges_and_through_corners_see_the_reference_s_triangle() {
    for (name, camera, depth) in cameras() {
        let most = most_differing(&name);
        for (seed, step) in (1..).zip([1, 2, 3, 5]) {
            let sheet = scene(grid(&camera, step, 0.7, depth, &mut Rng(seed)));
            for without in [Without::Nothing, Without::Int64Atomics] {
                let Some(frame) = frame(&sheet, &camera, without, false) else { return };
                let differ = differing(&sheet, &camera, &frame);
                let hits = ids(&frame).iter().filter(|id| **id != NO_ID).count();
                let what = format!("{name}, a corner every {step} px, without {without:?}");
                assert!(3 * hits > ids(&frame).len(), "{what}: {hits} hits");
                assert!(differ.len() <= most, "{what}: {} pixels differ, the first is {}", differ.len(), differ[0]);
            }
        }
    }
}

/// f64 in words takes a software adapter long to compile: two cameras.
#[test]
fn f64_in_words_decides_alike() {
    let all = cameras();
    for name in ["pinhole", "ray map"] {
        let (_, camera, depth) = all.iter().find(|c| c.0 == name).unwrap();
        let sheet = scene(grid(camera, 2, 0.7, *depth, &mut Rng(3)));
        let Some(frame) = frame(&sheet, camera, Without::F64, false) else { return };
        assert_eq!(differing(&sheet, camera, &frame), [0; 0], "{name}");
    }
}

/// A city, whose walls stand on its ground along rows of pixels that a pushbroom's rays meet but for a rounding.
#[test]
fn a_city_s_walls_meet_the_ground_on_rows_of_pixels() {
    let city = "[[mesh]]\nbuiltin = \"city\"\nseed = 7\ntriangles = 15000";
    let pushbroom = "kind = \"glc\"\nnear = [[-30.5, 26.6, 40], [30.5, 26.6, 40], [-30.5, 10.6, 40]]\n\
        far = [[-30.5, 21, -40], [30.5, 21, -40], [-30.5, -59, -40]]";
    let scene = scene_of(city, (160, 120), pushbroom).unwrap();
    let camera = scene.camera().unwrap();
    let Some(frame) = frame(&scene, &camera, Without::Nothing, false) else { return };
    assert_eq!(differing(&scene, &camera, &frame), [0; 0]);
}

/// Where two answers remain possible, none is certified: nothing proves on which side such a ray passes.
#[test]
fn what_is_certified_is_the_reference_s() {
    for (name, camera, depth) in cameras() {
        let sheet = scene(grid(&camera, 2, 0.7, depth, &mut Rng(7)));
        let Some(frame) = frame(&sheet, &camera, Without::Nothing, true) else { return };
        let proven = frame.u32(Channel::Certified).unwrap();
        let truth = image(&sheet, &camera, &[Channel::TriangleId]);
        let share = proven.iter().filter(|p| **p > 0).count() as f64 / proven.len() as f64;
        println!("{name}: {share:.3} certified");
        for (k, proven) in proven.iter().enumerate() {
            let (i, j) = (k as u32 % SIZE.0, k as u32 / SIZE.0);
            assert!(*proven == 0 || ids(&frame)[k] == ids(&truth)[k], "{name}: {i},{j} is certified");
            let corner = j / 2 * SIZE.0.div_ceil(2) + i / 2;
            let sees_corner = |id: u32| id != NO_ID && sheet.mesh.triangles[id as usize].contains(&corner);
            let is_corner = i % 2 == 0 && j % 2 == 0 && sees_corner(ids(&truth)[k]);
            assert!(*proven == 0 || !is_corner, "{name}: {i},{j} goes through a corner and is certified");
        }
    }
}

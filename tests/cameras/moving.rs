//! Things that move while a frame is taken, through cameras of all kinds, against the f64 reference.

use super::project_named::{BOX, all_keys, keys_with_pose, plain_keys};
use crate::common;

use anamorph::internals::camera::Camera;
use anamorph::internals::camera::exposure::{Exposure, LineOrder, Lines, Readout, Sample};
use anamorph::internals::camera::kinds::KINDS;
use anamorph::internals::camera::moving::Moving;
use anamorph::internals::geometry::generate;
use anamorph::internals::geometry::mesh::Mesh;
use anamorph::internals::geometry::place;
use anamorph::internals::geometry::time_steps::{TimeStep, TimeSteps};
use anamorph::internals::image::frame::{Channel, Frame, NO_ID};
use anamorph::internals::image::write_npy_f64;
use anamorph::internals::scene::Scene;
use common::file::{camera_of, refusal, scene_of};
use common::gpu::{check, hits, ids, render};
use common::rng::Rng;
use common::scene;
use glam::{DMat3, DVec3};

const SIZE: (u32, u32) = (60, 44);

/// A ball and triangles about it that swirl and shrink, each in its own way, in three steps of unequal length.
fn swirling() -> (Mesh, TimeSteps) {
    let mut ball = generate::icosphere(2);
    ball.positions.iter_mut().for_each(|p| *p *= 0.6);
    let mesh = place::merge(vec![ball, common::soup(&mut Rng(7), 160, 0.3)]).unwrap();
    let times = [-0.5, 0.1, 0.3, 1.0];
    let step = |time: f64| {
        let turned = |p: &DVec3| DMat3::from_rotation_y(time * (1.0 + p.y)) * *p * (1.0 - 0.3 * time * p.x);
        let normals = mesh.normals.iter().map(|n| DMat3::from_rotation_y(time) * n.as_dvec3()).map(|n| n.as_vec3());
        TimeStep { positions: mesh.positions.iter().map(turned).collect(), normals: normals.collect() }
    };
    let steps = TimeSteps::new(times.to_vec(), times.map(step).into()).unwrap();
    (mesh, steps)
}

/// Exposed line by line in each order, or with the shutter open.
fn exposures() -> [(Exposure, Option<Sample>); 5] {
    let lines = |order: LineOrder, count| {
        let lines = Lines { first: -0.4, line_time: 1.3 / f64::from(count), order, count };
        (Exposure { readout: Readout::Lines(lines), shutter: 0.0, is_even: false }, None)
    };
    let open = Exposure { readout: Readout::AtOnce, shutter: 1.5, is_even: false };
    [
        lines(LineOrder::Down, SIZE.1),
        lines(LineOrder::Up, SIZE.1),
        lines(LineOrder::Right, SIZE.0),
        lines(LineOrder::Left, 2 * SIZE.0),
        (open, Some(Sample { number: 2, count: 5 })),
    ]
}

fn swirling_scene(exposure: Exposure) -> Scene {
    let (mesh, steps) = swirling();
    Scene { exposure, steps: Some(steps.into()), ..scene(mesh) }
}

/// Mirrors and lenses before, below and around what moves, of every law and kind of surface.
const OPTICS: [&str; 6] = [
    "kind = 'reflection'\nEYE\nmirror = { shape = 'sphere', center = [0, -5, 0], radius = 4 }\ndepth = 2",
    "kind = 'reflection'\nEYE\nmirror = { shape = 'torus', center = [0, -0.6, 0.2], axis = [0, 1, 0], radius = 1.3, tube = 0.3 }\n\
     facets = 'normals'\ndepth = 2",
    "kind = 'reflection'\nWIDE\nmirror = { shape = 'sphere', center = [0, -5, 0], radius = 4 }\nfacets = 'flat'",
    "kind = 'refraction'\nEYE\nlens = { shape = 'lens', center = [0, 0, 2], axis = [0, 0, -1], radius = 0.9, thickness = 0.6, \
     curvatures = [0.5, -0.6] }\nior = 1.45\ndepth = 2",
    "kind = 'refraction'\nWIDE\nlens = { shape = 'sphere', center = [0, 0, 2], radius = 0.7 }\nior = 1.2\nfacets = 'normals'\n\
     depth = 3",
    "kind = 'refraction'\nEYE\nlens = { shape = 'sphere', center = [0, 0, 2], radius = 0.7 }\nior = 1.2\nfacets = 'flat'",
];

fn optics() -> [String; 6] {
    let pinhole = "eye = { kind = 'pinhole', eye = [0.2, 1.2, 4], target = [0, -0.5, 0], vfov = 45 }";
    let fisheye = "eye = { kind = 'fisheye', eye = [0.2, 1.2, 3.4], target = [0, -0.4, 0], fov = 110, frame = 'full' }";
    OPTICS.map(|keys| keys.replace("EYE", pinhole).replace("WIDE", fisheye))
}

/// Half of the cameras, so that the halves are tested side by side.
fn share(first: usize) {
    let folder = tempfile::tempdir().unwrap();
    let all = [all_keys(folder.path()), plain_keys(folder.path())].concat();
    for (k, keys) in all.iter().enumerate().skip(first).step_by(2) {
        let (exposure, sample) = exposures().into_iter().nth(k % 5).unwrap();
        let mut camera = camera_of(BOX, SIZE, keys).unwrap_or_else(|e| panic!("{keys}: {e}"));
        camera.sample = sample;
        let Some((frame, ..)) = check(keys, &swirling_scene(exposure), &camera) else { return };
        assert!(hits(&frame) > 100, "{keys}: {} hits", hits(&frame));
    }
}

/// Half of the cameras that have a pose, flown past what moves while their rows are read.
fn flown(first: usize) {
    let folder = tempfile::tempdir().unwrap();
    let still = all_keys(folder.path());
    let poses = ["eye = [-0.4, 0.5, 3.8]\ntarget = [0.2, 0.1, 0]", "eye = [0.6, -0.1, 4.1]\ntarget = [-0.1, 0, 0.2]"];
    let [before, after] = poses.map(|pose| keys_with_pose(folder.path(), pose));
    let all = before.iter().zip(&after).zip(&still).filter(|((before, _), still)| before != still);
    for ((before, after), _) in all.skip(first).step_by(2) {
        let lines = Lines { first: -0.4, line_time: 1.3 / f64::from(SIZE.1), order: LineOrder::Down, count: SIZE.1 };
        let exposure = Exposure { readout: Readout::Lines(lines), shutter: 0.2, is_even: true };
        let cameras = [before, after].map(|keys| camera_of(BOX, SIZE, keys).unwrap_or_else(|e| panic!("{keys}: {e}")));
        let moving = Moving::new(exposure.clone(), vec![-0.5, 1.0], cameras.into()).unwrap();
        for sample in [None, Some(Sample { number: 3, count: 4 })] {
            let camera = moving.camera(sample).unwrap();
            let Some((frame, ..)) = check(before, &swirling_scene(exposure.clone()), &camera) else { return };
            assert!(hits(&frame) > 100, "{before}: {} hits", hits(&frame));
        }
    }
}

#[test]
fn every_other_camera_that_moves_sees_what_moves() {
    flown(0);
}

#[test]
fn the_moving_cameras_between_them_do_too() {
    flown(1);
}

/// The rolling shutter of `opencv`, which moves its camera by the row, and keyframes of `eye` say the same of a pinhole.
#[test]
fn keyframes_move_a_camera_as_its_velocity_does() {
    let folder = tempfile::tempdir().unwrap();
    // of a pinhole of 40 degrees: no distortion, its axis in the middle
    let focal = f64::from(SIZE.1) / 2.0 / 20f64.to_radians().tan();
    let centre = [f64::from(SIZE.0) / 2.0 - 0.5, f64::from(SIZE.1) / 2.0 - 0.5];
    let yaml = format!(
        "%YAML:1.0\n---\nimage_width: {}\nimage_height: {}\ncamera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   \
         data: [ {focal}, 0., {}, 0., {focal}, {}, 0., 0., 1. ]\ndistortion_coefficients: !!opencv-matrix\n   rows: 4\n   cols: 1\n   \
         dt: d\n   data: [ 0., 0., 0., 0. ]\n",
        SIZE.0, SIZE.1, centre[0], centre[1]
    );
    std::fs::write(folder.path().join("camera.yml"), yaml).unwrap();
    let pose = "eye = [0.2, 0.3, 4]\ntarget = [0.2, 0.3, 0]";
    let rolling = format!(
        "kind = 'opencv'\nfile = '{}/camera.yml'\n{pose}\nline_time = 0.02\nvelocity = [3, -1, 0.5]",
        folder.path().display()
    );
    let keyed = "kind = 'pinhole'\nvfov = 40\nline_time = 0.02\n\
        eye = [{ frame = -1, value = [-2.8, 1.3, 3.5] }, { frame = 1, value = [3.2, -0.7, 4.5] }]\n\
        target = [{ frame = -1, value = [-2.8, 1.3, -0.5] }, { frame = 1, value = [3.2, -0.7, 0.5] }]";
    let [a, b] = [&rolling, keyed].map(|keys| camera_of(BOX, SIZE, keys).unwrap());
    assert!(b.moving.is_some());
    for (i, j) in (0..SIZE.1).flat_map(|j| (0..SIZE.0).map(move |i| (i, j))) {
        let (a, b) = (a.ray(i, j).unwrap(), b.ray(i, j).unwrap());
        let apart = (a.origin - b.origin).length() + (a.direction - b.direction).length();
        assert!(apart < 1e-13, "{i},{j}: {apart:e}");
    }
}

#[test]
fn only_rays_change_while_a_frame_is_taken() {
    let pinhole = "kind = 'pinhole'\neye = [0, 0, 4]\ntarget = [0, 0, 0]\nvfov = 40";
    let keyed = |from: &str, to: &str| format!("[{{ frame = -1, value = {from} }}, {{ frame = 1, value = {to} }}]");
    let region = |to: &str, eye: &str| {
        let rectangle = format!("{{ kind = 'rectangle', from = [0, 0], to = {to} }}");
        format!(
            "kind = 'composite'\nline_time = 0.02\ncameras = [{{ camera = {{ {} }}, region = {rectangle} }},\n\
             {{ camera = {{ kind = 'pinhole', eye = {eye}, target = [0, 0, 0], vfov = 40 }} }}]",
            pinhole.replace('\n', ", ")
        )
    };
    let moves = keyed("[0, 0, 4]", "[1, 0, 4]");
    let fixed = region("[0.5, 1]", &moves);
    assert!(camera_of(BOX, SIZE, &fixed).unwrap().moving.is_some());
    let grows = region(&keyed("[0.5, 1]", "[0.7, 1]"), "[0, 0, 4]");
    let reaches = format!("{pinhole}\nline_time = 0.02\nt_range = {}", keyed("[0, 4]", "[0, 5]"));
    let sharpens = fixed.replace("region = {", &format!("feather = {}, region = {{", keyed("8", "0")));
    for keys in [grows, reaches, sharpens] {
        let error = refusal(BOX, SIZE, &keys);
        assert!(
            error.contains(
                "t_range and all keys of a composite but its cameras' own cannot change while a frame is taken"
            ),
            "{error}"
        );
    }
}

#[test]
#[ignore = "slow: make test-all"]
fn every_other_camera_sees_what_moves_at_the_time_of_each_pixel() {
    share(0);
}

#[test]
fn the_cameras_between_them_do_too() {
    share(1);
}

/// Whether each pixel shows another triangle than where the scene stands still.
fn sees_it_move(frame: &Frame, scene: Scene, camera: &Camera) -> Vec<bool> {
    let still = render(&Scene { steps: None, ..scene }, camera).unwrap();
    ids(frame).iter().zip(ids(&still)).map(|(a, b)| a != b).collect()
}

#[test]
fn mirrors_and_lenses_that_stand_still_show_what_moves() {
    for (k, keys) in optics().iter().enumerate() {
        for number in [k, k + 2] {
            let (exposure, sample) = exposures().into_iter().nth(number % 5).unwrap();
            let mut camera = camera_of(BOX, SIZE, keys).unwrap_or_else(|e| panic!("{keys}: {e}"));
            camera.sample = sample;
            let scene = swirling_scene(exposure);
            let Some((frame, ..)) = check(keys, &scene, &camera) else { return };
            let (mirrors, own) = (frame.u32(Channel::MirrorId).unwrap(), scene.mesh.triangles.len() as u32);
            let moves = sees_it_move(&frame, scene, &camera);
            let bounced = ids(&frame).iter().zip(mirrors).zip(moves);
            let bounced = bounced.filter(|((id, mirror), _)| **id < own && **mirror != NO_ID);
            let (moving, still): (Vec<_>, Vec<_>) = bounced.partition(|(_, moves)| *moves);
            println!("{keys}: {} pixels see it move after a bounce, {} do not", moving.len(), still.len());
            assert!(moving.len() > 20, "{keys}: {} pixels see it move after a bounce", moving.len());
        }
    }
}

/// A scanner has a time for each column, and a list of rays for each ray.
#[test]
fn scanners_see_what_moves_at_the_time_of_each_shot() {
    let folder = tempfile::tempdir().unwrap();
    let plain = plain_keys(folder.path());
    let count = (SIZE.0 * SIZE.1) as usize;
    let mut rng = Rng(3);
    let times: Vec<f64> = (0..count).map(|_| 1.4 * rng.unit() - 0.4).collect();
    write_npy_f64(&folder.path().join("times.npy"), &[SIZE.1.into(), SIZE.0.into()], &times).unwrap();
    write_npy_f64(&folder.path().join("list.npy"), &[count as u64], &times).unwrap();
    let beams: Vec<f64> = (0..SIZE.1).map(|j| 16.0 - 0.75 * f64::from(j)).collect();
    let spinning = format!(
        "kind = 'lidar'\neye = [0.2, 0.3, 4]\ntarget = [0, 0, 0]\nbeams = {beams:?}\ncolumns = {}\nstart = -20\nsweep = 40\n\
         period = 0.9\nvelocity = [0.3, -0.1, -0.5]",
        SIZE.0
    );
    let of_times = |name: &str, file: &str| {
        let keys = plain.iter().find(|keys| keys.starts_with(&format!("kind = '{name}'"))).unwrap();
        format!("{keys}\ntimes = '{}/{file}.npy'", folder.path().display())
    };
    let of_list = |i: u32, j: u32| times[(j * SIZE.0 + i) as usize];
    let by_column = |i: u32, _: u32| 0.9 * (f64::from(i) + 0.5) / f64::from(SIZE.0);
    for (keys, time) in [
        (spinning, &by_column as &dyn Fn(u32, u32) -> f64),
        (of_times("lidar", "list"), &of_list),
        (of_times("raymap", "times"), &of_list),
    ] {
        let Scene { exposure, .. } = scene_of(BOX, SIZE, &keys).unwrap_or_else(|e| panic!("{keys}: {e}"));
        for (i, j) in (0..SIZE.1).flat_map(|j| (0..SIZE.0).map(move |i| (i, j))) {
            let off = (exposure.time((i, j), SIZE, None) - time(i, j)).abs();
            // a product and a sum of numbers up to 1
            assert!(off <= 2.0 * f64::EPSILON, "{keys}: {i},{j}");
        }
        let camera = camera_of(BOX, SIZE, &keys).unwrap();
        let scene = swirling_scene(exposure);
        let Some((frame, ..)) = check(&keys, &scene, &camera) else { return };
        let moving = sees_it_move(&frame, scene, &camera).into_iter().filter(|moves| *moves).count();
        assert!(moving > 100, "{keys}: {moving} pixels see it move");
    }
}

#[test]
fn no_kind_is_left_out() {
    let folder = tempfile::tempdir().unwrap();
    let all = [all_keys(folder.path()), plain_keys(folder.path()), optics().to_vec()].concat();
    let is_tested = |kind: &str| all.iter().any(|keys| keys.starts_with(&format!("kind = '{kind}'\n")));
    let missing: Vec<&str> = KINDS.iter().map(|kind| kind.name).filter(|kind| !is_tested(kind)).collect();
    assert!(missing.is_empty(), "{missing:?} see nothing that moves");
}

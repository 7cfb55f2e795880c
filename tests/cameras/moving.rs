//! Things that move while a frame is taken, through cameras of all kinds, against the f64 reference.

use super::project_named::{BOX, all_keys, keys_with_pose};
use crate::common;

use anamorph::internals::camera::exposure::{Exposure, LineOrder, Lines, Readout, Sample};
use anamorph::internals::camera::moving::Moving;
use anamorph::internals::geometry::generate;
use anamorph::internals::geometry::mesh::Mesh;
use anamorph::internals::geometry::place;
use anamorph::internals::geometry::time_steps::{TimeStep, TimeSteps};
use anamorph::internals::scene::Scene;
use common::file::{camera_of, refusal};
use common::gpu::{check, hits};
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

/// Half of the cameras, so that the halves are tested side by side.
fn share(first: usize) {
    let folder = tempfile::tempdir().unwrap();
    for (k, keys) in all_keys(folder.path()).iter().enumerate().skip(first).step_by(2) {
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
    for keys in [grows, reaches] {
        let error = refusal(BOX, SIZE, &keys);
        assert!(
            error.contains("t_range and the regions of a composite cannot change while a frame is taken"),
            "{error}"
        );
    }
}

#[test]
fn every_other_camera_sees_what_moves_at_the_time_of_each_pixel() {
    share(0);
}

#[test]
fn the_cameras_between_them_do_too() {
    share(1);
}

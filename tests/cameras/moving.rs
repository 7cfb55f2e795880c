//! Things that move while a frame is taken, through cameras of all kinds, against the f64 reference.

use super::project_named::{BOX, all_keys};
use crate::common;

use anamorph::internals::camera::exposure::{Exposure, LineOrder, Lines, Readout, Sample};
use anamorph::internals::geometry::generate;
use anamorph::internals::geometry::mesh::Mesh;
use anamorph::internals::geometry::place;
use anamorph::internals::geometry::time_steps::{TimeStep, TimeSteps};
use anamorph::internals::scene::Scene;
use common::file::camera_of;
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
        (Exposure { readout: Readout::Lines(lines), shutter: 0.0 }, None)
    };
    let open = Exposure { readout: Readout::AtOnce, shutter: 1.5 };
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

#[test]
fn every_other_camera_sees_what_moves_at_the_time_of_each_pixel() {
    share(0);
}

#[test]
fn the_cameras_between_them_do_too() {
    share(1);
}

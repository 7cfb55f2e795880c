//! Matrices of cameras in the header of an EXR file.

use super::Scene;
use crate::arrays::MapEach;
use crate::camera::Camera;
use crate::camera::kinds::orthographic::Orthographic;
use crate::camera::kinds::pinhole::Pinhole;
use crate::camera::view::view;
use glam::{DVec3, DVec4};

/// OpenEXR's `worldToCamera`, for cameras with an eye: a matrix for row vectors, row by row; x right, y up, z forward.
pub fn world_to_camera(scene: &Scene) -> Option<[f32; 16]> {
    let pose = scene.camera_keys.pose()?;
    let v = pose.view().ok()?;
    Some(matrix(pose.eye, [v.right, v.up, v.forward, DVec3::ZERO], DVec4::W))
}

/// OpenEXR's `worldToNDC`, for pinhole and orthographic cameras: (0, 0) is the image's upper left corner, (1, 1) its lower right one. The
/// transformed z has no meaning.
pub fn world_to_ndc(scene: &Scene, camera: &Camera) -> Option<[f32; 16]> {
    let aspect = f64::from(camera.width) / f64::from(camera.height);
    let kind = &scene.camera.kind;
    if let Some(&Pinhole { eye, target, up, vfov }) = kind.recipe() {
        let v = view(eye, target, up).ok()?;
        // of the image, on the plane at distance 1
        let height = 2.0 * (vfov.to_radians() / 2.0).tan();
        let middle = v.forward / 2.0;
        let across = v.right / (height * aspect) + middle;
        return Some(matrix(eye, [across, middle - v.up / height, DVec3::ZERO, v.forward], DVec4::Z));
    }
    let &Orthographic { eye, target, up, height } = kind.recipe()?;
    let v = view(eye, target, up).ok()?;
    let columns = [v.right / (height * aspect), -v.up / height, v.forward, DVec3::ZERO];
    Some(matrix(eye, columns, DVec4::new(0.5, 0.5, 0.0, 1.0)))
}

/// The matrix of `(X - eye) . column + shift`, one column a coordinate.
fn matrix(eye: DVec3, columns: [DVec3; 4], shift: DVec4) -> [f32; 16] {
    let row = |k: usize| columns.map_each(|c| c[k]);
    let last = [0, 1, 2, 3].map_each(|k| shift[k] - eye.dot(columns[k]));
    let mut all = [0.0; 16];
    for (value, number) in all.iter_mut().zip([row(0), row(1), row(2), last].concat()) {
        *value = number as f32;
    }
    all
}

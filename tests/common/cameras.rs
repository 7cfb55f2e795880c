//! Cameras that see the ball of radius 1 about the origin.

use super::rng::Rng;
use anamorph::internals::camera::kinds::glc::Glc;
use anamorph::internals::camera::kinds::pinhole::Pinhole;
use anamorph::internals::camera::mesh::spec::{CameraVertex, MeshCameraSpec};
use anamorph::internals::camera::spec::CameraKind;
use anamorph::internals::camera::{Camera, Field, Rays};
use glam::{DMat2, DVec2, DVec3};

/// Bounded and far points of a GLC with the maps `a` and `b` from the image, [-1/2, 1/2]^2 with y up, to the planes
/// z = 2 and z = -2.
pub fn two_plane(a: DMat2, b: DMat2) -> ([DVec3; 3], [DVec3; 3]) {
    let corners = [DVec2::new(-0.5, 0.5), DVec2::new(0.5, 0.5), DVec2::new(-0.5, -0.5)];
    let on = |m: DMat2, z: f64| corners.map(|c| (m * c).extend(z));
    (on(a, 2.0), on(b, -2.0))
}

/// A GLC of every class, by name.
pub fn glc_of_each_class() -> Vec<(&'static str, CameraKind)> {
    corners_of_each_class()
        .into_iter()
        .map(|(name, near, far)| (name, CameraKind::new("glc", Glc { near, far })))
        .collect()
}

/// The same by its corners.
pub fn corners_of_each_class() -> Vec<(&'static str, [DVec3; 3], [DVec3; 3])> {
    let m = |a: f64, b: f64, c: f64, d: f64| DMat2::from_cols(DVec2::new(a, b), DVec2::new(c, d));
    let turned = DMat2::from_angle(0.7) * 2.5;
    let mut list: Vec<(&str, [DVec3; 3], [DVec3; 3])> = [
        ("pinhole", m(1.5, 0.0, 0.0, 1.5), m(4.5, 0.0, 0.0, 4.5)),
        ("orthographic", m(2.5, 0.0, 0.0, 2.5), m(2.5, 0.0, 0.0, 2.5)),
        ("pushbroom", m(2.5, 0.0, 0.0, 2.0), m(2.5, 0.0, 0.0, 3.5)),
        ("cross-slit", m(2.0, 0.0, 0.0, 1.5), m(3.5, 0.0, 0.0, 4.0)),
        ("pencil", m(1.5, 0.0, 0.0, 1.5), m(3.0, 1.5, 0.0, 3.0)),
        ("twisted orthographic", m(2.5, 0.0, 0.0, 2.5), m(2.5, 1.5, 0.0, 2.5)),
        ("bilinear", m(2.5, 0.0, 0.0, 2.5), turned),
    ]
    .into_iter()
    .map(|(name, a, b)| {
        let (near, far) = two_plane(a, b);
        (name, near, far)
    })
    .collect();
    let (near, mut far) = two_plane(m(2.0, 0.1, -0.2, 2.2), m(3.5, 0.3, 0.0, 3.2));
    far[1].z -= 0.7;
    far[2].z += 0.4;
    list.push(("cglc", near, far));
    list
}

/// A pinhole at `eye` that looks at `target`.
pub fn pinhole(eye: DVec3, target: DVec3, vfov: f64) -> CameraKind {
    let up = if (target - eye).normalize().y.abs() > 0.9 { DVec3::Z } else { DVec3::Y };
    CameraKind::new("pinhole", Pinhole { eye, target, up, vfov })
}

/// How the pieces of [`mesh_camera`] differ from a plain, continuous one.
#[derive(Debug, Clone, Copy, Default)]
pub struct MeshShape {
    pub normalize: bool,
    /// Weights from 1/2 to 2 instead of 1.
    pub weights: bool,
    /// Every cell has rays of its own: neighbours do not continue each other.
    pub discontinuous: bool,
}

/// Two pieces for each of `columns` x `rows` cells of the image, over rays that bend smoothly, each corner a little
/// off by `seed`.
pub fn mesh_spec(seed: u64, columns: u32, rows: u32, shape: MeshShape) -> MeshCameraSpec {
    let mut rng = Rng(seed);
    let mut vertex = |i: u32, j: u32| {
        let image = DVec2::new(i as f64 / columns as f64, j as f64 / rows as f64);
        let q = DVec2::new(image.x - 0.5, 0.5 - image.y);
        let bend = 0.2 * DVec2::new((5.0 * q.y).sin(), (4.0 * q.x).cos());
        let off = |rng: &mut Rng| 0.02 * rng.vector();
        let shift = if shape.discontinuous { 0.3 * rng.vector() } else { DVec3::ZERO };
        CameraVertex {
            image: image.to_array(),
            near: (2.2 * q).extend(2.0) + off(&mut rng) + shift,
            far: (3.2 * q + bend).extend(-2.0) + off(&mut rng) - shift,
            w: if shape.weights { (2.0 * rng.unit() - 1.0).exp2() } else { 1.0 },
        }
    };
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    if shape.discontinuous {
        for (i, j) in (0..rows).flat_map(|j| (0..columns).map(move |i| (i, j))) {
            let k = vertices.len() as u32;
            vertices.extend([vertex(i, j), vertex(i + 1, j), vertex(i, j + 1), vertex(i + 1, j + 1)]);
            triangles.extend([[k, k + 1, k + 2], [k + 3, k + 1, k + 2]]);
        }
    } else {
        vertices.extend((0..=rows).flat_map(|j| (0..=columns).map(move |i| (i, j))).map(|(i, j)| vertex(i, j)));
        for (i, j) in (0..rows).flat_map(|j| (0..columns).map(move |i| (i, j))) {
            let k = j * (columns + 1) + i;
            let below = k + columns + 1;
            triangles.extend([[k, k + 1, below], [below + 1, k + 1, below]]);
        }
    }
    MeshCameraSpec { vertices, triangles, normalize: shape.normalize }
}

/// The camera of [`mesh_spec`].
pub fn mesh_camera(seed: u64, columns: u32, rows: u32, shape: MeshShape) -> CameraKind {
    CameraKind::new("mesh", mesh_spec(seed, columns, rows, shape))
}

/// A ray map of `width` x `height` over a wavy lens; every 17th pixel has no ray.
pub fn raymap(width: u32, height: u32, t_range: [f64; 2]) -> Camera {
    let (mut origins, mut directions) = (Vec::new(), Vec::new());
    for (i, j) in (0..height).flat_map(|j| (0..width).map(move |i| (i, j))) {
        let q = DVec2::new((i as f64 + 0.5) / width as f64 - 0.5, 0.5 - (j as f64 + 0.5) / height as f64);
        let origin = (2.2 * q).extend(2.0);
        let bend = 0.1 * DVec2::new((9.0 * q.y).sin(), (7.0 * q.x).cos());
        let blind = (i + 3 * j) % 17 == 0;
        origins.push(origin);
        directions.push(if blind { DVec3::splat(f64::NAN) } else { (0.8 * q + bend).extend(-4.0) });
    }
    let field = Field::new(width, height, &origins, &directions).unwrap();
    Camera::of("raymap", (width, height), t_range, Rays::Field(field))
}

//! Chains and curved cameras that see the ball of radius 1 about the origin.

use super::cameras::{MeshShape, mesh_spec};
use super::rng::Rng;
use anamorph::internals::camera::mesh::spec::{CameraVertex, MeshCameraSpec};
use anamorph::internals::camera::{Camera, Curve, CurveMap, Curves, Ray, Rays, mesh};
use anamorph::internals::input::Limits;
use glam::{DVec2, DVec3};
use std::sync::Arc;

/// A chain of `layers` layers over `columns` x `rows` cells: its rays bend at every face, by `seed`, and go on there.
pub fn chain(seed: u64, layers: usize, (columns, rows): (u32, u32), shape: MeshShape, size: (u32, u32)) -> Camera {
    let first = mesh_spec(seed, columns, rows, shape);
    let mut rng = Rng(seed + 77);
    // faces between the first vertex of each ray and its last, each moved about
    let faces: Vec<Vec<DVec3>> = (0..=layers)
        .map(|k| {
            let at = k as f64 / layers as f64;
            let off = if k == 0 || k == layers { 0.0 } else { 0.3 };
            first.vertices.iter().map(|v| v.near.lerp(v.far, at) + off * rng.vector()).collect()
        })
        .collect();
    let layer = |k: usize| {
        let vertex = |(i, v): (usize, &CameraVertex)| CameraVertex { near: faces[k][i], far: faces[k + 1][i], ..*v };
        let vertices = first.vertices.iter().enumerate().map(vertex).collect();
        MeshCameraSpec { vertices, triangles: first.triangles.clone(), normalize: false }
    };
    of_layers((0..layers).map(layer).collect(), size)
}

/// A chain of mesh cameras.
pub fn of_layers(layers: Vec<MeshCameraSpec>, (width, height): (u32, u32)) -> Camera {
    let compiled =
        |spec: &MeshCameraSpec| mesh::compile(spec, (width, height), &mut Vec::new(), Limits::default()).unwrap();
    let layers = layers.iter().map(|spec| Rays::Pieces(compiled(spec))).collect::<Vec<_>>();
    Camera {
        kind: "chain",
        width,
        height,
        t_range: [0.0, 1.0],
        layers,
        optics: None,
        notes: Default::default(),
        unfulfilled: Vec::new(),
        scene_use: Default::default(),
        sample: None,
        pixel_order: None,
        moving: None,
        composition: None,
    }
}

/// Curves from z = 2 to z = -2 that swing sideways by `bend`, differently all over the image.
#[derive(Debug, Clone, Copy)]
pub struct Wavy {
    pub degree: usize,
    pub bend: f64,
    /// Some places have no curve.
    pub holes: bool,
}

impl CurveMap for Wavy {
    fn degree(&self) -> usize {
        self.degree
    }

    fn curve(&self, a: f64, b: f64) -> Option<(u32, Curve)> {
        let q = DVec2::new(a - 0.5, 0.5 - b);
        if self.holes && (13.0 * a).fract() < 0.1 {
            return None;
        }
        let side = |k: usize| {
            let swing = DVec2::new((4.0 * q.y + k as f64).sin(), (5.0 * q.x - k as f64).cos());
            if k == 0 || k == self.degree { DVec2::ZERO } else { self.bend * swing * if k == 1 { 1.0 } else { -1.0 } }
        };
        let point = |k: usize| {
            let at = k as f64 / self.degree as f64;
            ((2.2 + 0.8 * at) * q + side(k)).extend(2.0 - 4.0 * at)
        };
        Some((0, Curve::new(&(0..=self.degree).map(point).collect::<Vec<_>>())))
    }
}

pub fn wavy(degree: usize, bend: f64, holes: bool, size: (u32, u32)) -> Camera {
    let map = Arc::new(Wavy { degree, bend, holes });
    Camera::of("projector", size, [0.0, 1.0], Rays::Curves(Curves::new(size.0, size.1, map)))
}

/// A straight layer down to z = 0, then a curve on to z = -2 that starts in its direction.
pub fn straight_then_curved(size: (u32, u32)) -> Camera {
    #[derive(Debug)]
    struct After;
    impl CurveMap for After {
        fn degree(&self) -> usize {
            2
        }
        fn curve(&self, a: f64, b: f64) -> Option<(u32, Curve)> {
            let q = DVec2::new(a - 0.5, 0.5 - b);
            let ray = Ray { origin: (2.5 * q).extend(2.0), direction: (0.5 * q).extend(-2.0) };
            let start = ray.origin + ray.direction;
            let offset = DVec3::new(0.8 * q.y, -0.8 * q.x, 0.0);
            Some((0, Curve::new(&[start, start + 0.5 * ray.direction, start + ray.direction + offset])))
        }
    }
    let vertex = |(a, b): (f64, f64)| {
        let q = DVec2::new(a - 0.5, 0.5 - b);
        CameraVertex { image: [a, b], near: (2.5 * q).extend(2.0), far: (3.0 * q).extend(0.0), w: 1.0 }
    };
    let vertices = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)].map(vertex).to_vec();
    let triangles = vec![[0, 1, 2], [2, 1, 3]];
    let mut camera = of_layers(vec![MeshCameraSpec { vertices, triangles, normalize: false }], size);
    camera.layers.push(Rays::Curves(Curves::new(size.0, size.1, Arc::new(After))));
    camera
}

/// The rays of a camera of one layer as curves of a higher degree.
#[derive(Debug, Clone)]
pub struct Elevated {
    pub of: Camera,
    pub degree: usize,
}

impl CurveMap for Elevated {
    fn degree(&self) -> usize {
        self.degree
    }

    fn curve(&self, a: f64, b: f64) -> Option<(u32, Curve)> {
        let pixel = |x: f64, n: u32| (x * f64::from(n)) as u32;
        let (k, curve) = self.of.curve(0, pixel(a, self.of.width), pixel(b, self.of.height))?;
        Some((k, curve.elevated(self.degree)))
    }
}

//! What several tests need: scenes, cameras, random numbers, and the engine where there is an adapter.

// every test binary uses a part of it
#![allow(dead_code)]

pub mod any;
pub mod cameras;
pub mod combined;
pub mod continuity;
pub mod file;
pub mod gpu;
pub mod layered;
pub mod needs;
pub mod polygon;
pub mod projection;
pub mod rng;
pub mod volumes;
pub mod written;

use anamorph::internals::camera::Camera;
use anamorph::internals::camera::kinds::pinhole::Pinhole;
use anamorph::internals::camera::spec::{CameraKind, CameraSpec};
use anamorph::internals::geometry::mesh::{Material, Mesh};
use anamorph::internals::scene::Scene;
use anamorph::internals::scene::file::OutputSpec;
use glam::DVec3;

pub const FORWARD: [f64; 2] = [0.0, f64::INFINITY];
pub const ALL_T: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];

/// A scene of one mesh under a headlight. Its own camera is never used.
pub fn scene(mesh: Mesh) -> Scene {
    let kind = CameraKind::new("pinhole", Pinhole { eye: DVec3::Z, target: DVec3::ZERO, up: DVec3::Y, vfov: 40.0 });
    Scene {
        objects: vec![anamorph::internals::geometry::load::Object {
            name: "mesh".into(),
            triangles: mesh.triangles.len(),
        }],
        mesh: mesh.into(),
        lights: Vec::new(),
        projector_lights: Vec::new(),
        ambient_occlusion: None,
        style: Default::default(),
        sky: None,
        volume: None,
        background: [0.1, 0.2, 0.3],
        tone: Default::default(),
        depth_range: Some([0.5, 20.0]),
        size: Some((64, 64)),
        camera: CameraSpec { kind, t_range: FORWARD },
        camera_keys: Default::default(),
        caustics: None,
        exposure: Default::default(),
        steps: None,
        casters: None,
        camera_steps: Vec::new(),
        output: OutputSpec::default(),
        limits: Default::default(),
    }
}

/// The camera of `kind` for an image of `width` x `height`.
pub fn camera(kind: CameraKind, (width, height): (u32, u32), t_range: [f64; 2]) -> Camera {
    Camera::new(&CameraSpec { kind, t_range }, Some((width, height))).unwrap()
}

/// A mesh of one two-sided material.
pub fn mesh(positions: Vec<DVec3>, triangles: Vec<[u32; 3]>) -> Mesh {
    let material_of = vec![0; triangles.len()];
    Mesh { positions, triangles, materials: vec![Material::default()], material_of, ..Mesh::default() }
}

/// The mesh with every vertex moved.
pub fn moved(mut mesh: Mesh, by: DVec3) -> Mesh {
    mesh.positions.iter_mut().for_each(|p| *p += by);
    mesh
}

/// The mesh whose triangle k is triangle `order[k]` of `mesh`; normals and materials go along.
pub fn picked(mesh: &Mesh, order: &[usize]) -> Mesh {
    let corner_normals = if mesh.corner_normals.is_empty() {
        Vec::new()
    } else {
        order.iter().map(|&k| mesh.corner_normals[k]).collect()
    };
    Mesh {
        triangles: order.iter().map(|&k| mesh.triangles[k]).collect(),
        material_of: order.iter().map(|&k| mesh.material_of[k]).collect(),
        corner_normals,
        ..mesh.clone()
    }
}

/// The same triangles, each with vertices of its own: every edge is a seam of doubled vertices.
pub fn unjoined(mesh: &Mesh) -> Mesh {
    let positions = mesh.triangles.iter().flatten().map(|&v| mesh.positions[v as usize]).collect();
    let triangles = (0..mesh.triangles.len() as u32).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
    Mesh { positions, triangles, normals: Vec::new(), corner_normals: Vec::new(), ..mesh.clone() }
}

/// Triangles anywhere in the cube of half-size 1, about `size` large.
pub fn soup(rng: &mut rng::Rng, count: usize, size: f64) -> Mesh {
    let positions = (0..count)
        .flat_map(|_| {
            let at = rng.vector();
            [at, at + size * rng.vector(), at + size * rng.vector()]
        })
        .collect();
    mesh(positions, (0..count as u32).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect())
}

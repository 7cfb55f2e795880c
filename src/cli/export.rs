//! A compiled camera as files: the pieces of a mesh camera, or every pixel's ray.

use super::describe::{corner_rays, plain_vertices, vertex_at};
use crate::camera::{Camera, Rays};
use crate::error::{Error, Result};
use crate::output::{write_npy_f64, write_text};
use crate::scene::file::{CameraKind, CameraSpec, CameraVertex};
use glam::DVec2;
use rayon::prelude::*;
use serde::Serialize;
use std::path::Path;

/// The `file` of a mesh camera: these two keys and no other.
#[derive(Serialize)]
struct PiecesFile {
    vertices: Vec<VertexRecord>,
    triangles: Vec<[u32; 3]>,
}

#[derive(Serialize)]
struct VertexRecord {
    image: [f64; 2],
    near: [f64; 3],
    far: [f64; 3],
    #[serde(skip_serializing_if = "is_one")]
    w: f64,
}

fn is_one(w: &f64) -> bool {
    *w == 1.0
}

/// Writes the camera's pieces so that a mesh camera with this `file` has the same rays. A camera of one piece
/// becomes two triangles that cover the image.
///
/// # Errors
/// [`Error::Input`] for a ray map, which has no pieces.
pub fn write_pieces(path: &Path, spec: &CameraSpec, camera: &Camera) -> Result<()> {
    let [Rays::Pieces(pieces)] = camera.layers.as_slice() else {
        return Err(Error::input("--export: a ray map has no pieces; use --rays RAYS.npy"));
    };
    let (vertices, triangles) = match (&spec.kind, pieces.pieces.as_slice()) {
        (CameraKind::Mesh(mesh), _) => (plain_vertices(mesh), mesh.triangles.clone()),
        (_, [piece]) if piece.corners_px.is_none() => {
            let size = DVec2::new(camera.width.into(), camera.height.into());
            let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]];
            let vertices = corners.map(|ab| vertex_at(piece, DVec2::from(ab) * size, size)).to_vec();
            (vertices, vec![[0, 1, 2], [2, 1, 3]])
        }
        _ => {
            // a million pieces at most, so three times as many vertices have numbers
            let vertices = corner_rays(spec, camera).concat();
            let triangles = (0..vertices.len() as u32 / 3).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
            (vertices, triangles)
        }
    };
    let record = |v: CameraVertex| VertexRecord { image: v.image, near: v.near.into(), far: v.far.into(), w: v.w };
    let file = PiecesFile { vertices: vertices.into_iter().map(record).collect(), triangles };
    let text = serde_json::to_string_pretty(&file).map_err(|e| Error::work(format!("camera as JSON: {e}")))?;
    write_text(path, &(text + "\n"))
}

/// Writes P and D of every pixel, H x W x 6; NaN where a pixel has no ray.
pub fn write_rays(path: &Path, camera: &Camera) -> Result<()> {
    let width = camera.width as usize;
    let mut numbers = vec![f64::NAN; 6 * width * camera.height as usize];
    numbers.par_chunks_mut(6 * width).enumerate().for_each(|(j, row)| {
        for (i, six) in row.chunks_exact_mut(6).enumerate() {
            if let Some(ray) = camera.ray(i as u32, j as u32) {
                six[..3].copy_from_slice(&ray.origin.to_array());
                six[3..].copy_from_slice(&ray.direction.to_array());
            }
        }
    });
    write_npy_f64(path, &[camera.height.into(), camera.width.into(), 6], &numbers)
}

//! A compiled camera as files: the pieces of a mesh camera, or every pixel's ray.

use super::describe::{plain_vertices, vertex_at};
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
        (_, [piece]) => {
            let size = DVec2::new(camera.width.into(), camera.height.into());
            let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]];
            let vertices = corners.map(|ab| vertex_at(&piece.bundle, piece.centre_px, size, ab)).to_vec();
            (vertices, vec![[0, 1, 2], [2, 1, 3]])
        }
        _ => return Err(Error::work(format!("--export: no way to write a camera of kind {}", camera.kind))),
    };
    let record = |v: CameraVertex| VertexRecord { image: v.image, near: v.near.into(), far: v.far.into(), w: v.w };
    let file = PiecesFile { vertices: vertices.into_iter().map(record).collect(), triangles };
    let text = serde_json::to_string_pretty(&file).map_err(|e| Error::work(format!("camera as JSON: {e}")))?;
    write_text(path, &(text + "\n"))
}

/// The shape of what [`write_rays`] writes for a pixel: 6 numbers P, D; for curves and projectors m + 1 control points of
/// 3 numbers, m the highest degree; for chains one of these for each layer.
pub fn pixel_shape(camera: &Camera) -> Vec<usize> {
    let degree = |layer: &Rays| match layer {
        Rays::Curves(curves) => Some(curves.map.degree()),
        _ => (camera.kind == "projector").then_some(1),
    };
    let layers = camera.layers.len();
    let mut shape = if layers > 1 || camera.kind == "chain" { vec![layers] } else { Vec::new() };
    match camera.layers.iter().filter_map(degree).max() {
        Some(m) => shape.extend([m + 1, 3]),
        None => shape.push(6),
    }
    shape
}

/// Writes every pixel's rays, H x W x [`pixel_shape`]; NaN where a pixel, or a layer of it, has none.
pub fn write_rays(path: &Path, camera: &Camera) -> Result<()> {
    let shape = pixel_shape(camera);
    let (each, straight): (usize, bool) = (shape.iter().product(), shape.last() == Some(&6));
    let width = camera.width as usize;
    let mut numbers = vec![f64::NAN; each * width * camera.height as usize];
    numbers.par_chunks_mut(each * width).enumerate().for_each(|(j, row)| {
        for (i, pixel) in row.chunks_exact_mut(each).enumerate() {
            for (layer, numbers) in pixel.chunks_exact_mut(each / camera.layers.len()).enumerate() {
                put_ray(numbers, straight, camera, (layer, i as u32, j as u32));
            }
        }
    });
    let image = [camera.height.into(), camera.width.into()];
    write_npy_f64(path, &[&image[..], &shape.iter().map(|n| *n as u64).collect::<Vec<_>>()].concat(), &numbers)
}

/// P and D of a straight ray, or the control points of a curve of the degree that there is room for.
fn put_ray(numbers: &mut [f64], straight: bool, camera: &Camera, (layer, i, j): (usize, u32, u32)) {
    let vectors = if straight {
        camera.pixel(layer, i, j).map(|(_, bundle)| bundle.ray(0.0, 0.0)).map(|ray| vec![ray.origin, ray.direction])
    } else {
        camera.curve(layer, i, j).map(|(_, curve)| curve.elevated(numbers.len() / 3 - 1).points().to_vec())
    };
    for (three, vector) in numbers.chunks_exact_mut(3).zip(vectors.into_iter().flatten()) {
        three.copy_from_slice(&vector.to_array());
    }
}

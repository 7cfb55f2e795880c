//! A compiled camera as files: the pieces of a mesh camera, or every pixel's ray.

use crate::arrays::MapEach;
use crate::camera::mesh::spec::{CameraVertex, MeshCameraSpec};
use crate::camera::spec::CameraSpec;
use crate::camera::{Bundle, Camera, Pieces, Rays, mesh};
use crate::image::{write_npy, write_text};
use crate::input::{Error, Limits, Result};
use crate::parallel;
use crate::reference::{Path, Reference, Segment};
use glam::DVec2;
use serde::Serialize;
use std::collections::{BTreeMap, HashMap};
use std::path::Path as FilePath;

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

/// Writes the camera's pieces so that a mesh camera with this `file`, or a chain with these `layers`, has the same rays to
/// rounding, over the camera's own `t_range`. A piece that is the whole image becomes two triangles.
///
/// # Errors
/// [`Error::Input`] for ray fields and curves, which have no pieces, and for pieces that overlap.
pub fn write_pieces(path: &FilePath, spec: &CameraSpec, camera: &Camera, limits: Limits) -> Result<()> {
    if camera.optics.is_some() {
        let kind = camera.kind;
        return Err(Error::input(format!(
            "--export: {kind} reflects or refracts rays, which mesh cameras cannot represent; use --rays RAYS.npy"
        )));
    }
    let mut layers = match spec.kind.recipe::<MeshCameraSpec>() {
        // exactly as written, without rounding by a conversion and its inverse
        Some(mesh) => vec![PiecesFile::of(&plain(mesh))],
        None => camera.layers.iter().map(|layer| layer_file(camera, layer, limits)).collect::<Result<_>>()?,
    };
    let text = match layers.len() {
        1 => serde_json::to_string_pretty(&layers.remove(0)),
        _ => serde_json::to_string_pretty(&BTreeMap::from([("layers", layers)])),
    };
    let text = text.map_err(|e| Error::work(format!("camera as JSON: {e}")))?;
    write_text(path, &(text + "\n"))
}

fn layer_file(camera: &Camera, layer: &Rays, limits: Limits) -> Result<PiecesFile> {
    let each = match layer {
        Rays::Pieces(pieces) => {
            let spec = as_mesh(pieces, camera);
            let checked = mesh::compile(&spec, (camera.width, camera.height), &mut Vec::new(), limits);
            checked.map_err(|e| Error::input(format!("--export: no mesh camera has these pieces: {e}")))?;
            return Ok(PiecesFile::of(&spec));
        }
        Rays::Field(_) => "ray",
        Rays::Curves(_) => "curve",
    };
    let kind = camera.kind;
    Err(Error::input(format!("--export: {kind} has no pieces but a {each} for each pixel; use --rays RAYS.npy")))
}

/// The mesh camera so that plain interpolation gives its rays: unit directions become far points.
fn plain(mesh: &MeshCameraSpec) -> MeshCameraSpec {
    let unit = |v: &CameraVertex| CameraVertex { far: v.near + (v.far - v.near).normalize_or_zero(), ..*v };
    match mesh.normalize {
        true => MeshCameraSpec { vertices: mesh.vertices.iter().map(unit).collect(), normalize: false, ..mesh.clone() },
        false => mesh.clone(),
    }
}

/// The mesh camera with the rays of these pieces at their corners; corners with the same bits are one vertex.
fn as_mesh(pieces: &Pieces, camera: &Camera) -> MeshCameraSpec {
    let size = DVec2::new(camera.width.into(), camera.height.into());
    let image = [DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::ONE].map_each(|ab| ab * size);
    let mut spec = MeshCameraSpec::default();
    let mut known = HashMap::new();
    for piece in &pieces.pieces {
        let triangles = match piece.corners_px {
            Some(corners) => vec![corners],
            None => vec![[image[0], image[1], image[2]], [image[2], image[1], image[3]]],
        };
        for corners in triangles {
            let index = corners.map_each(|at_px| {
                let vertex = vertex_at(&piece.bundle, at_px - piece.centre_px, at_px / size);
                *known.entry(bits(&vertex)).or_insert_with(|| {
                    spec.vertices.push(vertex);
                    spec.vertices.len() as u32 - 1
                })
            });
            spec.triangles.push(index);
        }
    }
    spec
}

/// The ray and weight `offset_px` from the bundle's centre, which is at the image coordinates `ab`.
fn vertex_at(bundle: &Bundle, offset_px: DVec2, ab: DVec2) -> CameraVertex {
    let ray = bundle.ray(offset_px.x, offset_px.y);
    let w = bundle.h[0] + offset_px.x * bundle.h[1] + offset_px.y * bundle.h[2];
    CameraVertex { image: ab.to_array(), near: ray.origin, far: ray.origin + ray.direction, w }
}

fn bits(v: &CameraVertex) -> [u64; 9] {
    let ([a, b], near, far) = (v.image, v.near, v.far);
    [a, b, near.x, near.y, near.z, far.x, far.y, far.z, v.w].map(f64::to_bits)
}

impl PiecesFile {
    fn of(mesh: &MeshCameraSpec) -> PiecesFile {
        let record = |v: &CameraVertex| VertexRecord { image: v.image, near: v.near.into(), far: v.far.into(), w: v.w };
        PiecesFile { vertices: mesh.vertices.iter().map(record).collect(), triangles: mesh.triangles.clone() }
    }
}

/// The shape of what [`write_rays`] writes for a pixel: 6 numbers P, D; for curves and projectors m + 1 control points of
/// 3 numbers, m the highest degree; for chains one of these per layer; with optics one per bounce and one more.
pub fn pixel_shape(camera: &Camera) -> Vec<usize> {
    let degree = |layer: &Rays| match layer {
        Rays::Curves(curves) => Some(curves.map.degree()),
        _ => (camera.kind == "projector").then_some(1),
    };
    let layers = segments(camera);
    let mut shape = if layers > 1 || camera.kind == "chain" { vec![layers] } else { Vec::new() };
    match camera.layers.iter().filter_map(degree).max() {
        Some(m) => shape.extend([m + 1, 3]),
        None => shape.push(6),
    }
    shape
}

/// Layers of a chain; rays between bounces.
fn segments(camera: &Camera) -> usize {
    camera.optics.as_ref().map_or(camera.layers.len(), |o| o.depth as usize + 1)
}

/// Writes every pixel's rays, H x W x [`pixel_shape`]; NaN where a pixel, or a layer of it, has none. With optics, rays run from
/// bounce to bounce for t in [0, 1]; the last one is unbounded. Other triangles are ignored.
///
/// # Errors
/// [`Error::Input`] for optics that are seen along curves, or along several layers of rays.
pub fn write_rays(path: &FilePath, camera: &Camera) -> Result<()> {
    if camera.optics.is_some() && camera.is_curved_or_layered() {
        return Err(Error::input(
            "--rays: a mirror or lens is seen along curved or layered rays, which this file has no place for; use an eye of straight rays",
        ));
    }
    let shape = pixel_shape(camera);
    let (each, straight): (usize, bool) = (shape.iter().product(), shape.last() == Some(&6));
    let width = camera.width as usize;
    let mut numbers = vec![f64::NAN; each * width * camera.height as usize];
    let alone = camera.optics.as_ref().and_then(|o| o.facets().map(|f| f.mesh(o.base))).unwrap_or_default();
    let reference = Reference::build(&alone);
    parallel::for_each(numbers.chunks_mut(each * width).enumerate(), |(j, row)| {
        for (i, pixel) in row.chunks_exact_mut(each).enumerate() {
            if let Some(optics) = &camera.optics {
                let path = reference.outcome(optics, Path::of_pixel(camera, i as u32, j as u32)).path;
                for (numbers, segment) in pixel.chunks_exact_mut(6).zip(&path.segments) {
                    if let Some((_, Segment::Straight(bundle))) = segment {
                        let ray = bundle.ray(0.0, 0.0);
                        numbers.copy_from_slice(&[ray.origin.to_array(), ray.direction.to_array()].concat());
                    }
                }
                continue;
            }
            for (layer, numbers) in pixel.chunks_exact_mut(each / camera.layers.len()).enumerate() {
                put_ray(numbers, straight, camera, (layer, i as u32, j as u32));
            }
        }
    });
    let image = [camera.height.into(), camera.width.into()];
    write_npy(path, &[&image[..], &shape.iter().map(|n| *n as u64).collect::<Vec<_>>()].concat(), &numbers)
}

/// P and D of a straight ray, or the control points of a curve, raised to the degree of the array.
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

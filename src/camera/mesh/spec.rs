//! The pieces of a `mesh` camera: inline in the scene, or in a JSON file of their own.

use std::path::Path;

use glam::DVec3;
use serde::Deserialize;

use crate::input::parse::json_error;
use crate::input::reader::{Field, Table};
use crate::input::{Error, Result};

/// Image triangles with a near and a far point at each vertex.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct MeshCameraSpec {
    /// Every value finite, every `w` above 0.
    pub vertices: Vec<CameraVertex>,
    /// Three indices into `vertices` a piece, all in range.
    pub triangles: Vec<[u32; 3]>,
    /// Interpolate unit directions instead of far points.
    pub normalize: bool,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CameraVertex {
    /// Image coordinates (a, b); (0, 0) is the top left corner, (1, 1) the bottom right one.
    pub image: [f64; 2],
    /// Where the ray has t = 0, world units.
    pub near: DVec3,
    /// Where the ray has t = 1, world units.
    pub far: DVec3,
    /// Weight of a perspective piece.
    pub w: f64,
}

/// The file's own form; every key is known.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PiecesFile {
    vertices: Vec<VertexRecord>,
    triangles: Vec<[u32; 3]>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct VertexRecord {
    image: [f64; 2],
    near: [f64; 3],
    far: [f64; 3],
    #[serde(default = "default_w")]
    w: f64,
}

fn default_w() -> f64 {
    1.0
}

/// The keys of a table of pieces.
pub const MESH_CAMERA_KEYS: [&str; 4] = ["vertices", "triangles", "file", "normalize"];

/// Reads the pieces of a camera table whose keys are already known to be right.
pub fn read_mesh_camera(table: &Table) -> Result<MeshCameraSpec> {
    let normalize = table.or("normalize", false, Field::boolean)?;
    let inline = table.has("vertices") || table.has("triangles");
    let (vertices, triangles) = match table.get("file") {
        Some(file) if inline => return Err(file.error("a mesh camera has either a file or vertices and triangles")),
        Some(file) => read_pieces_file(&file)?,
        None if inline => (read_vertices(table)?, read_triangles(table)?),
        None => return Err(table.error("a mesh camera needs vertices and triangles, or file = \"PIECES.json\"")),
    };
    let spec = MeshCameraSpec { vertices, triangles, normalize };
    check(&spec).map_err(|message| match table.get("file") {
        Some(file) => file.error(message),
        None => table.error(message),
    })?;
    Ok(spec)
}

fn read_vertices(table: &Table) -> Result<Vec<CameraVertex>> {
    let example = "[{ image = [0, 0], near = [0, 0, 0], far = [0, 0, -1] }, ...]";
    table.need("vertices", example)?.items("a list of vertices")?.map(|vertex| read_vertex(&vertex)).collect()
}

fn read_vertex(field: &Field) -> Result<CameraVertex> {
    let table = field.table()?;
    table.allow(&["image", "near", "far", "w"])?;
    Ok(CameraVertex {
        image: table.need("image", "[0, 0]")?.numbers("two numbers, as [a, b]")?,
        near: table.need("near", "[0, 0, 0]")?.vec3()?,
        far: table.need("far", "[0, 0, -1]")?.vec3()?,
        w: table.or("w", 1.0, Field::number)?,
    })
}

/// The table's `triangles`: three indices each, not yet known to be in range.
pub fn read_triangles(table: &Table) -> Result<Vec<[u32; 3]>> {
    let field = table.need("triangles", "[[0, 1, 2]]")?;
    field.items("a list of triangles")?.map(|triangle| read_triangle(&triangle)).collect()
}

fn read_triangle(field: &Field) -> Result<[u32; 3]> {
    let mut corners = [0; 3];
    for (corner, item) in corners.iter_mut().zip(field.array::<3>("three vertex indices, as [0, 1, 2]")?) {
        // In range of u32 by the limit given.
        *corner = item.integer(0, u32::MAX.into())? as u32;
    }
    Ok(corners)
}

fn read_pieces_file(field: &Field) -> Result<(Vec<CameraVertex>, Vec<[u32; 3]>)> {
    let path = field.path()?;
    let bytes = field
        .loading()
        .read(&path)
        .map_err(|e| field.error(format_args!("{} cannot be read: {e}; check the path", path.display())))?;
    parse_pieces(&bytes, &path)
}

fn parse_pieces(bytes: &[u8], path: &Path) -> Result<(Vec<CameraVertex>, Vec<[u32; 3]>)> {
    let file: PiecesFile = serde_json::from_slice(bytes).map_err(|e| -> Error { json_error(&e, path) })?;
    let vertex = |v: VertexRecord| CameraVertex { image: v.image, near: v.near.into(), far: v.far.into(), w: v.w };
    Ok((file.vertices.into_iter().map(vertex).collect(), file.triangles))
}

/// The first vertex or piece whose values cannot be used.
fn check(spec: &MeshCameraSpec) -> std::result::Result<(), String> {
    for (index, v) in spec.vertices.iter().enumerate() {
        if !(v.near.is_finite() && v.far.is_finite() && v.image.iter().all(|x| x.is_finite())) {
            return Err(format!("vertices.{index}: image, near and far must be finite numbers"));
        }
        if !(v.w > 0.0 && v.w.is_finite()) {
            return Err(format!("vertices.{index}: w is {}; a weight must be finite and above 0", v.w));
        }
    }
    let count = spec.vertices.len();
    for (piece, triangle) in spec.triangles.iter().enumerate() {
        if let Some(index) = triangle.iter().find(|&&index| index as usize >= count) {
            return Err(format!("triangles.{piece}: vertex {index} does not exist; there are {count}, counted from 0"));
        }
    }
    Ok(())
}

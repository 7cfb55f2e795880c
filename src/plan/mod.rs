//! The plan: what a frame needs, worked out before the GPU is touched. Pure functions of camera, scene and limits.
//!
//! The image is cut into bands of whole tile rows that fit the adapter's bindings. Every band has its tiles ([`tiles`]:
//! which pixels belong to which piece) and a tree of nodes over them ([`nodes`]: bounds on the rays of each square).

pub mod nodes;
pub mod tiles;

use crate::camera::{Camera, Rays};
use crate::frame::Channel;
use crate::gpu::device::Abilities;
use crate::gpu::kernels::Variant;
use crate::gpu::rows;
use glam::DVec3;
use serde::Serialize;

/// Something that a frame does without.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct LeftOut {
    pub what: String,
    pub why: String,
}

/// What a caller wants of a frame.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Wanted {
    /// Planes to read back, in the order of [`Channel::ALL`].
    pub channels: Vec<Channel>,
    /// 8-bit sRGB colour.
    pub srgb8: bool,
    /// Count tested and kept fragments (slower).
    pub counting: bool,
}

/// Rows of the image that are rendered together, and their tables.
#[derive(Debug, Clone)]
pub struct Band {
    /// First image row, a multiple of the tile size.
    pub row: u32,
    pub rows: u32,
    pub tiles: tiles::Tiles,
    pub nodes: nodes::Nodes,
    /// The camera's ray table for the band, where it is a ray field.
    pub field: Option<FieldTable>,
}

/// Rays of a ray field relative to the anchor: six numbers a pixel, hi and lo, one column and row more than the band.
#[derive(Debug, Clone, Default)]
pub struct FieldTable {
    pub hi: Vec<f32>,
    pub lo: Vec<f32>,
}

/// What one frame takes.
#[derive(Debug, Clone)]
pub struct Plan {
    pub variant: Variant,
    pub bands: Vec<Band>,
    /// The channels that `shade` writes: those wanted, and colour where sRGB is.
    pub planes: Vec<Channel>,
    /// Bits of a visibility key that hold the triangle id.
    pub id_bits: u32,
    pub anchor: DVec3,
    pub left_out: Vec<LeftOut>,
}

/// A point near the camera's rays' start and the scene: the middle ray's origin, clamped into the scene's box.
pub fn anchor(camera: &Camera, bounds: Option<(DVec3, DVec3)>) -> DVec3 {
    let middle = (camera.width / 2, camera.height / 2);
    let start = camera.ray(middle.0, middle.1).map_or(DVec3::ZERO, |r| r.origin);
    match bounds {
        Some((lo, hi)) => start.clamp(lo, hi),
        None => start,
    }
}

impl Plan {
    /// Plans frames of `camera` over a scene of `triangles` triangles.
    pub fn new(
        camera: &Camera,
        triangles: usize,
        has_normals: bool,
        anchor: DVec3,
        wanted: &Wanted,
        has: Abilities,
        binding_limit: u64,
    ) -> Plan {
        let field = matches!(camera.layers[0], Rays::Field(_));
        let variant = Variant { f64: has.f64, atomics64: has.atomics64, field, counting: wanted.counting };
        let mut planes = wanted.channels.clone();
        if wanted.srgb8 {
            planes.extend([Channel::R, Channel::G, Channel::B]);
        }
        planes.sort_unstable();
        planes.dedup();
        let pixel_bytes = (4 * planes.len() as u64).max(if field { 24 } else { 8 });
        let bands = bands(camera, anchor, pixel_bytes, binding_limit);
        let id_bits = usize::BITS - triangles.saturating_sub(1).leading_zeros();
        let left_out = left_out(camera, &bands, &planes, wanted, has_normals, has);
        Plan { variant, bands, planes, id_bits: id_bits.max(1), anchor, left_out }
    }
}

/// Cuts the image into bands whose every buffer fits a binding.
fn bands(camera: &Camera, anchor: DVec3, pixel_bytes: u64, binding_limit: u64) -> Vec<Band> {
    let tile = crate::TILE as u64;
    let row_bytes = (camera.width as u64 + 1) * pixel_bytes;
    // one row more than the band: the ray table's
    let rows = ((binding_limit / row_bytes).saturating_sub(1) / tile * tile).max(tile) as u32;
    let mut todo: Vec<(u32, u32)> =
        (0..camera.height).step_by(rows as usize).map(|r| (r, rows.min(camera.height - r))).rev().collect();
    let mut bands = Vec::new();
    while let Some((row, rows)) = todo.pop() {
        let band = Band::new(camera, anchor, row, rows);
        let fits = band.tiles.cells.len() <= CELLS_MAX
            && band.tiles.cells.len() * size_of::<rows::Cell>() <= binding_limit as usize
            && band.tiles.pieces.len() * size_of::<rows::Piece>() <= binding_limit as usize;
        if fits || rows <= crate::TILE {
            bands.push(band);
            continue;
        }
        let upper = (rows / 2).next_multiple_of(crate::TILE);
        todo.push((row + upper, rows - upper));
        todo.push((row, upper));
    }
    bands
}

/// Cells that a pair can name: 24 bits.
const CELLS_MAX: usize = 1 << 24;

impl Band {
    fn new(camera: &Camera, anchor: DVec3, row: u32, rows: u32) -> Band {
        let (tiles, samples) = tiles::Tiles::new(camera, anchor, row, rows);
        let nodes = nodes::Nodes::new(&samples, tiles.tiles_x, tiles.tiles_y);
        let field = match &camera.layers[0] {
            Rays::Field(f) => Some(tiles::field_table(f, anchor, row, rows)),
            Rays::Pieces(_) | Rays::Curves(_) => None,
        };
        Band { row, rows, tiles, nodes, field }
    }
}

fn left_out(
    camera: &Camera,
    bands: &[Band],
    planes: &[Channel],
    wanted: &Wanted,
    has_normals: bool,
    has: Abilities,
) -> Vec<LeftOut> {
    let mut list = Vec::new();
    let mut say = |what: &str, why: String| list.push(LeftOut { what: what.into(), why });
    if matches!(camera.layers[0], Rays::Pieces(_)) {
        say("per-pixel ray table", "every ray follows from its piece".into());
    } else {
        say("edge conics", "the camera is a ray field".into());
    }
    if bands.iter().all(|b| b.nodes.exact) {
        say("ray residuals", "every node holds one affine piece".into());
    }
    if bands.len() == 1 {
        say("bands", "the whole image fits the adapter's bindings".into());
    }
    let absent: Vec<&str> = Channel::ALL.iter().filter(|c| !planes.contains(c)).map(|c| c.name()).collect();
    if !absent.is_empty() {
        say("channels", format!("not asked for: {}", absent.join(", ")));
    }
    if !has_normals {
        say("smooth normals", "the scene has none".into());
    }
    if !wanted.srgb8 {
        say("write", "no 8-bit picture asked for".into());
    }
    if !wanted.counting {
        say("fragment counters", "no report asked for".into());
    }
    if !has.f64 {
        say("f64 rechecks", "the adapter has no f64 or no 64-bit integers: signs and depths are f32's".into());
    }
    if has.atomics64 {
        say("second depth dispatch", "the adapter has 64-bit atomics".into());
    }
    for note in &camera.notes {
        say("rays", note.clone());
    }
    list
}

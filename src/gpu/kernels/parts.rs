//! Snippets and bindings that several kernels share.

pub(crate) use super::kernel::{Binding, Kernel, Parts, reads, snippets, texture, uniform, writes, writes_texture};

pub(crate) const PARAMS: Parts = snippets!("shared/params.wgsl");
pub(crate) const ITEMS: Parts = snippets!("shared/items.wgsl");
pub(crate) const INDEX: Parts = snippets!("shared/index.wgsl");
pub(crate) const ADDRESS: Parts = snippets!("shared/address.wgsl");
pub(crate) const SLABS: Parts = snippets!("shared/slabs.wgsl");
/// Triangles and vertices from their textures.
pub(crate) const VERTEX: Parts = snippets!("shared/table.wgsl", "shared/vertex.wgsl");
pub(crate) const PACKED_TRIANGLE: Parts = snippets!("shared/triangle.wgsl");
pub(crate) const TRIANGLE: Parts = snippets!("shared/triangle.wgsl", "shared/vertex_real.wgsl");
pub(crate) const RAY: Parts = snippets!("shared/ray.wgsl");
pub(crate) const BUNDLE: Parts = snippets!("shared/ray.wgsl", "shared/bundle.wgsl");
pub(crate) const SHADING: Parts = snippets!("shared/shading.wgsl");
pub(crate) const MEETS: Parts = snippets!("shared/meets.wgsl");
/// Which pixels of a node's square a triangle may cover.
pub(crate) const WITHIN: Parts = snippets!("shared/node_conics.wgsl", "shared/extent.wgsl", "shared/within.wgsl");
/// Whether rays of a node may meet a triangle's box.
pub(crate) const BOX_MET: Parts = snippets!("shared/meets.wgsl", "shared/box_met.wgsl");
pub(crate) const SIDES: Parts = snippets!("shared/sides.wgsl", "shared/perturb.wgsl");
pub(crate) const NEARNESS: Parts = snippets!("shared/nearness.wgsl");
/// The cell of a pixel.
pub(crate) const CELLS: Parts = snippets!("shared/cells.wgsl");
pub(crate) const PIECE_AT: Parts = snippets!("shared/table.wgsl", "camera/piece_at.wgsl");
/// A camera's pieces and their bundles.
pub(crate) const PIECES: Parts = snippets!("shared/table.wgsl", "camera/piece_at.wgsl", "camera/piece.wgsl");
pub(crate) const LANES: Parts = snippets!("shared/lanes.wgsl");
pub(crate) const COLUMN: Parts = snippets!("shared/column.wgsl");
/// No triangle has an alpha mask.
pub(crate) const SOLID: Parts = snippets!("textures/solid.wgsl");
pub(crate) const UNCERTAIN: Parts = snippets!("shared/places.wgsl", "shared/recheck_items.wgsl");
pub(crate) const PLACES: Parts = snippets!("shared/places.wgsl");
pub(crate) const PAIR: Parts = snippets!("shared/pair.wgsl");
pub(crate) const BITS: Parts = snippets!("shared/bits.wgsl");
pub(crate) const MEETING: Parts = snippets!("shared/meeting.wgsl");
pub(crate) const MEETING_OF_RAYS: Parts = snippets!("shared/meeting_of_rays.wgsl");
pub(crate) const KEY: Parts = snippets!("shared/key.wgsl");
pub(crate) const REAL_F64: Parts = snippets!("shared/real_f64.wgsl");
pub(crate) const REAL_F32: Parts = snippets!("shared/real_f32.wgsl");
pub(crate) const OPTICS_LAYOUT: Parts = snippets!("optics/layout.wgsl");
pub(crate) const CAUSTICS: Parts = snippets!("caustics/layout.wgsl");
pub(crate) const CELL_SAMPLES: Parts = snippets!("samples/cells.wgsl");
pub(crate) const SAMPLE_OFFSETS: Parts = snippets!("samples/offsets.wgsl");
pub(crate) const SAMPLE_HITS: Parts = snippets!("samples/hits.wgsl");
pub(crate) const DEPTH_BOUNDS: Parts = snippets!("samples/depth_bounds.wgsl");
pub(crate) const REFRACT: Parts = snippets!("optics/refract.wgsl");
pub(crate) const LIVE_PIXELS: Parts = snippets!("optics/live_pixels.wgsl");

pub(crate) fn params() -> Binding {
    uniform("params", "Params")
}

pub(crate) fn triangles() -> Binding {
    table("triangles")
}

pub(crate) fn vertices() -> Binding {
    table("vertices")
}

pub(crate) fn pieces() -> Binding {
    table("pieces")
}

/// A table in a texture, four words a texel: see [`crate::gpu::buffers::Buffers::upload_texels`].
pub(crate) fn table(name: &'static str) -> Binding {
    texture(name, "texture_2d<u32>")
}

pub(crate) fn step() -> Binding {
    uniform("step", "Step")
}

pub(crate) fn optic() -> Binding {
    uniform("optic", "Optic")
}

pub(crate) fn paths() -> Binding {
    reads("paths", "array<PathState>")
}

/// The tiles that have a ray after a bounce; of a camera's own rays those that may meet the optics.
pub(crate) fn live() -> Binding {
    reads("live", "array<u32>")
}

pub(crate) fn counters() -> Binding {
    writes("counters", "array<atomic<u32>>")
}

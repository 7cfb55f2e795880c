//! Snippets and bindings that several kernels share.

pub(crate) use super::kernel::snippets;
pub use super::kernel::{Binding, Kernel, Parts, reads, texture, uniform, writes, writes_texture};

pub const PARAMS: Parts = snippets!("shared/params.wgsl");
pub const ITEMS: Parts = snippets!("shared/items.wgsl");
pub const INDEX: Parts = snippets!("shared/index.wgsl");
pub const ADDRESS: Parts = snippets!("shared/address.wgsl");
pub const SLABS: Parts = snippets!("shared/slabs.wgsl");
/// Triangles and vertices from their textures.
pub const VERTEX: Parts = snippets!("shared/table.wgsl", "shared/vertex.wgsl");
pub const PACKED_TRIANGLE: Parts = snippets!("shared/triangle.wgsl");
pub const TRIANGLE: Parts = snippets!("shared/triangle.wgsl", "shared/vertex_real.wgsl");
#[cfg(feature = "internals")]
pub const SEGMENT: Parts = snippets!("shared/segment.wgsl");
#[cfg(feature = "internals")]
pub const BVH: Parts = snippets!("shared/bvh.wgsl");
#[cfg(feature = "internals")]
pub const LEAF_TRIANGLE: Parts = snippets!("shared/leaf_triangle.wgsl", "shared/leaf_solid.wgsl");
#[cfg(feature = "internals")]
pub const RAY: Parts = snippets!("shared/ray.wgsl");
pub const BUNDLE: Parts = snippets!("shared/ray.wgsl", "shared/bundle.wgsl");
pub const SHADING: Parts = snippets!("shared/shading.wgsl");
pub const MEETS: Parts = snippets!("shared/meets.wgsl");
/// Which pixels of a node's square a triangle may cover.
pub const WITHIN: Parts = snippets!("shared/node_conics.wgsl", "shared/extent.wgsl", "shared/within.wgsl");
/// Whether rays of a node may meet a triangle's box.
pub const BOX_MET: Parts = snippets!("shared/meets.wgsl", "shared/box_met.wgsl");
pub const SIDES: Parts = snippets!("shared/sides.wgsl", "shared/perturb.wgsl");
pub const NEARNESS: Parts = snippets!("shared/nearness.wgsl");
/// The cell of a pixel.
pub const CELLS: Parts = snippets!("shared/cells.wgsl");
#[cfg(feature = "internals")]
pub const PIECE_AT: Parts = snippets!("shared/table.wgsl", "camera/piece_at.wgsl");
/// A camera's pieces and their bundles.
pub const PIECES: Parts = snippets!("shared/table.wgsl", "camera/piece_at.wgsl", "camera/piece.wgsl");
pub const LANES: Parts = snippets!("shared/lanes.wgsl");
pub const COLUMN: Parts = snippets!("shared/column.wgsl");
pub const UNCERTAIN: Parts = snippets!("shared/places.wgsl", "shared/recheck_items.wgsl");
pub const PLACES: Parts = snippets!("shared/places.wgsl");
pub const PAIR: Parts = snippets!("shared/pair.wgsl");
pub const BITS: Parts = snippets!("shared/bits.wgsl");
pub const MEETING: Parts = snippets!("shared/meeting.wgsl");
pub const MEETING_OF_RAYS: Parts =
    snippets!("shared/plane_tolerance.wgsl", "shared/sides.wgsl", "shared/perturb.wgsl", "shared/meeting_of_rays.wgsl");
pub const KEY: Parts = snippets!("shared/key.wgsl");
pub const REAL_F64: Parts = snippets!("shared/real_f64.wgsl");
pub const REAL_F32: Parts = snippets!("shared/real_f32.wgsl");
pub const OPTICS_LAYOUT: Parts = snippets!("optics/layout.wgsl");
pub const CAUSTICS: Parts = snippets!("caustics/layout.wgsl");
pub const CELL_SAMPLES: Parts = snippets!("samples/cells.wgsl");
pub const SAMPLE_OFFSETS: Parts = snippets!("samples/offsets.wgsl");
pub const SAMPLE_HITS: Parts = snippets!("samples/hits.wgsl");
pub const DEPTH_BOUNDS: Parts = snippets!("samples/depth_bounds.wgsl");
pub const REFRACT: Parts = snippets!("optics/refract.wgsl");
pub const LIVE_PIXELS: Parts = snippets!("optics/live_pixels.wgsl");

pub fn params() -> Binding {
    uniform("params", "Params")
}

pub fn triangles() -> Binding {
    table("triangles")
}

pub fn vertices() -> Binding {
    table("vertices")
}

pub fn pieces() -> Binding {
    table("pieces")
}

/// A table in a texture, four words a texel: see [`crate::gpu::buffers::Buffers::upload_texels`].
pub fn table(name: &'static str) -> Binding {
    texture(name, "texture_2d<u32>")
}

pub fn step() -> Binding {
    uniform("step", "Step")
}

pub fn optic() -> Binding {
    uniform("optic", "Optic")
}

pub fn paths() -> Binding {
    reads("paths", "array<PathState>")
}

/// The tiles that have a ray after a bounce; of a camera's own rays those that may meet the optics.
pub fn live() -> Binding {
    reads("live", "array<u32>")
}

pub fn counters() -> Binding {
    writes("counters", "array<atomic<u32>>")
}

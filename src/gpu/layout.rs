//! The structs that the host writes and the kernels read, in Rust: `wgsl/shared/params.wgsl`, `wgsl/shading/numbers.wgsl`,
//! `wgsl/project/beams.wgsl`, `wgsl/optics/layout.wgsl` and `wgsl/caustics/layout.wgsl`.
//!
//! `tests/wgsl_layout.rs` compares names, offsets, sizes and constants of both sides.

use crate::arrays::MapEach;
use bytemuck::{Pod, Zeroable};
use glam::DVec3;

/// Threads a workgroup, everywhere.
pub const GROUP: u32 = 64;
/// Threads a subgroup where `raster` goes tile by tile.
pub const LANES: u32 = 8;
/// Children a side of a node.
pub const BRANCH: u32 = 4;
/// Triangles a cluster at most.
pub const CLUSTER: u32 = 64;
pub const TRIANGLE_GROUP: u32 = 8;
/// No index.
pub const NONE: u32 = u32::MAX;
/// Beside the slot of an item for recheck: its triangle is proven to cover the pixel.
#[cfg(feature = "internals")]
pub const PROVEN: u32 = 1 << 31;

/// What a node's rays are: none; several pieces, or not affine; one affine bundle; so far from affine that what lies
/// below it bounds them much better.
pub const RAYS_NONE: u32 = 0;
pub const RAYS_LOOSE: u32 = 1;
pub const RAYS_AFFINE: u32 = 2;
pub const RAYS_DISCONTINUOUS: u32 = 3;

/// The level of a cell in the address of a node.
#[cfg(feature = "internals")]
pub const LEVEL_CELL: u32 = 15;

/// Counters of the queues of cull, which come first: the k-th counts the items that step k takes.
pub const CULL_QUEUES: u32 = 8;

/// Defines [`Counter`] with the name of each counter in its place.
macro_rules! counters {
    ($($(#[$about:meta])+ $counter:ident = $name:literal),+ $(,)?) => {
        /// What stages count in `counters` behind the queues of cull, in this order.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
        pub enum Counter {
            $($(#[$about])+ $counter),+
        }

        impl Counter {
            pub const ALL: &[Counter] = &[$(Counter::$counter),+];

            /// The name of its index in WGSL, in lower case.
            pub const fn name(self) -> &'static str {
                match self {
                    $(Counter::$counter => $name),+
                }
            }

            /// Its place in `counters`.
            pub const fn index(self) -> u32 {
                CULL_QUEUES + self as u32
            }
        }
    };
}

counters! {
    /// (cluster, node) items for split.
    Work = "count_work",
    /// (triangle, tile) pairs.
    Pairs = "count_pairs",
    /// Pairs with a pixel that the triangle may cover, where fragments are counted.
    PairsKept = "count_pairs_kept",
    /// Pixels of these that raster tested.
    FragmentsTested = "count_fragments_tested",
    /// Those that the triangle covers.
    FragmentsKept = "count_fragments_kept",
    /// Pixels of triangles for recheck.
    RecheckItems = "count_recheck_items",
    /// Those of these items that are proven to be nearest in f32: recheck finds their t.
    Proven = "count_proven",
    /// Tiles with pairs that raster has not taken yet.
    Busy = "count_busy",
    /// The first of them that raster takes in this round.
    BusyFirst = "count_busy_first",
    /// The end of those that it has taken.
    BusyEnd = "count_busy_end",
    /// Pairs that bin tested, where fragments are counted.
    PairsTested = "count_pairs_tested",
    /// (triangle group, node) items for small, or for bin where there is no small.
    Tasks = "count_tasks",
    /// (triangle, node) items that small leaves to bin.
    Large = "count_large",
    /// Pairs in runs of tiles.
    Sorted = "count_sorted",
    /// Pixels that trace takes over, as it costs less than what raster would still take; 0: none.
    Traced = "count_traced",
    /// Pixels whose paths were longer than trace follows.
    Unfinished = "count_unfinished",
    /// Pixels with an edge. This and those that follow stay while pairs are listed anew.
    Edges = "count_edges",
    /// Blocks of strips of four samples of these.
    Blocks = "count_blocks",
    /// Samples for recheck_samples.
    RecheckSamples = "count_recheck_samples",
}

/// Words of `counters`.
pub const COUNTERS: u32 = CULL_QUEUES + Counter::ALL.len() as u32;

/// What things cost, in tenths of a microsecond on a software adapter beside other work: an item of cull's queue, a triangle group for bin,
/// a triangle that small leaves to it, and a pair. Only their ratios count; the measurements are in `bench_results/lab.md`.
pub const CULL_COST: u32 = 60;
pub const TASK_COST: u32 = 60;
pub const LARGE_COST: u32 = 4;
pub const PAIR_COST: u32 = 3;

/// Bits of the last word of a triangle: id below, file order above, one-sidedness on top.
pub const ID_BITS_MAX: u32 = 28;
pub const ID_MASK: u32 = (1 << ID_BITS_MAX) - 1;
pub const ORDER_SHIFT: u32 = 28;
pub const ONE_SIDED: u32 = 1 << 31;
/// Stand for the order of a triangle's corners in the last word of a sphere or capsule.
pub const SPHERE: u32 = 7 << ORDER_SHIFT;
pub const CAPSULE: u32 = 6 << ORDER_SHIFT;
/// The bits of that.
pub const ROUND: u32 = 7 << ORDER_SHIFT;

/// Texels of a row of the textures that hold tables.
pub const TEXELS_A_ROW: u32 = 4096;

/// A vertex relative to the anchor, two texels: the f32 nearest, and what it leaves.
#[repr(C)]
#[derive(Debug, Clone, Copy, Default, PartialEq, Pod, Zeroable)]
pub struct Vertex {
    pub hi: [f32; 3],
    pub lo: [f32; 3],
    pad: [f32; 2],
}

impl Vertex {
    pub fn new(position: DVec3) -> Vertex {
        let [[a, b], [c, d], [e, f]] = position.to_array().map_each(split2);
        Vertex { hi: [a, c, e], lo: [b, d, f], pad: [0.0; 2] }
    }

    /// As stored.
    pub fn position(&self) -> DVec3 {
        DVec3::from(self.hi.map_each(f64::from)) + DVec3::from(self.lo.map_each(f64::from))
    }
}

/// One band of the image and one batch of clusters of one chunk.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct Params {
    pub width: u32,
    pub height: u32,
    pub tiles_x: u32,
    pub tiles_y: u32,
    pub levels: u32,
    pub cluster_first: u32,
    pub cluster_count: u32,
    pub id_bits: u32,
    pub queue_capacity: u32,
    pub work_capacity: u32,
    pub pair_capacity: u32,
    pub slab_rows: u32,
    pub id_first: u32,
    pub id_count: u32,
    pub band_row: u32,
    pub spans: u32,
    pub recheck_capacity: u32,
    pub origin_error: f32,
    pub task_capacity: u32,
    pub edge_capacity: u32,
    pub scene_size: f32,
    pub raster_budget: f32,
    pub steps: u32,
    pub sample: u32,
    pub t_min: [f32; 4],
    pub t_max: [f32; 4],
    pub t_words: [u32; 4],
    pub level_start: [u32; 8],
    pub level_width: [u32; 8],
    pub level_height: [u32; 8],
    pub bvh_offset: [f32; 3],
    pub surface_rows: u32,
}

/// Offsets of samples from their pixel's centre, px right and down: two per vec4.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct SampleOffsets {
    pub at: [[f32; 4]; 16],
}

/// Which dispatch of a kernel this is.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct Step {
    pub value: u32,
}

/// Up to [`CLUSTER`] triangles near each other, and their box about the anchor; or [`TRIANGLE_GROUP`] of them.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Cluster {
    pub centre: [f32; 3],
    pub first: u32,
    pub half: [f32; 3],
    pub count: u32,
}

/// The rays of one square of the image, see the WGSL.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Node {
    pub p: [f32; 3],
    pub r_p: f32,
    pub px: [f32; 3],
    pub r_d: f32,
    pub py: [f32; 3],
    pub rays: u32,
    pub d: [f32; 3],
    pub width: f32,
    pub dx: [f32; 3],
    /// That owns all pixels of the square; [`NONE`]: there is none.
    pub piece: u32,
    pub dy: [f32; 3],
    pub pad2: f32,
}

/// The pixels of one tile that one piece owns, or a part of a discontinuous tile of a field; the piece's bundle at the tile's
/// centre, and the node that bounds its rays.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Cell {
    pub p: [f32; 3],
    pub h: f32,
    pub d: [f32; 3],
    pub piece: u32,
    pub tile: u32,
    pub mask_lo: u32,
    pub mask_hi: u32,
    pub node: u32,
}

/// A piece's bundle about `origin` (band pixels), each value a sum hi + lo.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Piece {
    pub p_hi: [f32; 3],
    pub h_hi: f32,
    pub px_hi: [f32; 3],
    pub hx_hi: f32,
    pub py_hi: [f32; 3],
    pub hy_hi: f32,
    pub d_hi: [f32; 3],
    pub origin_x: f32,
    pub dx_hi: [f32; 3],
    pub origin_y: f32,
    pub dy_hi: [f32; 3],
    pub number: u32,
    pub p_lo: [f32; 3],
    pub h_lo: f32,
    pub px_lo: [f32; 3],
    pub hx_lo: f32,
    pub py_lo: [f32; 3],
    pub hy_lo: f32,
    pub d_lo: [f32; 3],
    pub pad1: f32,
    pub dx_lo: [f32; 3],
    pub pad2: f32,
    pub dy_lo: [f32; 3],
    pub pad3: f32,
}

/// How `shade` lights.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Shading {
    pub background: [f32; 3],
    pub ambient: f32,
    pub anchor: [f32; 3],
    pub light_count: u32,
    pub gain: f32,
    pub curve: u32,
    pub filter_width: f32,
    pub shadow_bvh_scale: f32,
    pub sky: u32,
    pub sky_strength: f32,
    pub sky_rotation: f32,
    pub sky_is_seen: u32,
    pub occlusion_rays: u32,
    pub occlusion_reach: f32,
    pub nodes_first: u32,
    pub leaves_first: u32,
    pub pictures_first: u32,
    pub picture_count: u32,
    pub masks_first: u32,
    pub pad0: u32,
    pub irradiance: [[f32; 4]; 9],
}

/// The pose of a viewer; see the WGSL.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct ViewerPose {
    pub numbers: [[u32; 4]; 6],
    pub eye: [f32; 3],
    pub ray_count: u32,
    pub right: [f32; 3],
    pub numbers_a_ray: u32,
    pub up: [f32; 3],
    pub node_count: u32,
    pub forward: [f32; 3],
    pub perturb: f32,
}

/// Appearance of a triangle; see the WGSL.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Material {
    pub diffuse: [f32; 3],
    pub texture: u32,
    pub origin: [u32; 2],
    pub size: [u32; 2],
    pub page: u32,
    pub levels: u32,
    pub span: u32,
    pub cutoff: f32,
    pub specular: [f32; 3],
    pub alpha: f32,
    pub emissive: [f32; 3],
    pub metallic: f32,
    pub pattern_light: [f32; 3],
    pub pattern: u32,
    pub pattern_dark: [f32; 3],
    pub pattern_size: f32,
    pub opacity: f32,
    pub is_blended: u32,
    pub pad0: u32,
    pub pad1: u32,
}

/// Lines and strokes, see the WGSL.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Style {
    pub wire: [f32; 3],
    pub wire_width: f32,
    pub ink: [f32; 3],
    pub hatch_spacing: f32,
    pub paper: [f32; 3],
    pub wire_depth: f32,
    pub outline: [f32; 3],
    pub outline_width: f32,
    pub border: [f32; 3],
    pub border_width: f32,
    pub crease_cosine: f32,
    pub outline_depth: f32,
    pub jump_sine: f32,
    pub pad0: u32,
}

/// How a volume's grid lies and what its values look like, see the WGSL.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Medium {
    pub x_hi: [f32; 3],
    pub x0_hi: f32,
    pub x_lo: [f32; 3],
    pub x0_lo: f32,
    pub y_hi: [f32; 3],
    pub y0_hi: f32,
    pub y_lo: [f32; 3],
    pub y0_lo: f32,
    pub z_hi: [f32; 3],
    pub z0_hi: f32,
    pub z_lo: [f32; 3],
    pub z0_lo: f32,
    pub last: [f32; 3],
    pub layers: u32,
    pub corner_rate: f32,
    pub value_error: f32,
    pub place_error: f32,
    pub headlight: u32,
    pub point: [[f32; 4]; 64],
    pub slope: [[f32; 4]; 64],
    pub value: [[f32; 4]; 64],
}

/// A node of a bounding volume hierarchy: a box around two children, which lie beside each other, or around triangles.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct BvhNode {
    pub lo: [f32; 3],
    /// The first child, or the first triangle.
    pub first: u32,
    pub hi: [f32; 3],
    /// Triangles; 0: it has children.
    pub count: u32,
}

/// A triangle of a leaf: corners relative to the anchor; or a sphere or capsule: its ends in `v0` and `v2`, its radius in the x of `v1`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct LeafTriangle {
    pub v0: [f32; 3],
    pub id: u32,
    pub v1: [f32; 3],
    pub one_sided: u32,
    pub v2: [f32; 3],
    pub is_round: u32,
}

/// How facets reflect or refract rays.
pub const LAW_NORMALS: u32 = 0;
pub const LAW_FLAT: u32 = 1;

/// A camera's optics for one bounce, see the WGSL.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Optic {
    pub eye_hi: [f32; 3],
    pub first_id: u32,
    pub eye_lo: [f32; 3],
    pub count: u32,
    pub tint: [f32; 3],
    pub bounces: u32,
    pub base: [f32; 3],
    pub ends: u32,
    pub ior_hi: f32,
    pub ior_lo: f32,
    pub sees_itself: u32,
    pub piece_first: u32,
    pub tilt_x_hi: f32,
    pub tilt_x_lo: f32,
    pub tilt_y_hi: f32,
    pub tilt_y_lo: f32,
    pub fresnel: u32,
    pub branch: u32,
    pub scale: f32,
    pub colour_only: u32,
    pub from_hi: [f32; 3],
    pub is_environment: u32,
    pub from_lo: [f32; 3],
    pub law: u32,
    pub box_centre: [f32; 3],
    pub scene_size: f32,
    pub box_half: [f32; 3],
    pub pad0: u32,
}

/// Where facets lie in an atlas, see the WGSL.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct AtlasLayout {
    pub side: u32,
    pub columns: u32,
    pub width: u32,
    pub texel_count: u32,
}

/// What lies behind a pixel's ray, see the WGSL.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct PathState {
    pub light: [f32; 3],
    pub length: f32,
    pub first: u32,
    pub last: u32,
    pub piece: u32,
    pub pad0: u32,
}

/// A facet's corner and its normal, each value a sum hi + lo.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Corner {
    pub p_hi: [f32; 3],
    pub piece: u32,
    pub p_lo: [f32; 3],
    pub piece_u: f32,
    pub n_hi: [f32; 3],
    pub piece_v: f32,
    pub n_lo: [f32; 3],
    pub pad0: f32,
}

/// A quadric and the part of it that is there, see the WGSL.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Quadric {
    pub centre_hi: [f32; 3],
    pub c_hi: f32,
    pub centre_lo: [f32; 3],
    pub c_lo: f32,
    pub diagonal_hi: [f32; 3],
    pub low_hi: f32,
    pub diagonal_lo: [f32; 3],
    pub low_lo: f32,
    pub beside_hi: [f32; 3],
    pub high_hi: f32,
    pub beside_lo: [f32; 3],
    pub high_lo: f32,
    pub b_hi: [f32; 3],
    pub rim2_hi: f32,
    pub b_lo: [f32; 3],
    pub rim2_lo: f32,
    pub axis_hi: [f32; 3],
    pub pad0: f32,
    pub axis_lo: [f32; 3],
    pub pad1: f32,
}

/// A torus, see the WGSL.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Torus {
    pub centre_hi: [f32; 3],
    pub size_hi: f32,
    pub centre_lo: [f32; 3],
    pub size_lo: f32,
    pub axis_hi: [f32; 3],
    pub ring_hi: f32,
    pub axis_lo: [f32; 3],
    pub ring_lo: f32,
}

/// A wave, see the WGSL.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Wave {
    pub centre_hi: [f32; 3],
    pub half_hi: f32,
    pub centre_lo: [f32; 3],
    pub half_lo: f32,
    pub amplitude_hi: f32,
    pub amplitude_lo: f32,
    pub frequency_hi: f32,
    pub frequency_lo: f32,
}

/// A chunk of points, and the tree of beams that they are tested against.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Chunk {
    pub points: u32,
    pub beams: u32,
    pub slots: u32,
    pub most: u32,
    pub t_min: f32,
    pub t_max: f32,
    pub pad0: u32,
    pub pad1: u32,
}

/// Bounds of the rays of some part of an image, in preorder, see the WGSL.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Beam {
    pub p_lo: [f32; 3],
    pub next: u32,
    pub p_hi: [f32; 3],
    pub node: u32,
    pub d_lo: [f32; 3],
    pub pad0: u32,
    pub d_hi: [f32; 3],
    pub pad1: u32,
}

/// A chunk of points and the camera whose images of them are sought, see the WGSL.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct SolveParams {
    pub points: u32,
    pub slots: u32,
    pub images_most: u32,
    pub pad0: u32,
    pub t_min: f32,
    pub t_max: f32,
    pub width: u32,
    pub height: u32,
}

/// A piece about its anchor, see the WGSL.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct SolvePiece {
    pub p0: [f32; 3],
    pub flags: u32,
    pub p1: [f32; 3],
    pub h1: f32,
    pub p2: [f32; 3],
    pub h2: f32,
    pub d0: [f32; 3],
    pub half_px: f32,
    pub d1: [f32; 3],
    pub beyond: f32,
    pub d2: [f32; 3],
    pub reach: f32,
    pub anchor_hi: [f32; 3],
    pub base_x: i32,
    pub anchor_lo: [f32; 3],
    pub base_y: i32,
    pub corners_01: [f32; 4],
    pub corners_23: [f32; 4],
    pub edges: [[f32; 4]; 4],
}

/// A cell of a layer of curves: 8 x 8 px and a span of t, see the WGSL.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct SolveCell {
    pub terms: [[f32; 4]; 24],
    pub anchor_hi: [f32; 3],
    pub base_x: i32,
    pub anchor_lo: [f32; 3],
    pub base_y: i32,
    pub errors: [f32; 4],
    pub end: [f32; 2],
    pub size: f32,
    pub flags: u32,
    pub middle: f32,
    pub pad0: u32,
    pub pad1: u32,
    pub pad2: u32,
}

/// A point about the camera's anchor, see the WGSL.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct SolvePoint {
    pub hi: [f32; 3],
    pub is_near: u32,
    pub lo: [f32; 3],
    pub pad0: u32,
}

/// A proven image of a point, see the WGSL.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct SolveImage {
    pub point: u32,
    pub piece: u32,
    pub x_px: f32,
    pub y_px: f32,
    pub t: f32,
    pub error_px: f32,
    pub error_t: f32,
    pub pixel: u32,
}

/// A dispatch of the kernels of gradients, see the WGSL.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct GradientParams {
    pub width: u32,
    pub rows: u32,
    pub first: u32,
    pub pixels: u32,
    pub directions: u32,
    pub pixel_first: u32,
    pub pad0: u32,
    pub pad1: u32,
}

/// A dispatch of deposit.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct DepositParams {
    pub count: u32,
    pub texels: u32,
    pub pad0: u32,
    pub pad1: u32,
}

/// A caustic triangle on a receiver, see the WGSL.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct CausticTriangle {
    pub a: [f32; 2],
    pub b: [f32; 2],
    pub c: [f32; 2],
    pub receiver: u32,
    pub pad0: u32,
    pub flux: [u32; 3],
    pub pad1: u32,
}

/// The map of a receiver, see the WGSL.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Receiver {
    pub columns: u32,
    pub rows: u32,
    pub first: u32,
    pub scale: f32,
}

/// A triangle of the scene in a receiver's plane, see the WGSL.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct ReceiverTriangle {
    pub a: [f32; 2],
    pub ab: [f32; 2],
    pub ac: [f32; 2],
    pub receiver: u32,
    pub pad0: u32,
    pub diffuse: [f32; 3],
    pub pad1: u32,
}

/// `value` as the sum of two f32 with an error of 2^-48 |value| at most.
#[inline]
pub fn split2(value: f64) -> [f32; 2] {
    let hi = value as f32;
    [hi, (value - hi as f64) as f32]
}

/// `value` as the exact sum of three f32 (within f32's exponents); infinities as the largest finite f32.
pub fn split3(value: f64) -> [f32; 4] {
    if value.abs() >= f32::MAX as f64 {
        return [f32::MAX.copysign(value as f32), 0.0, 0.0, 0.0];
    }
    let hi = value as f32;
    let rest = value - hi as f64;
    let mid = rest as f32;
    [hi, mid, (rest - mid as f64) as f32, 0.0]
}

/// Two numbers as f64, low words first, what lies beyond f32 cut off.
pub fn f64_pair_bits(pair: [f64; 2]) -> [u32; 4] {
    let most = f64::from(f32::MAX);
    let [a, b] = pair.map_each(|v| v.clamp(-most, most).to_bits());
    [a as u32, (a >> 32) as u32, b as u32, (b >> 32) as u32]
}

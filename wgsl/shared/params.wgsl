// Structs that the host writes and kernels read, as in src/gpu/layout.rs; tests/wgsl_layout.rs compares the two.

var<uniform> params: Params;
var<uniform> step: Step;
// In a storage buffer, since it changes with every pose: lavapipe compiles a kernel anew whenever the uniforms of its conditions change.
var<storage, read> viewer: ViewerPose;
var<storage, read_write> counters: array<atomic<u32>>;

const GROUP: u32 = 64u;        // threads a workgroup, everywhere
const TILE: u32 = 8u;          // px a side of a tile
const LANES: u32 = 8u;         // threads a subgroup where raster goes tile by tile: a column of the tile each
const BRANCH: u32 = 4u;        // children a side of a node
const CLUSTER: u32 = 64u;      // triangles a cluster at most
const TRIANGLE_GROUP: u32 = 8u;         // triangles a triangle group, of which a cluster has eight
const TEXELS_A_ROW: u32 = 4096u;        // of textures that hold tables
const NONE: u32 = 0xffffffffu;
const PROVEN: u32 = 0x80000000u;   // an item for recheck whose triangle is proven to cover the pixel: beside its slot

// Indices into `counters`. Queues of the cull steps come first.
const COUNT_WORK: u32 = 8u;
const COUNT_PAIRS: u32 = 9u;
const COUNT_PAIRS_KEPT: u32 = 10u;
const COUNT_FRAGMENTS_TESTED: u32 = 11u;
const COUNT_FRAGMENTS_KEPT: u32 = 12u;
const COUNT_RECHECK_ITEMS: u32 = 13u;
const COUNT_PROVEN: u32 = 14u;        // those of these that are proven to be nearest
const COUNT_BUSY: u32 = 15u;
const COUNT_BUSY_FIRST: u32 = 16u;     // of the busy tiles that raster takes in this step
const COUNT_BUSY_END: u32 = 17u;       // behind the last of them
const COUNT_PAIRS_TESTED: u32 = 18u;
const COUNT_TASKS: u32 = 19u;
const COUNT_LARGE: u32 = 20u;
const COUNT_SORTED: u32 = 21u;         // pairs in runs of tiles
const COUNT_TRACED: u32 = 22u;         // pixels that trace takes over
const COUNT_UNFINISHED: u32 = 23u;     // pixels whose paths were longer than trace follows
// These stay while pairs are listed anew, and so are the last.
const COUNT_EDGES: u32 = 24u;          // edge pixels
const COUNT_BLOCKS: u32 = 25u;         // of strips of four of their samples
const COUNT_RECHECK_SAMPLES: u32 = 26u;
const COUNTERS: u32 = 27u;

// What things cost, in tenths of a microsecond on a software adapter beside other work; only their ratios count.
const CULL_COST: u32 = 60u;            // an item of cull's queue
const TASK_COST: u32 = 60u;            // a triangle group for bin
const LARGE_COST: u32 = 4u;            // a triangle that small leaves to it
const PAIR_COST: u32 = 3u;

// One band of the image and one batch of clusters.
struct Params {
    width: u32,             // px of the band
    height: u32,
    tiles_x: u32,
    tiles_y: u32,           // of all slabs
    levels: u32,            // levels of nodes; level 0 are the tiles
    cluster_first: u32,     // of the batch
    cluster_count: u32,
    id_bits: u32,           // low bits of a visibility key that hold the triangle id
    queue_capacity: u32,    // items
    work_capacity: u32,
    pair_capacity: u32,
    slab_rows: u32,        // tile rows from one slab to the next
    id_first: u32,          // of the chunk of triangles that is bound
    id_count: u32,
    band_row: u32,          // image row of the band's first row
    spans: u32,             // slabs a layer
    recheck_capacity: u32,    // items
    origin_error: f32,      // error bound of rays' origins as stored
    task_capacity: u32,
    edge_capacity: u32,     // items
    scene_size: f32,        // by which rays are perturbed (perturb.wgsl); 0 for rays that are not
    raster_budget: f32,     // what raster may still cost before trace takes over
    steps: u32,             // time steps of each vertex
    sample: u32,            // the number of samples, and in the upper half the number of this one; 0: rays through pixel centers
    t_min: vec4<f32>,       // ends of t_range, each the exact sum of three
    t_max: vec4<f32>,
    t_words: vec4<u32>,     // both as f64, low words first
    level_start: array<vec4<u32>, 2>,   // of level k: index of its first node
    level_width: array<vec4<u32>, 2>,   // nodes a row
    level_height: array<vec4<u32>, 2>,  // rows
    bvh_offset: vec3<f32>,  // from the origin of the hierarchies that trace follows to the anchor, exact
    surface_rows: u32,      // rows a triangle in a table of surfaces without texture coordinates: 1; 0 if all share the only row
}

// A perturbation (perturb.wgsl) moves origins by at most 2^-42 of the scene's size, and directions by 2^-42 of their own. This is twice
// that, for sums of components instead of lengths.
const PERTURB_BOUND: f32 = 1.0 / 2199023255552.0;

// A hit is moved to an end of t_range (plane_tolerance.wgsl) by at most 2^-32 of the scene's size. This is twice that: of s = t |d| with |d| >= 1/2,
// or for rounding.
const END_BOUND: f32 = 1.0 / 2147483648.0;

// Offsets of samples from their pixel's centre, px right and down: two per vec4.
struct SampleOffsets {
    at: array<vec4<f32>, 16>,
}

// An eye relative to the anchor, and the axes to the right, up and forward: twelve f64, two a vec4, low words first; and the same in f32.
struct ViewerPose {
    numbers: array<vec4<u32>, 6>,
    eye: vec3<f32>,
    ray_count: u32,
    right: vec3<f32>,
    numbers_a_ray: u32,     // of the lens: 3, a direction; or 6, an origin relative to the eye and a direction
    up: vec3<f32>,
    node_count: u32,
    forward: vec3<f32>,
    perturb: f32,           // how far perturbations move origins at most
}

// Which dispatch of a kernel this is.
struct Step {
    value: u32,
}

// Up to CLUSTER triangles near each other, and their box; or those of a triangle group.
struct Cluster {
    centre: vec3<f32>,
    first: u32,             // slot of the first triangle
    half: vec3<f32>,
    count: u32,
}

const RAYS_NONE: u32 = 0u;     // no ray in the square
const RAYS_LOOSE: u32 = 1u;    // several pieces, or rays that are not affine
const RAYS_AFFINE: u32 = 2u;   // one affine bundle
const RAYS_DISCONTINUOUS: u32 = 3u;     // so far from affine that what lies below bounds them much better

const LEVEL_CELL: u32 = 15u;   // of a cell in the address of a node

// The rays of one square of the image: for (x, y) in [-1, 1]^2 over the square, P = p + x px + y py up to a
// distance r_p, D = d + x dx + y dy up to r_d.
struct Node {
    p: vec3<f32>,
    r_p: f32,
    px: vec3<f32>,
    r_d: f32,
    py: vec3<f32>,
    rays: u32,              // one of the RAYS constants
    d: vec3<f32>,
    width: f32,             // for fit alone: how wide bundles are that cull hands on; 0 where the host wrote the node
    dx: vec3<f32>,
    piece: u32,             // that owns all pixels of the square; NONE: there is none
    dy: vec3<f32>,
    pad2: f32,
}

// The pixels of one tile that one piece owns, or a part of a discontinuous tile of a field; the piece's bundle at the tile's centre.
struct Cell {
    p: vec3<f32>,
    h: f32,
    d: vec3<f32>,
    piece: u32,
    tile: u32,
    mask_lo: u32,           // bit 8 y + x: the piece owns pixel (x, y) of the tile; rows 0 to 3
    mask_hi: u32,           // rows 4 to 7
    node: u32,              // that bounds its rays: its tile's where it has the tile alone
}

// A piece's bundle about `origin` (band pixels): each value is the exact-as-stored sum hi + lo.
struct Piece {
    p_hi: vec3<f32>,
    h_hi: f32,
    px_hi: vec3<f32>,
    hx_hi: f32,
    py_hi: vec3<f32>,
    hy_hi: f32,
    d_hi: vec3<f32>,
    origin_x: f32,
    dx_hi: vec3<f32>,
    origin_y: f32,
    dy_hi: vec3<f32>,
    number: u32,            // in the camera
    p_lo: vec3<f32>,
    h_lo: f32,
    px_lo: vec3<f32>,
    hx_lo: f32,
    py_lo: vec3<f32>,
    hy_lo: f32,
    d_lo: vec3<f32>,
    pad1: f32,
    dx_lo: vec3<f32>,
    pad2: f32,
    dy_lo: vec3<f32>,
    pad3: f32,
}

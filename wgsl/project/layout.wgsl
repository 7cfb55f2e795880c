// Structs of `solve`, `claim` and `contend`, as in src/gpu/layout.rs; tests/wgsl_layout.rs compares the two.

var<uniform> solving: SolveParams;

// A chunk of points, and the camera whose images of them are sought.
struct SolveParams {
    points: u32,
    slots: u32,             // of a point's list of candidates
    images_most: u32,       // that fit the list
    pad0: u32,
    t_min: f32,             // ends of t_range; beyond ENDLESS: none
    t_max: f32,
    width: u32,             // px
    height: u32,
}

// A piece `p + t d = X h`, all affine in its place (u, v): px from `base`, in units of `half_px`; h is 1 at (0, 0). Lengths are in the
// camera's unit; p and X about the piece's anchor.
struct SolvePiece {
    p0: vec3<f32>,
    flags: u32,             // SOLVABLE | ALONE
    p1: vec3<f32>,
    h1: f32,
    p2: vec3<f32>,
    h2: f32,
    d0: vec3<f32>,
    half_px: f32,
    d1: vec3<f32>,
    beyond: f32,            // how far beyond the piece's border a place may be that the host takes for one in it
    d2: vec3<f32>,
    reach: f32,             // largest |u| and |v| of a corner
    anchor_hi: vec3<f32>,
    base_x: i32,            // px, whole
    anchor_lo: vec3<f32>,
    base_y: i32,
    corners_01: vec4<f32>,  // (u, v), moved outwards by `beyond` and more; three, or four
    corners_23: vec4<f32>,
    edges: array<vec4<f32>, 4>, // x u + y v + z is the distance inwards from an edge
}

// The curves of 8 x 8 px over a span of t: X is the sum of cubics in s times 1, u, v, u v, u^2 and v^2, and a rest; (u, v) in units of 4 px
// from `base`, s in units of half the span from its middle. Lengths are in the camera's unit; X about the cell's anchor.
struct SolveCell {
    terms: array<vec4<f32>, 24>, // of each cubic those of s^0 to s^3
    anchor_hi: vec3<f32>,
    base_x: i32,            // px
    anchor_lo: vec3<f32>,
    base_y: i32,
    errors: vec4<f32>,      // bounds of the rest's magnitude, and of its derivatives by u, v and s
    end: vec2<f32>,         // greatest u and v: the image's border or 1
    size: f32,              // bound of the magnitude of all terms together
    flags: u32,             // SOLVABLE | OUTER << axis | OUTER << (3 + axis)
    middle: f32,            // t at s = 0
    pad0: u32,
    pad1: u32,
    pad2: u32,
}

// A point about the camera's anchor, in its unit: the sum of two.
struct SolvePoint {
    hi: vec3<f32>,
    is_near: u32,           // 0: too far away for f32
    lo: vec3<f32>,
    pad0: u32,
}

// A proven image: the only one within its bounds.
struct SolveImage {
    point: u32,             // of the chunk
    piece: u32,             // or cell
    x_px: f32,              // about its base
    y_px: f32,
    t: f32,
    error_px: f32,          // of x and of y
    error_t: f32,
    pixel: u32,             // its number; NONE: a border of a pixel is within the bounds
}

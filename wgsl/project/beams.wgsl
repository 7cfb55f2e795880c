// Structs of `sift`, as in src/gpu/layout.rs; tests/wgsl_layout.rs compares the two.

// A chunk of points, and the tree of beams that they are tested against.
struct Chunk {
    points: u32,
    beams: u32,             // nodes of the tree
    slots: u32,             // of a point's list
    most: u32,              // at least `slots`: beyond it nobody counts
    t_min: f32,             // ends of t_range, in the tree's units
    t_max: f32,
    pad0: u32,
    pad1: u32,
}

// Bounds of the rays P + t D of some part of an image, rounded outwards. Lengths are about the tree's anchor and in its
// units: origins and directions at most 1, but for beams of any ray; no end but 0 is nearer to 0 than 2^-60.
struct Beam {
    p_lo: vec3<f32>,
    next: u32,              // the first node after those below this one
    p_hi: vec3<f32>,
    node: u32,              // of the tree, for the list; NONE: what is below is looked at
    d_lo: vec3<f32>,
    pad0: u32,
    d_hi: vec3<f32>,
    pad1: u32,
}

// Structs of caustics, as in src/gpu/layout.rs; tests/wgsl_layout.rs compares the two.

// A dispatch of deposit.
struct DepositParams {
    count: u32,             // caustic triangles
    texels: u32,            // of all receivers; behind their sums are those of what missed, and a count of lines
    pad0: u32,
    pad1: u32,
}

// A caustic triangle on a receiver.
struct CausticTriangle {
    a: vec2<f32>,           // corners, texels
    b: vec2<f32>,
    c: vec2<f32>,
    receiver: u32,
    pad0: u32,
    flux: vec3<u32>,        // units, linear RGB
    pad1: u32,
}

// The map of a receiver.
struct Receiver {
    columns: u32,           // texels
    rows: u32,
    first: u32,             // texel, among those of all receivers
    scale: f32,             // of a unit: the radiance of a white surface whose texel receives it
}

// A triangle of the scene in a receiver's plane.
struct ReceiverTriangle {
    a: vec2<f32>,           // its first corner, texels
    ab: vec2<f32>,          // from there to the others
    ac: vec2<f32>,
    receiver: u32,
    pad0: u32,
    diffuse: vec3<f32>,
    pad1: u32,
}

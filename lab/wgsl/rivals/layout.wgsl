// Structs of the rivals. src/rivals/layout.rs has the same ones; tests/wgsl_layout.rs compares them.

var<uniform> cube: Cube;
var<storage, read> outlines: array<Outline>;

// Corners of a piece in pixels of the image. A piece of the whole image has a triangle that holds all of it.
struct Outline {
    a: vec2<f32>,
    b: vec2<f32>,
    c: vec2<f32>,
    is_whole: u32,
    layer: u32,
}

// Where a cube map, or one ordinary picture, is taken, and how fine.
struct Cube {
    eye: vec3<f32>,         // relative to the anchor
    side: u32,              // texels of a face
    right: vec3<f32>,       // of the one picture: dot products with these are [-1, 1] times that with forward
    pad0: u32,
    up: vec3<f32>,
    pad1: u32,
    forward: vec3<f32>,
    pad2: u32,
}

// What a pair of passes by the texture S is over.
struct Splat {
    side: u32,              // of S, texels
    first: u32,             // (piece, slot) pair of the first cell: slots of one piece after the other
    slots: u32,
    pad0: u32,
}

// The cone of all that perspective pieces which lie together see.
struct Cone {
    eye: vec3<f32>,         // relative to the anchor
    first: u32,             // piece
    axis: vec3<f32>,        // unit
    count: u32,             // pieces
    angle: f32,             // from the axis to the cone's side, radians; from pi on everything is in it
    pad0: u32,
    pad1: u32,
    pad2: u32,
}

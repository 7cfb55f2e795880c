// The edges of a triangle against four rays at once.

// Rounding of one f32 operation, relative.
const UNIT: f32 = 1.0 / 16777216.0;

// Relative error of a stored position: 8 units of 2^-48.
const STORED_UNIT: f32 = 1.0 / 35184372088832.0;

// Directions of four pixels' rays, of size 1, and their cross products with the origins, to f32.
struct Lines {
    dx: vec4<f32>,
    dy: vec4<f32>,
    dz: vec4<f32>,
    qx: vec4<f32>,
    qy: vec4<f32>,
    qz: vec4<f32>,
}

fn size(v: vec3<f32>) -> f32 {
    return abs(v.x) + abs(v.y) + abs(v.z);
}

// An edge over a tile: E = d . c - e . q of a line (d, q), in units of what rounding may be off.
struct Edge {
    c: vec3<f32>,
    e: vec3<f32>,
}

fn along(edge: Edge, l: Lines) -> vec4<f32> {
    return (edge.c.x * l.dx + edge.c.y * l.dy + edge.c.z * l.dz) - (edge.e.x * l.qx + edge.e.y * l.qy + edge.e.z * l.qz);
}

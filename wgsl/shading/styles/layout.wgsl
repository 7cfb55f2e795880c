// Lines and strokes.

var<uniform> style: Style;

struct Style {
    wire: vec3<f32>,        // colour of the triangles' edges
    wire_width: f32,        // px; 0: none
    ink: vec3<f32>,
    hatch_spacing: f32,     // px; 0: no strokes
    paper: vec3<f32>,
    wire_depth: f32,        // beyond which they grow narrower as what is there grows smaller
    outline: vec3<f32>,
    outline_width: f32,     // px
    border: vec3<f32>,      // of the camera's pieces
    border_width: f32,      // px
    crease_cosine: f32,     // of normals that differ more, an edge is a crease
    outline_depth: f32,
    jump_sine: f32,         // by which a step leaves a surface at least that does not go on
    pad0: u32,
}

// How wide a line is at a depth, that is whole up to its own.
fn narrowed(width: f32, depth: f32, z: f32) -> f32 {
    return width * select(1.0, depth / z, z > depth);
}

// How much of a box a line of a width covers whose middle is so far from its own, px.
fn covered(distance: f32, width: f32, box: f32) -> f32 {
    return clamp(min(distance + 0.5 * box, 0.5 * width) - max(distance - 0.5 * box, -0.5 * width), 0.0, box) / box;
}

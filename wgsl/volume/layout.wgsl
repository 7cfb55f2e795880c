// What kernels know of a volume, as in src/gpu/layout.rs; tests/wgsl_layout.rs compares the two.

var<uniform> medium: Medium;

// How the grid lies and what its values look like. Grid coordinates are whole numbers from 0 on at the nodes.
struct Medium {
    x_hi: vec3<f32>,        // from the anchor to grid coordinates: the rows of a matrix and what is added, each value a sum hi + lo
    x0_hi: f32,
    x_lo: vec3<f32>,
    x0_lo: f32,
    y_hi: vec3<f32>,
    y0_hi: f32,
    y_lo: vec3<f32>,
    y0_lo: f32,
    z_hi: vec3<f32>,
    z0_hi: f32,
    z_lo: vec3<f32>,
    z0_lo: f32,
    last: vec3<f32>,        // grid coordinates of the last node
    layers: u32,            // of the camera
    corner_rate: f32,       // error of the optical depth that a corner of the transfer function may make, per world unit
    value_error: f32,       // of the largest value
    place_error: f32,       // how far from a curve its legs may lie, world units
    headlight: u32,         // 1: light comes along the ray
    point: array<vec4<f32>, 64>,    // colour and extinction at a control point; the first is what lies before them
    slope: array<vec4<f32>, 64>,    // their changes with the value up to the next one
    value: array<vec4<f32>, 64>,    // value, that of the next one, the largest slope of a colour, and that of the extinction
}

// Structs of cameras with a mirror or a lens, as in src/gpu/layout.rs; tests/wgsl_layout.rs compares the two.

var<uniform> optic: Optic;
var<storage, read> paths: array<PathState>;

const LAW_NORMALS: u32 = 0u;   // rays bounce about the corners' normals, interpolated
const LAW_FLAT: u32 = 1u;      // the corners' bounced rays are interpolated

// The optics for one bounce.
struct Optic {
    eye_hi: vec3<f32>,      // what flat facets are seen from, relative to the anchor
    first_id: u32,          // of the surfaces: facets are triangles, smooth surfaces have ids behind all of these
    eye_lo: vec3<f32>,
    count: u32,             // surfaces
    tint: vec3<f32>,        // factor of the light per bounce
    bounces: u32,           // how often these rays have bounced
    base: vec3<f32>,        // colour of the surface where rays end on it
    ends: u32,              // 1: rays end on it, after the last bounce
    ior_hi: f32,            // index of refraction inside; 0: rays are reflected
    ior_lo: f32,
    sees_itself: u32,       // 1: bounced rays may meet the surface again
    piece_first: u32,       // number of surface 0 among the camera's pieces
    tilt_x_hi: f32,         // tilt of the normals where these rays start
    tilt_x_lo: f32,
    tilt_y_hi: f32,
    tilt_y_lo: f32,
    fresnel: u32,           // 1: light is shared out between refraction and reflection
    branch: u32,            // 0: refracted, or totally reflected; 1: the other part of the light
    scale: f32,             // of the light, where these rays start
    colour_only: u32,       // 1: another bounce writes the ids and depth
    from_hi: vec3<f32>,     // origin of bounced rays, if is_environment
    is_environment: u32,    // 1: they start there, as in an environment map; 0: at the bounce
    from_lo: vec3<f32>,
    law: u32,               // one of the LAW constants
    box_centre: vec3<f32>,  // around the surface, relative to the anchor
    scene_size: f32,        // widths of bundles are compared at this distance along their rays
    box_half: vec3<f32>,
    pad0: u32,
}

// Where facets lie in an atlas: two a square cell.
struct AtlasLayout {
    side: u32,              // of a cell, texels
    columns: u32,           // of cells
    width: u32,             // texels
    texel_count: u32,
}

// What happened to a pixel's ray at earlier bounces.
struct PathState {
    light: vec3<f32>,       // factor of the colour that the ray sees
    length: f32,            // summed over the earlier rays, world units
    first: u32,             // surface that was met first; NONE before any
    last: u32,              // id of the surface that the ray starts on; NONE: the eye, or no bounce
    piece: u32,             // of the surface that was met first
    pad0: u32,
}

// A facet's corner, relative to the anchor, and its unit normal, each value a sum hi + lo.
struct Corner {
    p_hi: vec3<f32>,
    piece: u32,             // of the facet: which of the optics' pieces it belongs to
    p_lo: vec3<f32>,
    piece_u: f32,          // where on that facet the corner lies: weight of its second corner,
    n_hi: vec3<f32>,
    piece_v: f32,          // and of its third
    n_lo: vec3<f32>,
    pad0: f32,
}

// q A q + 2 b q + c = 0 for q from the centre, A by its diagonal and what is beside it (yz, xz, xy); within the square
// of the rim from the axis, and from `low` to `high` along it. Each value a sum hi + lo.
struct Quadric {
    centre_hi: vec3<f32>,
    c_hi: f32,
    centre_lo: vec3<f32>,
    c_lo: f32,
    diagonal_hi: vec3<f32>,
    low_hi: f32,
    diagonal_lo: vec3<f32>,
    low_lo: f32,
    beside_hi: vec3<f32>,
    high_hi: f32,
    beside_lo: vec3<f32>,
    high_lo: f32,
    b_hi: vec3<f32>,
    rim2_hi: f32,
    b_lo: vec3<f32>,
    rim2_lo: f32,
    axis_hi: vec3<f32>,
    pad0: f32,
    axis_lo: vec3<f32>,
    pad1: f32,
}

// (|q|^2 + ring^2 - (1 - ring)^2)^2 = 4 ring^2 r^2 for q from the centre in units of the size, r from the axis: the radius
// of the torus over its size, which is that of the ball around it. Each value a sum hi + lo.
struct Torus {
    centre_hi: vec3<f32>,
    size_hi: f32,
    centre_lo: vec3<f32>,
    size_lo: f32,
    axis_hi: vec3<f32>,
    ring_hi: f32,
    axis_lo: vec3<f32>,
    ring_lo: f32,
}

// y = amplitude sin(2 pi frequency x) sin(2 pi frequency z) from the centre, for x and z up to `half`. Each value a sum
// hi + lo.
struct Wave {
    centre_hi: vec3<f32>,
    half_hi: f32,
    centre_lo: vec3<f32>,
    half_lo: f32,
    amplitude_hi: f32,
    amplitude_lo: f32,
    frequency_hi: f32,
    frequency_lo: f32,
}

// Triangles, and vertices that move: of each the table has the positions at all time steps. A thread's pixel has a moment, at which it sees
// them: between two steps they move straight.

#import shared/params.wgsl
#import shared/table.wgsl

var<storage, read> moments: array<u32>;
var triangles: texture_2d<u32>;
var vertices: texture_2d<u32>;

// The step before the moment, and the share of the way to the next.
var<private> moment_step: u32;
var<private> moment_share: f32;

// Errors of a coordinate, in units of the largest: 1 as stored, 2 for a difference, 2 for its share, 1 for a sum.
const CORNER_UNITS: f32 = 6.0;

// Takes the moment of a pixel of the band, at which all that follows sees the scene. Its word: 8 bits and 24.
fn take_moment(pixel: u32) {
    let word = moments[pixel];
    moment_step = word >> 24u;
    moment_share = f32(word & 0xffffffu) / 16777216.0;
}

// The step after the moment; after the last one nothing moves.
fn next_step() -> u32 {
    return min(moment_step + 1u, params.steps - 1u);
}

// The size of numbers that a corner is computed from, of a corner so far away. No coordinate of any step is larger than the scene.
fn corner_reach(reach: f32) -> f32 {
    return CORNER_UNITS * max(reach, params.scene_size);
}

// A mesh stands in one place.
fn is_mirrored() -> bool {
    return false;
}

fn own_slot(slot: u32) -> u32 {
    return slot;
}

// The packed triangle of a slot.
fn triangle_at(slot: u32) -> vec4<u32> {
    return textureLoad(triangles, table_texel(slot), 0);
}

// A vertex as stored at a step, rounded to f32.
fn vertex_at_step(index: u32, step: u32) -> vec3<f32> {
    return bitcast<vec3<f32>>(textureLoad(vertices, table_texel(2u * (index * params.steps + step)), 0).xyz);
}

// What that leaves.
fn vertex_lo_at_step(index: u32, step: u32) -> vec3<f32> {
    let row = 2u * (index * params.steps + step);
    let first = textureLoad(vertices, table_texel(row), 0).w;
    let more = textureLoad(vertices, table_texel(row + 1u), 0).xy;
    return bitcast<vec3<f32>>(vec3<u32>(first, more));
}

// A vertex at the moment.
fn vertex(index: u32) -> vec3<f32> {
    let from_step = vertex_at_step(index, moment_step);
    return from_step + moment_share * (vertex_at_step(index, next_step()) - from_step);
}

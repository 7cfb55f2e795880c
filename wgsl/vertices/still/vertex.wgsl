// Triangles, and vertices relative to the anchor, in two words.

#import shared/table.wgsl

var triangles: texture_2d<u32>;
var vertices: texture_2d<u32>;

// Errors of a coordinate as stored, in units of the largest.
const CORNER_UNITS: f32 = 1.0;

// All pixels see the scene at the same time.
fn take_moment(pixel: u32) {}

// The size of numbers that a corner is computed from, of a corner so far away.
fn corner_reach(reach: f32) -> f32 {
    return reach;
}

// A mesh stands in one place: its slots and ids are those of the tables.
fn slots_before() -> u32 {
    return 0u;
}

fn ids_before() -> u32 {
    return 0u;
}

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

// Rounded to f32.
fn vertex(index: u32) -> vec3<f32> {
    return bitcast<vec3<f32>>(textureLoad(vertices, table_texel(2u * index), 0).xyz);
}

// What that leaves.
fn vertex_lo(index: u32) -> vec3<f32> {
    let first = textureLoad(vertices, table_texel(2u * index), 0).w;
    let more = textureLoad(vertices, table_texel(2u * index + 1u), 0).xy;
    return bitcast<vec3<f32>>(vec3<u32>(first, more));
}

// Values along a ray, of a grid that holds nothing else.

#import volume/cubic.wgsl
#import volume/layout.wgsl

var<storage, read> voxels: array<f32>;

// Along a straight way through a cell, from 0 to 1: Bernstein coefficients.
struct Stretch {
    value: vec4<f32>,
}

fn corners(at: u32, row: u32, slice: u32) -> vec4<f32> {
    return vec4<f32>(voxels[at], voxels[at + row], voxels[at + slice], voxels[at + slice + row]);
}

// From one place of a cell to another, along a unit vector.
fn stretch_in(cell: vec3<i32>, a: vec3<f32>, b: vec3<f32>, direction: vec3<f32>) -> Stretch {
    let row = u32(medium.last.x) + 1u;
    let slice = row * (u32(medium.last.y) + 1u);
    let at = u32(cell.z) * slice + u32(cell.y) * row + u32(cell.x);
    return Stretch(along(corners(at, row, slice), corners(at + 1u, row, slice), a, b));
}

fn stretch_part(stretch: Stretch, start: f32, end: f32) -> Stretch {
    return Stretch(part_of(stretch.value, start, end));
}

// Bound of four times the error of the colour as a share of what is absorbed, where colours lie in a range and the optical depth is no more
// than this.
fn colour_error(stretch: Stretch, range: f32, depth: f32) -> f32 {
    return range * depth;
}

// The colour that a stretch shows, from the transfer function's.
fn colour_of(stretch: Stretch, extinctions: vec4<f32>, extinction: f32, colour: vec3<f32>) -> vec3<f32> {
    return colour;
}

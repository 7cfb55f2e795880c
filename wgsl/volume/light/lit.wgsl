// Values and light along a ray, of a grid that holds both.

#import volume/cubic.wgsl
#import volume/layout.wgsl

var<storage, read> voxels: array<vec4<f32>>;

// Along a straight way through a cell, from 0 to 1: Bernstein coefficients of the value, and of the factors of the colour.
struct Stretch {
    value: vec4<f32>,
    r: vec4<f32>,
    g: vec4<f32>,
    b: vec4<f32>,
}

const AMBIENT: f32 = 0.1;

// A node's value, and the factors of its colour: by its light, or by its normal in a headlight along a unit vector.
fn node(at: u32, direction: vec3<f32>) -> vec4<f32> {
    let own = voxels[at];
    let along_it = AMBIENT + (1.0 - AMBIENT) * abs(dot(own.yzw, direction));
    let factor = select(along_it, 1.0, all(own.yzw == vec3<f32>(0.0)));
    return select(own, vec4<f32>(own.x, vec3<f32>(factor)), medium.headlight == 1u);
}

// From one place of a cell to another, along a unit vector.
fn stretch_in(cell: vec3<i32>, a: vec3<f32>, b: vec3<f32>, direction: vec3<f32>) -> Stretch {
    let row = u32(medium.last.x) + 1u;
    let slice = row * (u32(medium.last.y) + 1u);
    let at = u32(cell.z) * slice + u32(cell.y) * row + u32(cell.x);
    let lo = transpose(mat4x4<f32>(
        node(at, direction), node(at + row, direction), node(at + slice, direction), node(at + slice + row, direction),
    ));
    let hi = transpose(mat4x4<f32>(
        node(at + 1u, direction), node(at + row + 1u, direction), node(at + slice + 1u, direction), node(at + slice + row + 1u, direction),
    ));
    return Stretch(along(lo[0], hi[0], a, b), along(lo[1], hi[1], a, b), along(lo[2], hi[2], a, b), along(lo[3], hi[3], a, b));
}

fn stretch_part(stretch: Stretch, start: f32, end: f32) -> Stretch {
    return Stretch(
        part_of(stretch.value, start, end), part_of(stretch.r, start, end), part_of(stretch.g, start, end), part_of(stretch.b, start, end),
    );
}

// Bound of four times the error of the colour as a share of what is absorbed, where the transfer function's colours lie in a range and the
// optical depth is no more than this. Those lie in [0, 1].
fn colour_error(stretch: Stretch, range: f32, depth: f32) -> f32 {
    let highest = max(most(stretch.r), max(most(stretch.g), most(stretch.b)));
    let lit_range = max(most(stretch.r) - least(stretch.r), max(most(stretch.g) - least(stretch.g), most(stretch.b) - least(stretch.b)));
    return (range * highest + lit_range) * depth + range * lit_range;
}

// The colour that a stretch shows, from the transfer function's: times the mean factor over what is absorbed.
fn colour_of(stretch: Stretch, extinctions: vec4<f32>, extinction: f32, colour: vec3<f32>) -> vec3<f32> {
    let factor = vec3<f32>(inner(stretch.r, extinctions), inner(stretch.g, extinctions), inner(stretch.b, extinctions));
    return colour * factor / extinction;
}

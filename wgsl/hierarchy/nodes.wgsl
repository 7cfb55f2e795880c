// The bounding volume hierarchy of a chunk's triangles, in textures. Coordinates are scaled by a power of two so that none is larger than 1.
// `bvh`: a row with that power, then five rows a node, as the crate obvhs packs them (Ylitie et al. 2017): the origin of a grid, the
// exponents of its steps, and a bit for each child that is a node; the indices of the first node and the first triangle below, and a byte a
// child; then for each axis the lower bounds of the eight children on the grid, a byte each, and the upper ones.

#import rays/stretch
#import shared/table.wgsl

var bvh: texture_2d<u32>;

// What a path may meet below a node: a group (see followed), and triangles, bit k for the k-th from first_triangle on.
struct Met {
    nodes: vec2<u32>,
    first_triangle: u32,
    triangles: u32,
}

fn bvh_row(k: u32) -> vec4<u32> {
    return textureLoad(bvh, table_texel(k), 0);
}

fn bvh_scale() -> f32 {
    return bitcast<f32>(bvh_row(0u).x);
}

const BYTES: vec4<u32> = vec4<u32>(0u, 8u, 16u, 24u);

fn bytes_of(word: u32) -> vec4<f32> {
    return vec4<f32>((vec4<u32>(word) >> BYTES) & vec4<u32>(0xffu));
}

// Along one axis: where a path enters and leaves a slab, s = grid * step + place.
struct Axis {
    step: f32,
    enters: f32,
    leaves: f32,
}

fn axis_of(exponent: u32, origin: f32, p: f32, slack: f32, inverse: f32) -> Axis {
    let place = (origin - p) * inverse;
    let more = slack * abs(inverse);
    return Axis(bitcast<f32>((exponent & 0xffu) << 23u) * inverse, place - more, place + more);
}

// Which of four boxes a path may meet. A comparison with NaN leaves no box out.
fn four_hits(lo: vec3<u32>, hi: vec3<u32>, x: Axis, y: Axis, z: Axis, back: vec3<bool>, first: f32, last: f32) -> vec4<bool> {
    let near = select(lo, hi, back);
    let far = select(hi, lo, back);
    let enters = max(
        max(bytes_of(near.x) * x.step + x.enters, bytes_of(near.y) * y.step + y.enters),
        max(bytes_of(near.z) * z.step + z.enters, vec4<f32>(first)),
    );
    let leaves = min(
        min(bytes_of(far.x) * x.step + x.leaves, bytes_of(far.y) * y.step + y.leaves),
        min(bytes_of(far.z) * z.step + z.leaves, vec4<f32>(last)),
    );
    return !(enters > leaves);
}

// The bits that four children set: a node one, in the high byte, higher if it is nearer; a leaf one for each of its triangles.
fn bits_of(word: u32, octant: u32, hits: vec4<bool>) -> u32 {
    let is_node = ((word & (word << 1u)) & 0x10101010u) >> 4u;
    let places = ((word ^ (octant * is_node)) & 0x1f1f1f1fu);
    let ones = (word >> 5u) & 0x07070707u;
    let bits = ((vec4<u32>(ones) >> BYTES) & vec4<u32>(7u)) << ((vec4<u32>(places) >> BYTES) & vec4<u32>(31u));
    let met = select(vec4<u32>(0u), bits, hits);
    return met.x | met.y | met.z | met.w;
}

fn box_hits(node: u32, stretch: Stretch, inverse: vec3<f32>, octant: u32, last: f32) -> Met {
    let row = 1u + 5u * node;
    let grid = bvh_row(row);
    let below = bvh_row(row + 1u);
    let along_x = bvh_row(row + 2u);
    let along_y = bvh_row(row + 3u);
    let along_z = bvh_row(row + 4u);
    let origin = bitcast<vec3<f32>>(grid.xyz);
    let x = axis_of(grid.w, origin.x, stretch.p.x, stretch.slack.x, inverse.x);
    let y = axis_of(grid.w >> 8u, origin.y, stretch.p.y, stretch.slack.y, inverse.y);
    let z = axis_of(grid.w >> 16u, origin.z, stretch.p.z, stretch.slack.z, inverse.z);
    let back = inverse < vec3<f32>(0.0);
    let one = four_hits(
        vec3<u32>(along_x.x, along_y.x, along_z.x), vec3<u32>(along_x.z, along_y.z, along_z.z), x, y, z, back, stretch.first, last,
    );
    let other = four_hits(
        vec3<u32>(along_x.y, along_y.y, along_z.y), vec3<u32>(along_x.w, along_y.w, along_z.w), x, y, z, back, stretch.first, last,
    );
    let hits = bits_of(below.z, octant, one) | bits_of(below.w, octant, other);
    return Met(vec2<u32>(below.x, (hits & 0xff000000u) | (grid.w >> 24u)), below.y, hits & 0xffffffu);
}

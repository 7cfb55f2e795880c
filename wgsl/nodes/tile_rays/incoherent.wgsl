// Incoherent rays: each ray of a tile is tested by itself.

#import rays/field/table.wgsl
#import shared/params.wgsl

// Relative error in f32 of a ray's and a box's numbers, their sums, products and quotient, and differences between rays: 16 roundings.
const RAY_TOLERANCE: f32 = 1.0 / 1048576.0;

// Stands for an infinite t.
const FARTHEST_T: f32 = 3.4e38;

fn largest_of(v: vec3<f32>) -> f32 {
    return max(v.x, max(v.y, v.z));
}

// A pixel's ray may meet a box. Never false for a ray that meets it, nor for one that differs from such a ray by RAY_TOLERANCE of the
// node's spread.
fn ray_meets(at: u32, node: Node, centre: vec3<f32>, half: vec3<f32>) -> bool {
    let p = field_origin(at);
    let d = field_direction(at);
    let size = abs(d);
    let q = centre - p;
    let extent_p = vec3<f32>(node.r_p) + abs(node.px) + abs(node.py);
    var r = half + vec3<f32>(params.origin_error + END_BOUND * params.scene_size) + RAY_TOLERANCE * (abs(p) + abs(centre) + abs(q) + half + extent_p);
    // where they meet, t times the largest component of the direction is at most the distance to the box's far side
    let extent_d = vec3<f32>(node.r_d) + abs(node.dx) + abs(node.dy);
    r += RAY_TOLERANCE * (largest_of(abs(q)) + largest_of(r)) / largest_of(size) * extent_d;
    let is_flat = size == vec3<f32>(0.0);
    let inverse = 1.0 / select(d, vec3<f32>(1.0), is_flat);
    let middle = q * inverse;
    let reach = r * abs(inverse) + RAY_TOLERANCE * abs(middle);
    let from_t = select(middle - reach, vec3<f32>(-FARTHEST_T), is_flat);
    let to_t = select(middle + reach, vec3<f32>(FARTHEST_T), is_flat);
    let first = max(largest_of(from_t), params.t_min.x - RAY_TOLERANCE * abs(params.t_min.x));
    let last = min(-largest_of(-to_t), params.t_max.x + RAY_TOLERANCE * abs(params.t_max.x));
    // NaN proves nothing; a zero direction is no ray
    return !(first > last) && !any(is_flat & (abs(q) > r)) && any(size > vec3<f32>(0.0));
}

// Some ray of a tile may meet a box that the tile's node meets.
fn tile_meets(x: u32, y: u32, node: Node, centre: vec3<f32>, half: vec3<f32>) -> bool {
    let end = min(TILE * vec2<u32>(x + 1u, y + 1u), vec2<u32>(params.width, params.height));
    for (var row = TILE * y; row < end.y; row++) {
        for (var column = TILE * x; column < end.x; column++) {
            if ray_meets(field_at(column, row), node, centre, half) {
                return true;
            }
        }
    }
    return false;
}

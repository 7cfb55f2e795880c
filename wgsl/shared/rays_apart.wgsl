// Rays that have little to do with each other: what a tile's rays meet is told ray by ray.

// What f32 loses of a ray's numbers and a box's, and of differences between rays: 16 roundings.
const RAY_SLACK: f32 = 1.0 / 1048576.0;

// A pixel's ray may meet a box. Never false when it does, or when another ray does that differs from it by so little of what the
// rays of its node differ by.
fn ray_meets(at: u32, node: Node, centre: vec3<f32>, half: vec3<f32>) -> bool {
    let p = field_origin(at);
    let d = field_direction(at);
    if all(d == vec3<f32>(0.0)) {
        return false;
    }
    let lost_p = RAY_SLACK * (abs(p) + abs(centre) + vec3<f32>(node.r_p) + abs(node.px) + abs(node.py));
    let r0 = half + lost_p + vec3<f32>(params.origin_lost);
    let r1 = RAY_SLACK * (abs(d) + vec3<f32>(node.r_d) + abs(node.dx) + abs(node.dy));
    let lo = params.t_min.x;
    let hi = params.t_max.x;
    if hi >= 0.0 {
        let met = slab(p - centre, d, r0, r1, vec2<f32>(max(lo, 0.0), hi));
        if met.x <= met.y {
            return true;
        }
    }
    if lo < 0.0 {
        let met = slab(p - centre, -d, r0, r1, vec2<f32>(max(-hi, 0.0), -lo));
        return met.x <= met.y;
    }
    return false;
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

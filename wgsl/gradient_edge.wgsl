// gradient_edge: one thread per pixel.
// Reads the rays of a pixel and of the four around it, how the pixel's own changes along a direction, and their triangles; finds the
// nearest edge at which a triangle ends between two of them. Writes to `edges` the coverage of the triangle, its slot, and the
// pixels inside and outside; and to `changes`, for each direction, the change of the coverage.

#choose arithmetic f64
#import arithmetic
#import gradients/layout.wgsl
#import gradients/rays.wgsl
#import shared/items.wgsl
#import shared/params.wgsl

var<storage, read> slots: array<vec2<u32>>;
var<storage, read_write> changes: array<f32>;
var<storage, read_write> edges: array<vec4<u32>>;

// An edge of a triangle between two pixels.
struct Edge {
    slot: u32,              // NONE: there is none
    number: u32,            // from corner k to the next
    inside: u32,            // the pixel that shows the triangle
    outside: u32,
}

fn normal_of(slot: u32) -> real3 {
    let v0 = corner(slot, 0u);
    return cross(corner(slot, 1u) - v0, corner(slot, 2u) - v0);
}

fn next(k: u32) -> u32 {
    return select(k + 1u, 0u, k == 2u);
}

// E of an edge, positive on the inner side, as the pixel that shows the triangle sees it.
fn inner_side(edge: Edge, pixel: u32, sign: real) -> real {
    let a = corner(edge.slot, edge.number);
    let b = corner(edge.slot, next(edge.number));
    return sign * side(ray_vector(pixel, 0u), ray_vector(pixel, 1u), a, b);
}

// The sign of N . D at the pixel that shows the triangle.
fn sign_inside(edge: Edge) -> real {
    return real(select(-1.0f, 1.0f, dot(normal_of(edge.slot), ray_vector(edge.inside, 1u)) > real(0.0f)));
}

// Distances (px), shares of a way, and depths (relative) that differ by less are equal: 2^-20, far above their rounding.
const LEVEL: real = 9.5367431640625e-7;

// What the pixel has, in the second word of its slot.
const HAS_RAY: u32 = 1u;
const HAS_SLOPES: u32 = 2u;

// The edge by which the way from one pixel to another leaves the triangle that the first one shows.
fn edge_left(inside: u32, outside: u32) -> Edge {
    var found = Edge(NONE, 0u, inside, outside);
    let slot = slots[inside].x;
    if slot == NONE || (slots[outside].y & HAS_RAY) == 0u {
        return found;
    }
    var edge = Edge(slot, 0u, inside, outside);
    let sign = sign_inside(edge);
    var least = real(2.0f);
    for (var k = 0u; k < 3u; k++) {
        edge.number = k;
        // a hit on the edge itself may lie outside by a rounding
        let start = max(inner_side(edge, inside, sign), real(0.0f));
        let end = inner_side(edge, outside, sign);
        if end < real(0.0f) {
            let share = start / (start - end);
            if share + LEVEL < least {
                least = share;
                found = edge;
            }
        }
    }
    return found;
}

// Z; only of a pixel that shows a triangle.
fn depth(pixel: u32) -> real {
    let slot = slots[pixel].x;
    let d = ray_vector(pixel, 1u);
    let normal = normal_of(slot);
    return dot(normal, corner(slot, 0u) - ray_vector(pixel, 0u)) / dot(normal, d) * sqrt(dot(d, d));
}

// Whether the first pixel's triangle is the nearer one.
fn is_first(a: u32, b: u32) -> bool {
    if slots[a].x == NONE || slots[b].x == NONE {
        return slots[b].x == NONE;
    }
    let depth_a = depth(a);
    let depth_b = depth(b);
    let level = LEVEL * min(abs(depth_a), abs(depth_b));
    // slots ascend as ids do
    return depth_b - depth_a > level || (depth_a - depth_b <= level && slots[a].x < slots[b].x);
}

// The edge between two pixels that show different triangles.
fn edge_between(a: u32, b: u32) -> Edge {
    if slots[a].x == slots[b].x {
        return Edge(NONE, 0u, a, b);
    }
    let nearer = select(b, a, is_first(a, b));
    let farther = a + b - nearer;
    let edge = edge_left(nearer, farther);
    if edge.slot != NONE {
        return edge;
    }
    return edge_left(farther, nearer);
}

// The change of E for a change of its ray and its corners.
fn side_rate(p: real3, d: real3, a: real3, b: real3, dp: real3, dd: real3, da: real3, db: real3) -> real {
    let m = a - p;
    let e = b - a;
    return dot(cross(da - dp, e), d) + dot(cross(m, db - da), d) + dot(cross(m, e), dd);
}

// E of an edge at a pixel, and its slopes to the right and downwards.
struct Slopes {
    value: real,
    right: real,
    down: real,
}

fn slopes_of(edge: Edge, pixel: u32) -> Slopes {
    let p = ray_vector(pixel, 0u);
    let d = ray_vector(pixel, 1u);
    let a = corner(edge.slot, edge.number);
    let b = corner(edge.slot, next(edge.number));
    let still = real3(vec3<f32>(0.0));
    return Slopes(
        side(p, d, a, b),
        side_rate(p, d, a, b, ray_vector(pixel, 2u), ray_vector(pixel, 3u), still, still),
        side_rate(p, d, a, b, ray_vector(pixel, 4u), ray_vector(pixel, 5u), still, still),
    );
}

// How a slope changes: the slope's own change of the ray is (px, dx), and that changes by (dpx, ddx).
fn slope_rate(edge: Edge, pixel: u32, direction: u32, first: u32) -> real {
    let p = ray_vector(pixel, 0u);
    let d = ray_vector(pixel, 1u);
    let px = ray_vector(pixel, first);
    let dx = ray_vector(pixel, first + 1u);
    let a = corner(edge.slot, edge.number);
    let b = corner(edge.slot, next(edge.number));
    let dp = ray_rate(pixel, 0u);
    let dd = ray_rate(pixel, 1u);
    let da = corner_rate(direction, edge.number);
    let db = corner_rate(direction, next(edge.number));
    let m = a - p;
    let e = b - a;
    let dm = da - dp;
    let de = db - da;
    // of -[px, e, d] + [m, e, dx]
    return dot(cross(m, e), ray_rate(pixel, first + 1u)) + dot(cross(dm, e), dx) + dot(cross(m, de), dx)
        - dot(cross(ray_rate(pixel, first), e), d) - dot(cross(px, de), d) - dot(cross(px, e), dd);
}

// The change of the distance E / |slopes|.
fn distance_rate(edge: Edge, pixel: u32, direction: u32, slopes: Slopes, steep: real) -> real {
    let a = corner(edge.slot, edge.number);
    let b = corner(edge.slot, next(edge.number));
    let value = side_rate(
        ray_vector(pixel, 0u),
        ray_vector(pixel, 1u),
        a,
        b,
        ray_rate(pixel, 0u),
        ray_rate(pixel, 1u),
        corner_rate(direction, edge.number),
        corner_rate(direction, next(edge.number)),
    );
    let right = slope_rate(edge, pixel, direction, 2u);
    let down = slope_rate(edge, pixel, direction, 4u);
    let along = (slopes.right / steep) * right + (slopes.down / steep) * down;
    return (value - (slopes.value / steep) * along) / steep;
}

@compute @workgroup_size(64)
fn gradient_edge(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    // take a pixel
    let index = item_index(group, groups, lane);
    if index >= gradient_params.pixels {
        return;
    }
    let pixel = gradient_params.first + index;
    let width = gradient_params.width;
    let column = pixel % width;
    let row = pixel / width;

    // the nearest edge between it and the four around it: left, right, above, below
    var nearest = Edge(NONE, 0u, 0u, 0u);
    var distance = real(0.0f);
    var slopes = Slopes(real(0.0f), real(0.0f), real(0.0f));
    var steep = real(0.0f);
    for (var k = 0u; k < 4u; k++) {
        let is_there = array<bool, 4>(column > 0u, column + 1u < width, row > 0u, row + 1u < gradient_params.rows);
        let beside = array<u32, 4>(pixel - 1u, pixel + 1u, pixel - width, pixel + width);
        if is_there[k] && (slots[pixel].y & HAS_SLOPES) != 0u {
            let edge = edge_between(pixel, beside[k]);
            if edge.slot != NONE {
                let own = slopes_of(edge, pixel);
                let length = sqrt(own.right * own.right + own.down * own.down);
                let off = sign_inside(edge) * own.value / length;
                let is_nearer = nearest.slot == NONE || abs(off) + LEVEL < abs(distance);
                if length > real(0.0f) && is_nearer {
                    nearest = edge;
                    distance = off;
                    slopes = own;
                    steep = length;
                }
            }
        }
    }

    // its coverage, and how that changes
    let directions = gradient_params.directions;
    let is_found = nearest.slot != NONE;
    let is_within = is_found && abs(distance) < real(0.5f);
    let covered = min(max(real(0.5f) + distance, real(0.0f)), real(1.0f));
    let coverage = select(1.0f, f32(covered), is_found);
    let first = gradient_params.pixel_first;
    let pixels = vec2<u32>(nearest.inside, nearest.outside) + vec2<u32>(first);
    edges[index] = vec4<u32>(bitcast<u32>(coverage), nearest.slot, select(vec2<u32>(NONE), pixels, is_found));
    for (var k = 0u; k < directions; k++) {
        var change = 0.0f;
        if is_within {
            change = f32(sign_inside(nearest) * distance_rate(nearest, pixel, k, slopes, steep));
        }
        changes[directions * index + k] = change;
    }
}

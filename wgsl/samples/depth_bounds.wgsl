// Bounds on the depth of a triangle's plane over places of a node.

#import nodes/conics.wgsl
#import nodes/extent.wgsl
#import shared/params.wgsl

// N . (v - P) and N . D as affine functions over a node, in node units, and their error bounds.
struct Plane {
    along: vec3<f32>,       // at the centre, and slopes
    error_along: f32,
    across: vec3<f32>,
    error_across: f32,
}

// t between two bounds; `facing` is the sign of N . D, 0 where it is not proven and t is unbounded.
struct Depths {
    near: f32,
    far: f32,
    facing: i32,
}

fn plane(node: Node, v0: vec3<f32>, v1: vec3<f32>, v2: vec3<f32>) -> Plane {
    let e1 = v1 - v0;
    let e2 = v2 - v0;
    let n = cross(e1, e2);
    let m = v0 - node.p;
    let reach = max(size1(v0), max(size1(v1), size1(v2)));
    let reach_p = size1(node.px) + size1(node.py);
    let reach_m = size1(m) + reach_p;
    let reach_d = size1(node.d) + size1(node.dx) + size1(node.dy);
    // e: differences of two rounded vertices; N: three operations a component
    let size_n = size1(e1) * size1(e2);
    let error_n = BOUND_TOLERANCE * (0.25 * reach * (size1(e1) + size1(e2)) + size_n) + LEAST * (1.0 + size_n);
    // also how far a hit may be moved to an end of t_range
    let error_m = node.r_p + END_BOUND * params.scene_size + BOUND_TOLERANCE * (reach_m + reach + size1(node.p)) + LEAST;
    let error_d = node.r_d + BOUND_TOLERANCE * reach_d + LEAST;
    let fits = size_n * reach_m < MOST && size_n * reach_d < MOST;
    let most = select(MOST, 1.0, fits);
    return Plane(
        vec3<f32>(dot(n, m), -dot(n, node.px), -dot(n, node.py)),
        most * (size_n * error_m + error_n * (reach_m + node.r_p)),
        vec3<f32>(dot(n, node.d), dot(n, node.dx), dot(n, node.dy)),
        most * (size_n * error_d + error_n * (reach_d + node.r_d)),
    );
}

// t over the box of half-size s about (x, y).
fn depths(q: Plane, x: f32, y: f32, s: f32) -> Depths {
    let along = q.along.x + x * q.along.y + y * q.along.z;
    let across = q.across.x + x * q.across.y + y * q.across.z;
    let margin_along = s * (abs(q.along.y) + abs(q.along.z)) + q.error_along;
    let margin_across = s * (abs(q.across.y) + abs(q.across.z)) + q.error_across;
    let least = abs(across) - margin_across;
    let facing = select(-1.0, 1.0, across > 0.0);
    let lo = facing * along - margin_along;
    let hi = facing * along + margin_along;
    let most = abs(across) + margin_across;
    let near = lo / select(least, most, lo > 0.0);
    let far = hi / select(most, least, hi > 0.0);
    // NaN and infinities fail these comparisons
    if !(least > LEAST && abs(near) < MOST && abs(far) < MOST) {
        return Depths(-ENDLESS, ENDLESS, 0);
    }
    return Depths(near - BOUND_TOLERANCE * abs(near), far + BOUND_TOLERANCE * abs(far), i32(facing));
}

// Unbounded t.
const ENDLESS: f32 = 3.0e38;

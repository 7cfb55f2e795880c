// On which side of an edge a ray passes, after Woop, Benthin and Wald 2013: corners go along the ray onto a plane, where each is
// rounded once and for all its triangles alike; in the plane the sign of every edge is exact. So triangles that share an edge or a
// corner leave no hole, however near the ray passes, and overlap only where roundings fold one of them over.

#import arithmetic
#import rays/affine_bundle.wgsl

// The axis along which a ray goes farthest, and how far it goes along the other two for each step along that.
struct Shear {
    axis: u32,
    slope: vec2<real>,
}

// The components of a vector from the one after the axis on, so that the axis is last.
fn turned_to(axis: u32, v: real3) -> real3 {
    if axis == 0u {
        return v.yzx;
    }
    if axis == 1u {
        return v.zxy;
    }
    return v;
}

fn shear_of(b: Bundle) -> Shear {
    var axis = 2u;
    if abs(b.d.x) >= abs(b.d.y) && abs(b.d.x) >= abs(b.d.z) {
        axis = 0u;
    } else if abs(b.d.y) >= abs(b.d.z) {
        axis = 1u;
    }
    let d = turned_to(axis, b.d);
    return Shear(axis, d.xy / d.z);
}

// Where a corner lies in the plane, the ray at (0, 0).
fn in_plane(b: Bundle, s: Shear, v: real3) -> vec2<real> {
    let m = turned_to(s.axis, v * b.h - b.p);
    return m.xy - s.slope * m.z;
}

// 1 where the ray has the edge from u to v on one hand, -1 on the other. Where it meets the edge still, as that of a ray an
// infinitesimal step away in the plane.
fn side_of(u: vec2<real>, v: vec2<real>) -> i32 {
    let p = u.x * v.y;
    let q = u.y * v.x;
    var side = sign_beyond(p - q, 4.0 * REAL_ROUNDING * (abs(p) + abs(q)));
    if side == 0 {
        side = order_of_products(u.x, v.y, u.y, v.x);
    }
    if side == 0 {
        side = sign_beyond(u.y - v.y, 0.0);
    }
    if side == 0 {
        side = select(-1, 1, v.x >= u.x);
    }
    return side;
}

// Never where all corners fall into one place: the last edge is taken from the first corner too.
fn is_between(b: Bundle, v: array<real3, 3>) -> bool {
    let s = shear_of(b);
    // in loops: without f64 an operation is a hundred instructions
    var corners = v;
    var places: array<vec2<real>, 3>;
    for (var k = 0u; k < 3u; k++) {
        places[k] = in_plane(b, s, corners[k]);
    }
    var sides: array<i32, 3>;
    for (var k = 0u; k < 3u; k++) {
        sides[k] = side_of(places[select(k, 0u, k == 2u)], places[min(k + 1u, 2u)]);
    }
    return sides[0] == sides[1] && sides[0] == -sides[2];
}

// The t of a ray between the corners, as the mean of the corners' own: each counts as much as the triangle of the ray and the two others.
fn t_between(b: Bundle, v: array<real3, 3>) -> real {
    let s = shear_of(b);
    let d = turned_to(s.axis, b.d);
    var corners = v;
    var places: array<vec2<real>, 3>;
    for (var k = 0u; k < 3u; k++) {
        places[k] = in_plane(b, s, corners[k]);
    }
    var sum = real(0.0);
    var weights = real(0.0);
    for (var k = 0u; k < 3u; k++) {
        let u = places[select(k + 1u, 0u, k == 2u)];
        let w = places[select(k - 1u, k + 2u, k == 0u)];
        let weight = abs(u.x * w.y - u.y * w.x);
        sum += weight * turned_to(s.axis, corners[k] * b.h - b.p).z;
        weights += weight;
    }
    return sum / (weights * d.z);
}

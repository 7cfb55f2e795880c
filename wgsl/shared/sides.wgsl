// On which side of an edge a ray passes, after Woop, Benthin and Wald 2013: corners go along the ray onto a plane, where each is
// rounded once and for all its triangles alike; in the plane the sign of every edge is exact. So triangles that share an edge or a
// corner leave no hole and do not overlap, however near the ray passes.

// The axis along which a ray goes farthest, and how far it goes aside for each step along that; how that changes over a pixel.
struct Shear {
    axis: u32,
    aside: vec2<real>,
    aside_x: vec2<real>,
    aside_y: vec2<real>,
}

// Where a corner lies in the plane, the ray at (0, 0), and how it moves there as the ray goes over its pixel.
struct PlaneCorner {
    at: vec2<real>,
    by_x: vec2<real>,
    by_y: vec2<real>,
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
    let dx = turned_to(axis, b.dx);
    let dy = turned_to(axis, b.dy);
    let aside = d.xy / d.z;
    return Shear(axis, aside, (dx.xy - aside * dx.z) / d.z, (dy.xy - aside * dy.z) / d.z);
}

fn in_plane(b: Bundle, s: Shear, v: real3) -> PlaneCorner {
    let m = turned_to(s.axis, v * b.h - b.p);
    let mx = turned_to(s.axis, v * b.hx - b.px);
    let my = turned_to(s.axis, v * b.hy - b.py);
    return PlaneCorner(
        m.xy - s.aside * m.z,
        mx.xy - s.aside * mx.z - s.aside_x * m.z,
        my.xy - s.aside * my.z - s.aside_y * m.z,
    );
}

// The sign of u x dv + du x v, of what is known to a rounding of its products each.
fn way_of(u: vec2<real>, du: vec2<real>, v: vec2<real>, dv: vec2<real>) -> i32 {
    let sum = u.x * dv.y - u.y * dv.x + du.x * v.y - du.y * v.x;
    let sizes = abs(u.x * dv.y) + abs(u.y * dv.x) + abs(du.x * v.y) + abs(du.y * v.x);
    return sign_beyond(sum, 16.0 * REAL_ROUNDING * sizes);
}

// 1 where the ray has the edge from u to v on one hand, -1 on the other. Where it meets the edge, what a ray has that is moved over
// the pixel: an infinitesimal step along x and a much smaller one along y; and where that says nothing, the same in the plane.
fn side_of(u: PlaneCorner, v: PlaneCorner) -> i32 {
    let p = u.at.x * v.at.y;
    let q = u.at.y * v.at.x;
    var side = sign_beyond(p - q, 4.0 * REAL_ROUNDING * (abs(p) + abs(q)));
    if side == 0 {
        side = order_of_products(u.at.x, v.at.y, u.at.y, v.at.x);
    }
    if side == 0 {
        side = way_of(u.at, u.by_x, v.at, v.by_x);
    }
    if side == 0 {
        side = way_of(u.at, u.by_y, v.at, v.by_y);
    }
    if side == 0 {
        side = sign_beyond(u.at.y - v.at.y, 0.0);
    }
    if side == 0 {
        side = select(-1, 1, v.at.x >= u.at.x);
    }
    return side;
}

// The corners in one order for all triangles, so that an edge has one side for all of them.
fn is_between(b: Bundle, s: Shear, v: array<real3, 3>) -> bool {
    let c0 = in_plane(b, s, v[0]);
    let c1 = in_plane(b, s, v[1]);
    let c2 = in_plane(b, s, v[2]);
    let side = side_of(c0, c1);
    return side == side_of(c1, c2) && side == -side_of(c0, c2);
}

// An affine homogeneous bundle about a point, in recheck arithmetic: P = p / h, D = d / h, and slopes per pixel.
struct Bundle {
    p: real3,
    px: real3,
    py: real3,
    d: real3,
    dx: real3,
    dy: real3,
    h: real,
    hx: real,
    hy: real,
}

fn bundle_at(b: Bundle, x: real, y: real) -> Bundle {
    return Bundle(
        b.p + x * b.px + y * b.py, b.px, b.py,
        b.d + x * b.dx + y * b.dy, b.dx, b.dy,
        b.h + x * b.hx + y * b.hy, b.hx, b.hy,
    );
}

fn size3(v: real3) -> real {
    return abs(v.x) + abs(v.y) + abs(v.z);
}

// The size of the largest of a triangle's corners.
fn reach3(v: array<real3, 3>) -> real {
    return max(size3(v[0]), max(size3(v[1]), size3(v[2])));
}

// 1, -1, or 0 within the bound.
fn sign_beyond(value: real, bound: real) -> i32 {
    return select(0, 1, value > bound) - select(0, 1, value < -bound);
}

// The vertex v with m = v h - p and g = d x m counts as on the ray: see AT_RAY.
fn is_at(b: Bundle, v: real3, g: real3, m: real3) -> bool {
    let sizes = size3(m) + size3(v) * abs(b.h) + size3(b.p);
    return size3(g) <= AT_RAY * 16.0 * REAL_UNIT * size3(b.d) * sizes;
}

// The side of the ray at the bundle's centre with respect to the edge from v to w:
// the sign of E = e . (d x m), e = w - v, m = v h - p. Where E is 0 within its rounding, the first of its derivatives by x, y,
// xx, xy, yy that is not, and then 1: one infinitesimal shift of the pixel, the same for all triangles.
// Bounds: a cross product of rounded factors, then a dot product, 16 units of |e| |d| |m| in all, where |m| stands for
// the sizes that were subtracted; e carries the rounding of two stored vertices and of their difference, 2 units of both sizes.
// A vertex so near the ray that an edge at it may not be proven counts as on the ray, for all its edges alike: else the
// proven ones and the others could contradict each other there.
fn edge_side(b: Bundle, v: real3, w: real3) -> i32 {
    let size_v = size3(v);
    let sizes_vw = size_v + size3(w);
    let e = w - v;
    let m = v * b.h - b.p;
    let mx = v * b.hx - b.px;
    let my = v * b.hy - b.py;
    let size_e = 16.0 * REAL_UNIT * (size3(e) + sizes_vw * REAL_UNIT);
    let lost_e = 2.0 * REAL_UNIT * sizes_vw;
    let nd = size3(b.d);
    let ndx = size3(b.dx);
    let ndy = size3(b.dy);
    let nm = size3(m) + size_v * abs(b.h) + size3(b.p);
    let nmx = size3(mx) + size_v * abs(b.hx);
    let nmy = size3(my) + size_v * abs(b.hy);

    let g = cross(b.d, m);
    var side = 0;
    if !(is_at(b, v, g, m) || is_at(b, w, cross(b.d, w * b.h - b.p), w * b.h - b.p)) {
        side = sign_beyond(dot(e, g), size_e * nd * nm + lost_e * size3(g));
        if side != 0 { return side; }
    }
    let gx = cross(b.dx, m) + cross(b.d, mx);
    side = sign_beyond(dot(e, gx), size_e * (ndx * nm + nd * nmx) + lost_e * size3(gx));
    if side != 0 { return side; }
    let gy = cross(b.dy, m) + cross(b.d, my);
    side = sign_beyond(dot(e, gy), size_e * (ndy * nm + nd * nmy) + lost_e * size3(gy));
    if side != 0 { return side; }
    let gxx = cross(b.dx, mx);
    side = sign_beyond(dot(e, gxx), size_e * ndx * nmx + lost_e * size3(gxx));
    if side != 0 { return side; }
    let gxy = cross(b.dx, my) + cross(b.dy, mx);
    side = sign_beyond(dot(e, gxy), size_e * (ndx * nmy + ndy * nmx) + lost_e * size3(gxy));
    if side != 0 { return side; }
    let gyy = cross(b.dy, my);
    side = sign_beyond(dot(e, gyy), size_e * ndy * nmy + lost_e * size3(gyy));
    return select(side, 1, side == 0);
}

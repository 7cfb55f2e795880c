// Affine bundles of rays, in recheck arithmetic.

#import arithmetic

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

// The sign of a number: 1 or -1, or 0 within the bound.
fn sign_beyond(value: real, bound: real) -> i32 {
    return select(0, 1, value > bound) - select(0, 1, value < -bound);
}

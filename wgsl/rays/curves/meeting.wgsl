// The first hit of a pixel's curve with a triangle: the roots of N . (X(t) - v) over a span of t, a polynomial of the curve's
// degree, whose points lie inside the triangle.

#import arithmetic
#import masks/there
#import nodes/slabs.wgsl
#import rays/affine_bundle.wgsl
#import rays/curve
#import rays/curves/coverage.wgsl
#import rays/curves/curve.wgsl
#import rays/meeting.wgsl
#import shared/params.wgsl

struct CellDepth {
    normal: real3,
    v: array<real3, 3>,
    back_sign: real,
    slot: u32,
}

fn cell_depth(whole: Bundle, normal: real3, v: array<real3, 3>, back_sign: real, slot: u32) -> CellDepth {
    return CellDepth(normal, v, back_sign, slot);
}

// The first visible hit over the span. Between its critical points the polynomial has one root or none.
fn pixel_depth(q: CellDepth, cell: Cell, x: u32, y: u32) -> Meeting {
    let corner = tile_corner(cell.tile);
    let c = curve_stored(curve_place(tile_layer(cell.tile), corner.x + x, corner.y + y));
    let b = real4(dot(q.normal, c.c0 - q.v[0]), dot(q.normal, c.c1 - q.v[0]), dot(q.normal, c.c2 - q.v[0]), dot(q.normal, c.c3 - q.v[0]));
    let sizes = reach3(q.v) + max(max(size3(c.c0), size3(c.c1)), max(size3(c.c2), size3(c.c3)));
    // stored numbers, differences and two products: 16 units of what is summed up
    let bound = 16.0 * REAL_UNIT * size3(q.normal) * sizes;
    if max(max(abs(b.x), abs(b.y)), max(abs(b.z), abs(b.w))) <= bound {
        // the curve lies in the plane, and sees no face of the triangle
        return Meeting(0.0, false);
    }
    let span = vec2<f32>(span_of(cell.tile));
    let spans = real(f32(params.spans));
    let end = real(span.y) / spans;
    var from_t = real(span.x) / spans;
    let extrema = critical_points(b, from_t, end);
    var from_value = polynomial(b, from_t);
    for (var k = 0u; k < DEGREE; k++) {
        let to_t = select(extrema[min(k, 1u)], end, k + 1u == DEGREE);
        let to_value = polynomial(b, to_t);
        if abs(from_value) <= bound {
            let at = meeting_at(q, c, from_t, sizes, bound);
            if at.visible {
                return at;
            }
        }
        if (from_value < 0.0 && to_value > 0.0) || (from_value > 0.0 && to_value < 0.0) {
            let at = meeting_at(q, c, root_between(b, from_t, to_t, from_value < 0.0), sizes, bound);
            if at.visible {
                return at;
            }
        }
        from_t = to_t;
        from_value = to_value;
    }
    if abs(from_value) <= bound {
        return meeting_at(q, c, end, sizes, bound);
    }
    return Meeting(0.0, false);
}

fn polynomial(b: real4, t: real) -> real {
    return dot(bernstein(DEGREE, t), b);
}

// The first DEGREE - 1 are the polynomial's extrema in (lo, hi), in order; missing ones are set to an end.
fn critical_points(b: real4, lo: real, hi: real) -> array<real, 2> {
    if DEGREE == 1u {
        return array<real, 2>(lo, lo);
    }
    let d0 = b.y - b.x;
    let d1 = b.z - b.y;
    if DEGREE == 2u {
        let t = select(lo, d0 / (d0 - d1), d0 != d1);
        return array<real, 2>(min(max(t, lo), hi), hi);
    }
    // d0 + 2 t (d1 - d0) + t^2 (d0 - 2 d1 + d2) = 0
    let a = d0 - 2.0 * d1 + (b.w - b.z);
    let h = d1 - d0;
    let discriminant = h * h - a * d0;
    if discriminant < 0.0 {
        return array<real, 2>(lo, lo);
    }
    let root = sqrt(discriminant);
    let w = -(h + select(root, -root, h < 0.0));
    let first = select(lo, min(max(w / a, lo), hi), a != 0.0);
    let second = select(lo, min(max(d0 / w, lo), hi), w != 0.0);
    return array<real, 2>(min(first, second), max(first, second));
}

// Halving alone takes a bracket in [0, 1] to the last bit within 64 steps.
const ROOT_STEPS: u32 = 64u;

// The root between two ts at which the polynomial has different signs: Newton's steps, halved where they leave the bracket, until
// the value is one of rounding alone: of 4 units for a weight, one for its product and three for the sum.
fn root_between(b: real4, from_t: real, to_t: real, rises: bool) -> real {
    var lo = from_t;
    var hi = to_t;
    var t = 0.5 * (lo + hi);
    let rounding = 8.0 * REAL_ROUNDING * max(max(abs(b.x), abs(b.y)), max(abs(b.z), abs(b.w)));
    for (var k = 0u; k < ROOT_STEPS; k++) {
        let value = polynomial(b, t);
        if (value < 0.0) == rises {
            lo = t;
        } else {
            hi = t;
        }
        let w = real(f32(DEGREE)) * bernstein(DEGREE - 1u, t);
        let slope = w.x * (b.y - b.x) + w.y * (b.z - b.y) + w.z * (b.w - b.z);
        var next = t - value / slope;
        if slope == 0.0 || !(next > lo && next < hi) {
            next = 0.5 * (lo + hi);
        }
        if abs(value) <= rounding {
            break;
        }
        let is_last = abs(next - t) <= REAL_ROUNDING;
        t = next;
        if is_last {
            break;
        }
    }
    return t;
}

// Second derivatives of a cubic are at most 6 times the second differences of its control points, 4 sizes each.
const BEND: real = 24.0;

// The curve's point at a root, if it is inside the triangle within rounding. At a shared edge at least one triangle is hit, perhaps both
// at one t. Sides are tested along the tangent there, so that an error of the root along the curve does not matter.
fn meeting_at(q: CellDepth, c: Curve, t: real, sizes: real, bound: real) -> Meeting {
    let at = curve_point(c, t);
    let tangent = curve_tangent(c, t);
    let across = dot(q.normal, tangent);
    if across * q.back_sign > 0.0 {
        return Meeting(t, false);
    }
    // a root is off by the polynomial's rounding over its slope; a double one by the square root of it
    let off = min(bound / max(abs(across), bound), REAL_UNIT_ROOT);
    let margin = size3(tangent) * sizes * (16.0 * REAL_UNIT + BEND * off * off);
    let facing = select(real(1.0), real(-1.0), across < 0.0);
    var inside = true;
    for (var k = 0u; k < 3u; k++) {
        let e = q.v[(k + 1u) % 3u] - q.v[k];
        inside = inside && facing * dot(e, cross(tangent, q.v[k] - at)) >= -size3(e) * margin;
    }
    let z = real3(0.0);
    return Meeting(t, inside && is_there(q.slot, Bundle(at, z, z, tangent, z, z, real(1.0), real(0.0), real(0.0))));
}

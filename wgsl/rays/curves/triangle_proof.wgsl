// Proofs in recheck arithmetic about the first hit of a pixel's curve with a triangle, over a span of t.

#import arithmetic
#import nodes/slabs.wgsl
#import rays/affine_bundle.wgsl
#import rays/curves/coverage.wgsl
#import rays/curves/curve.wgsl
#import rays/curves/meeting.wgsl
#import rays/proof.wgsl
#import shared/params.wgsl

// A polynomial over the control net is off by the errors of N and the net; so is its extreme where a critical point is off by the root
// of a unit, at which it is off by BEND units of its sizes: in all under twice this bound.
fn pixel_proof(
    cell: Cell, whole: Bundle, x: u32, y: u32, slot: u32, v: array<real3, 3>, back_sign: i32, is_inside: bool,
) -> Proof {
    let corner = tile_corner(cell.tile);
    let c = curve_stored(curve_place(tile_layer(cell.tile), corner.x + x, corner.y + y));
    let normal = normal_of(v);
    let sizes = reach3(v) + max(max(size3(c.c0), size3(c.c1)), max(size3(c.c2), size3(c.c3)));
    let error = sizes * (2.0 * normal.error + (2.0 * PRODUCT_UNITS + BEND) * REAL_UNIT * normal.size) + normal.size * real(params.origin_error);
    let b = real4(dot(normal.n, c.c0 - v[0]), dot(normal.n, c.c1 - v[0]), dot(normal.n, c.c2 - v[0]), dot(normal.n, c.c3 - v[0]));
    let span = vec2<f32>(span_of(cell.tile));
    let spans = real(f32(params.spans));
    let end = real(span.y) / spans;
    var from_t = real(span.x) / spans;
    let extrema = critical_points(b, from_t, end);
    for (var k = 0u; k < DEGREE; k++) {
        let to_t = select(extrema[min(k, 1u)], end, k + 1u == DEGREE);
        let from_side = sign_beyond(polynomial(b, from_t), 2.0 * error);
        let to_side = sign_beyond(polynomial(b, to_t), 2.0 * error);
        if from_side == 0 || to_side == 0 {
            return Proof(true, false, from_t, to_t);
        }
        if from_side != to_side {
            let root = root_proof(c, b, normal, v, back_sign, sizes, error, from_t, to_t, from_side);
            if root.may {
                return root;
            }
        }
        from_t = to_t;
    }
    return MISSED;
}

// The one root between two ts at which the polynomial has proven and different signs.
fn root_proof(
    c: Curve, b: real4, normal: Normal, v: array<real3, 3>, back_sign: i32, sizes: real, error: real, from_t: real, to_t: real,
    from_side: i32,
) -> Proof {
    let t = root_between(b, from_t, to_t, from_side < 0);
    let at = curve_point(c, t);
    let tangent = curve_tangent(c, t);
    let across = dot(normal.n, tangent);
    let size_tangent = size3(tangent);
    let tangent_error = 2.0 * PRODUCT_UNITS * REAL_UNIT * sizes;
    let facing = sign_beyond(across, size_tangent * (normal.error + PRODUCT_UNITS * REAL_UNIT * normal.size) + normal.size * tangent_error);
    let off = 2.0 * error / max(abs(across), error) + 4.0 * REAL_ROUNDING;
    let near = max(t - off, from_t);
    let far = min(t + off, to_t);
    let is_between = (near == from_t || sign_beyond(polynomial(b, near), error) == from_side)
        && (far == to_t || sign_beyond(polynomial(b, far), error) == -from_side);
    if facing == 0 || !is_between {
        return Proof(true, false, from_t, to_t);
    }
    if facing * back_sign > 0 {
        return MISSED;
    }
    // along the tangent a root may be off at no cost
    let point_error = BEND * off * off + 2.0 * PRODUCT_UNITS * REAL_UNIT;
    var sure = true;
    for (var k = 0u; k < 3u; k++) {
        let e = v[(k + 1u) % 3u] - v[k];
        let to_v = v[k] - at;
        let error_e = REAL_UNIT * (2.0 * reach3(v) + size3(e));
        let bound = size_tangent * (size3(e) * (sizes * point_error + real(params.origin_error)) + error_e * size3(to_v));
        let side = facing * sign_beyond(dot(e, cross(tangent, to_v)), bound);
        if side < 0 {
            return MISSED;
        }
        sure = sure && side > 0;
    }
    return Proof(true, sure, near, far);
}

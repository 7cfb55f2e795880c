// Proofs in recheck arithmetic about where a straight ray meets a triangle.
//
// REAL_UNIT is the rounding of stored numbers and no less than that of one operation. The size of a vector is the sum of its absolute
// components, so that a product is at most the product of the sizes. Every bound has the same form: the error of each factor
// times the size of the other, plus PRODUCT_UNITS of both sizes.

#import arithmetic
#import masks/proof
#import rays/affine_bundle.wgsl
#import rays/proof
#import rays/proof.wgsl
#import rays/straight/meeting.wgsl
#import rays/straight/perturb.wgsl
#import rays/straight/plane_tolerance.wgsl
#import shared/params.wgsl

// A ray, and error bounds of its parts.
struct Weighed {
    b: Bundle,
    error_p: real,
    error_d: real,
    error_h: real,
}

// v h - p, and its error bound.
struct Offset {
    m: real3,
    size: real,
    error: real,
}

fn offset_of(q: Weighed, v: real3) -> Offset {
    let m = v * q.b.h - q.b.p;
    let reach = size3(v);
    // v as stored 1 unit, a product 1, a difference 1 of the result
    let error = q.error_p + reach * q.error_h + REAL_UNIT * (2.0 * reach * abs(q.b.h) + size3(m));
    return Offset(m, size3(m) + error, error);
}

// A value, and its error bound.
struct Bounded {
    value: real,
    bound: real,
}

// E = (w - v) . (d x m) of the ray itself.
fn side_value(q: Weighed, from_v: Offset, v: real3, w: real3) -> Bounded {
    let e = w - v;
    let g = cross(q.b.d, from_v.m);
    let size_d = size3(q.b.d) + q.error_d;
    let error_e = REAL_UNIT * (size3(v) + size3(w) + size3(e));
    let sizes = size_d * from_v.size;
    let error_g = size_d * from_v.error + q.error_d * from_v.size + PRODUCT_UNITS * REAL_UNIT * sizes;
    let bound = error_e * sizes + size3(e) * (error_g + PRODUCT_UNITS * REAL_UNIT * sizes);
    return Bounded(dot(e, g), bound);
}

// The sign of E; 0: not proven.
fn proven_side(q: Weighed, from_v: Offset, v: real3, w: real3) -> i32 {
    let side = side_value(q, from_v, v, w);
    return sign_beyond(side.value, side.bound);
}

// 1: the ray is proven inside all edges, -1: proven outside one; 0: neither.
fn proven_inside(q: Weighed, from_v: Offset, v: array<real3, 3>) -> i32 {
    let a = proven_side(q, from_v, v[0], v[1]);
    let b = -proven_side(q, from_v, v[0], v[2]);
    let c = proven_side(q, offset_of(q, v[1]), v[1], v[2]);
    if min(a, min(b, c)) < 0 && max(a, max(b, c)) > 0 {
        return -1;
    }
    return select(0, 1, a != 0 && a == b && a == c);
}

// t = N . m / N . d lies in [near, far] where the sign of N . d is proven, which is `facing`; else anywhere. Hits up to `margin` from an end of
// t_range may be moved to it.
struct OnPlane {
    near: real,
    far: real,
    facing: i32,
    margin: real,
}

fn on_plane(q: Weighed, from_v: Offset, normal: Normal, reach: real) -> OnPlane {
    let size_d = size3(q.b.d) + q.error_d;
    let units = PRODUCT_UNITS * REAL_UNIT * normal.size;
    let error_along = normal.error * from_v.size + normal.size * from_v.error + units * from_v.size;
    let error_across = normal.error * size_d + normal.size * q.error_d + units * size_d;
    let along = dot(normal.n, from_v.m);
    let across = dot(normal.n, q.b.d);
    // where the triangle is seen edge-on, t is that of the perturbed ray
    let facing = sign_beyond(across, max(error_across, EDGE_ON * normal.size * size_d));
    if facing == 0 {
        return OnPlane(-FARTHEST, FARTHEST, 0, 0.0);
    }
    let least = abs(across) - error_across;
    let t = along / across;
    let off = (error_along + abs(t) * error_across) / least + 4.0 * REAL_ROUNDING * abs(t);
    // twice the tolerance, for its rounding
    let margin = 2.0 * end_rounding(q.b, normal.n, abs(across) + error_across, reach) / least;
    return OnPlane(t - off, t + off, facing, margin);
}

fn pixel_proof(
    cell: Cell, whole: Bundle, x: u32, y: u32, slot: u32, v: array<real3, 3>, back_sign: i32, is_inside: bool,
) -> Proof {
    let q = weighed(cell, whole, x, y);
    let from_v = offset_of(q, v[0]);
    var inside = is_inside;
    if !is_inside {
        // the ray of the pixel's centre, and the perturbed one that decided coverage
        let moved = Weighed(perturbed(q.b, real(params.scene_size)), q.error_p, q.error_d, q.error_h);
        let centre = proven_inside(q, from_v, v);
        let decided = proven_inside(moved, offset_of(moved, v[0]), v);
        if centre < 0 && decided < 0 {
            return MISSED;
        }
        inside = centre > 0 && decided > 0;
    }
    let met = on_plane(q, from_v, normal_of(v), reach3(v));
    let t_min = real_from_bits(params.t_words.xy);
    let t_max = real_from_bits(params.t_words.zw);
    if met.facing * back_sign > 0 || met.far < t_min - met.margin || met.near > t_max + met.margin {
        return MISSED;
    }
    let mask = mask_side(slot, q, v);
    if mask < 0 {
        return MISSED;
    }
    let is_in_range = met.near >= t_min && met.far <= t_max;
    let near = select(met.near, t_min, met.near <= t_min + met.margin);
    let far = select(met.far, t_max, met.far >= t_max - met.margin);
    return Proof(true, inside && is_in_range && met.facing != 0 && mask > 0, near, far);
}

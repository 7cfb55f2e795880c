// Proofs in recheck arithmetic about where a straight ray meets a sphere. Sizes and bounds have the form of triangle_proof.wgsl.

#import arithmetic
#import nodes/slabs.wgsl
#import primitives/spheres/chord.wgsl
#import primitives/spheres/end.wgsl
#import rays/affine_bundle.wgsl
#import rays/proof
#import rays/proof.wgsl
#import rays/straight/triangle_proof.wgsl
#import shared/params.wgsl

// Bounds are sums and products of rounded numbers, each by some units: all of them together by less than this share.
const BOUND_ROUNDING: real = 1.0001;

// Units of a root and of a quotient.
const ROOT_UNITS: real = 8.0;

// With m = c h - p and R = r h the ray meets it at t = (d . m -+ s) / a, a = d . d, s being the root of a R^2 - w . w, w = d x m. A product is
// off by the error of each factor times the size of the other, and by PRODUCT_UNITS of both sizes; a square by twice its error times its size.
fn sphere_proof(cell: Cell, whole: Bundle, x: u32, y: u32, s: Sphere, two_sided: bool) -> Proof {
    let q = weighed(cell, whole, x, y);
    let d = q.b.d;
    let to_centre = offset_of(q, s.centre);
    let m = to_centre.m;
    let units = PRODUCT_UNITS * REAL_UNIT;
    let size_d = size3(d) + q.error_d;
    // the radius as stored, and a product
    let large = s.radius * abs(q.b.h);
    let error_large = 2.0 * REAL_UNIT * large + s.radius * q.error_h;
    let error_square = error_large * (2.0 * large + error_large) + units * large * large;
    let a = dot(d, d);
    let error_a = BOUND_ROUNDING * (q.error_d * 2.0 * size_d + units * size_d * size_d);
    let w = cross(d, m);
    let size_w = size3(w);
    let error_w = size_d * to_centre.error + q.error_d * to_centre.size + units * size_d * to_centre.size;
    let below = a * large * large - dot(w, w);
    let error_below = BOUND_ROUNDING
        * ((a + error_a) * error_square + large * large * error_a + error_w * (2.0 * size_w + error_w)
            + units * (a * large * large + size_w * size_w));
    if a <= 2.0 * error_a {
        return Proof(true, false, -FARTHEST, FARTHEST);
    }
    if below < -error_below {
        return MISSED;
    }

    // where it is entered and left
    let along = dot(d, m);
    let error_along = BOUND_ROUNDING * error_w;
    let root_low = sqrt(max(below - error_below, 0.0)) * (1.0 - ROOT_UNITS * REAL_UNIT);
    let root_high = sqrt(below + error_below) * (1.0 + ROOT_UNITS * REAL_UNIT);
    let most = a + error_a;
    let least = a - error_a;
    let enters_first = no_more(along - error_along - root_high, most, least);
    let enters_last = -no_more(root_low - along - error_along, most, least);
    let leaves_first = no_more(along - error_along + root_low, most, least);
    let leaves_last = -no_more(-(along + error_along + root_high), most, least);

    // the first of them in range; an end of a chain's segment includes hits a little beyond it
    let t_min = real_from_bits(params.t_words.xy);
    let t_max = real_from_bits(params.t_words.zw);
    let margin = select(0.0, 2.0 * end_margin(q.b, s, below - error_below), SLABBED);
    let is_met = below > error_below;
    let is_entered_before = enters_last < t_min - margin;
    let is_entered = enters_first >= t_min && enters_last <= t_max;
    let is_left = two_sided && is_entered_before && leaves_first >= t_min && leaves_last <= t_max;
    if is_met && (is_entered || is_left) {
        return Proof(true, true, select(leaves_first, enters_first, is_entered), select(leaves_last, enters_last, is_entered));
    }
    let first = select(enters_first, leaves_first, is_entered_before && two_sided);
    let last = select(enters_last, leaves_last, two_sided);
    let is_around = is_met && is_entered_before && leaves_first > t_max + margin;
    if is_around || last < t_min - margin || first > t_max + margin {
        return MISSED;
    }
    return Proof(true, false, max(first, t_min), min(last, t_max));
}

// No more than a number over one from `least` to `most`, both above 0.
fn no_more(number: real, most: real, least: real) -> real {
    let t = number / select(least, most, number > 0.0);
    return t - ROOT_UNITS * REAL_UNIT * abs(t);
}

// What a straight ray meets, to f32, where there are spheres too. A sphere of the hierarchy has its centre for a corner, and its radius for
// the x of its edge.

#import primitives/spheres/sphere.wgsl
#import rays/coverage
#import rays/seen
#import rays/straight/seen.wgsl
#import rays/straight/stretch.wgsl
#import rays/stretch
#import vertices/traced
#import vertices/triangle.wgsl
#import vertices/vertex

fn with_primitive(path: Path, stretch: Stretch, before: Seen, own: BvhTriangle) -> Seen {
    if is_sphere(vec4<u32>(own.word)) {
        return with_sphere(path, stretch, before, own);
    }
    return with_triangle(path, stretch, before, own);
}

// Sizes of vectors are their largest components, but for those of d and of w = d x m: the sums of theirs. |d| <= 1 in each component, and so
// are |v| and r. m is off by what was lost of p, by the units of a corner, and by 2 of its size. w is off by twice the sum of error_m and
// (|m| + error_m) error_d, and by 6 units of |m| and of itself: a component each.
//
// With a = d . d and what is below the root, r^2 a - w . w, a is off by twice |d| error_d and 5 units of itself: three products, two sums.
// The radius is off by 2 units, as it was rounded with its scale, so r^2 a by r^2 times what a lost, and by 8 units of itself, w . w by
// twice |w| times what w lost, and by the square of that, three times, and 5 units; their difference by one.
//
// t = (d . m -+ s) / a, s being the root. d . m is off by |d| error_m and 3 |m| error_d, and by 5 units of 3 |m|. s lies between the roots of
// what bounds its square, each of which 2 units off; the quotient is off by 4 units.
fn with_sphere(path: Path, stretch: Stretch, before: Seen, own: BvhTriangle) -> Seen {
    let d = stretch.d;
    let r = own.to_next.x;
    let m = own.v - stretch.p;
    let w = cross(d, m);
    let size_d = abs(d.x) + abs(d.y) + abs(d.z);
    let size_w = abs(w.x) + abs(w.y) + abs(w.z);
    let size_m = largest_of(m);
    let error_m = UNIT * (CORNER_UNITS + 2.0 * size_m) + stretch.error_p;
    let error_w = 2.0 * (error_m + (size_m + error_m) * stretch.error_d) + UNIT * (6.0 * size_m + 6.0 * largest_of(w));
    let a = dot(d, d);
    let error_a = stretch.error_d * (2.0 * size_d + 3.0 * stretch.error_d) + 5.0 * UNIT * a;
    let below = r * r * a - dot(w, w);
    let error_below = r * r * (error_a + 8.0 * UNIT * a) + error_w * (2.0 * size_w + 3.0 * error_w) + 6.0 * UNIT * dot(w, w)
        + UNIT * abs(below) + LEAST;
    let is_known = a > 2.0 * error_a;
    let is_met_by_line = is_known && below > error_below;
    let is_passed = is_known && below < -error_below;

    // where it is entered and left
    let along = dot(d, m);
    let error_along = size_d * error_m + 3.0 * (size_m + error_m) * stretch.error_d + 15.0 * UNIT * size_m + LEAST;
    let root_low = sqrt(max(below - error_below, 0.0)) * (1.0 - 4.0 * UNIT);
    let root_high = sqrt(max(below + error_below, 0.0)) * (1.0 + 4.0 * UNIT) + LEAST;
    let least_a = max(a - error_a, LEAST);
    let enters_first = quotient_below(along - error_along - root_high, a + error_a, least_a);
    let enters_last = -quotient_below(-(along + error_along - root_low), a + error_a, least_a);
    let leaves_first = quotient_below(along - error_along + root_low, a + error_a, least_a);
    let leaves_last = -quotient_below(-(along + error_along + root_high), a + error_a, least_a);

    // entered in range, or surely not before it and left in range
    let two_sided = (own.word & ONE_SIDED) == 0u;
    let is_entered = enters_first >= stretch.inner_first && enters_last <= stretch.inner_last;
    let is_left_alone = two_sided && enters_last < stretch.first
        && leaves_first >= stretch.inner_first && leaves_last <= stretch.inner_last;
    let is_sure = is_met_by_line && (is_entered || is_left_alone);
    let first = select(-ENDLESS, select(enters_first, leaves_first, is_sure && !is_entered), is_known);
    let last = select(ENDLESS, select(leaves_last, enters_last, is_sure && is_entered), is_known);
    return with_hit(path, stretch, before, own, first, last, is_passed, is_sure);
}

// No more than a number over one from `low` to `high`, both above 0.
fn quotient_below(number: f32, high: f32, low: f32) -> f32 {
    let q = number / select(low, high, number > 0.0);
    return q - 4.0 * UNIT * abs(q);
}

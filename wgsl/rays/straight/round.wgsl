// Where a straight ray meets a primitive, to f32, in scenes with spheres and capsules. A row of the hierarchy has an end of a capsule's segment
// for a corner, its radius for the x of the edge to the next corner, and its axis for the edge from the last one.

#import primitives/round/capsule.wgsl
#import rays/coverage
#import rays/seen
#import rays/straight/seen.wgsl
#import rays/straight/stretch.wgsl
#import rays/stretch
#import vertices/traced
#import vertices/triangle.wgsl
#import vertices/vertex

fn with_primitive(path: Path, stretch: Stretch, before: Seen, own: BvhTriangle) -> Seen {
    let word = vec4<u32>(own.word);
    if !is_round(word) {
        return with_triangle(path, stretch, before, own);
    }
    let m = own.v - stretch.p;
    let error_m = UNIT * (CORNER_UNITS + 2.0 * largest_of(m)) + stretch.error_p;
    var ends = ends_of(ball(stretch, m, error_m, own.to_next.x));
    if is_capsule(word) {
        ends = capsule_ends(stretch, own, m, error_m, ends);
    }
    return with_ends(path, stretch, before, own, ends);
}

// s enters and leaves at (along -+ root of `below`) / a, each number within its error.
struct Quadratic {
    a: f32,
    error_a: f32,
    along: f32,
    error_along: f32,
    below: f32,
    error_below: f32,
}

// Sizes of vectors are their largest components, but for those of d and of w = d x m: the sums of theirs. |d| <= 1 in each component, and so
// are |v| and r. m is off by what was lost of p, by the units of a corner, and by 2 of its size. w is off by twice the sum of error_m and
// (|m| + error_m) error_d, and by 6 units of |m| and of itself: a component each.
//
// With a = d . d and what is below the root, r^2 a - w . w, a is off by twice |d| error_d and 5 units of itself: three products, two sums.
// The radius is off by 2 units, as it was rounded with its scale, so r^2 a by r^2 times what a lost, and by 8 units of itself, w . w by
// twice |w| times what w lost, and by the square of that, three times, and 5 units; their difference by one.
//
// d . m is off by |d| error_m and 3 |m| error_d, and by 5 units of 3 |m|.
fn ball(stretch: Stretch, m: vec3<f32>, error_m: f32, r: f32) -> Quadratic {
    let d = stretch.d;
    let w = cross(d, m);
    let size_d = abs(d.x) + abs(d.y) + abs(d.z);
    let size_w = abs(w.x) + abs(w.y) + abs(w.z);
    let size_m = largest_of(m);
    let error_w = 2.0 * (error_m + (size_m + error_m) * stretch.error_d) + UNIT * (6.0 * size_m + 6.0 * largest_of(w));
    let a = dot(d, d);
    let error_a = stretch.error_d * (2.0 * size_d + 3.0 * stretch.error_d) + 5.0 * UNIT * a;
    let below = r * r * a - dot(w, w);
    let error_below = r * r * (error_a + 8.0 * UNIT * a) + error_w * (2.0 * size_w + 3.0 * error_w) + 6.0 * UNIT * dot(w, w)
        + UNIT * abs(below) + LEAST;
    let error_along = size_d * error_m + 3.0 * (size_m + error_m) * stretch.error_d + 15.0 * UNIT * size_m + LEAST;
    return Quadratic(a, error_a, dot(d, m), error_along, below, error_below);
}

// Bounds on the s where a line enters and leaves a round surface.
struct Ends {
    enters_first: f32,
    enters_last: f32,
    leaves_first: f32,
    leaves_last: f32,
    is_met: bool,           // surely
    is_passed: bool,        // surely
}

// The root lies between the roots of what bounds its square, each of which 2 units off; the quotient is off by 4 units.
fn ends_of(q: Quadratic) -> Ends {
    if !(q.a > 2.0 * q.error_a) {
        return Ends(-ENDLESS, ENDLESS, -ENDLESS, ENDLESS, false, false);
    }
    let root_low = sqrt(max(q.below - q.error_below, 0.0)) * (1.0 - 4.0 * UNIT);
    let root_high = sqrt(max(q.below + q.error_below, 0.0)) * (1.0 + 4.0 * UNIT) + LEAST;
    let least_a = max(q.a - q.error_a, LEAST);
    return Ends(
        quotient_below(q.along - q.error_along - root_high, q.a + q.error_a, least_a),
        -quotient_below(-(q.along + q.error_along - root_low), q.a + q.error_a, least_a),
        quotient_below(q.along - q.error_along + root_low, q.a + q.error_a, least_a),
        -quotient_below(-(q.along + q.error_along + root_high), q.a + q.error_a, least_a),
        q.below > q.error_below,
        q.below < -q.error_below,
    );
}

// No more than a number over one from `low` to `high`, both above 0.
fn quotient_below(number: f32, high: f32, low: f32) -> f32 {
    let q = number / select(low, high, number > 0.0);
    return q - 4.0 * UNIT * abs(q);
}

// A ray from the place on it that is nearest to the end of a segment, about that end, and the segment's axis.
struct Beside {
    m: vec3<f32>,           // the end, from that place
    error_m: f32,
    axis: vec3<f32>,        // unit
    error_axis: f32,
    length: f32,
    error_length: f32,
}

// An s between two, along the axis: from the segment's end, within the error.
struct AlongAxis {
    low: f32,
    high: f32,
}

// A capsule lies in the tube about its segment: where a ray enters the tube between the ends, it enters the capsule; where it enters the tube
// beyond an end, it enters the ball about that end later, or misses the capsule. It leaves in the same way (wgsl/primitives/round/chord.wgsl).
// All is measured from the place `start` of the ray that is nearest to an end, so that far rays lose no more than near ones.
fn capsule_ends(stretch: Stretch, own: BvhTriangle, m: vec3<f32>, error_m: f32, near: Ends) -> Ends {
    let d = stretch.d;
    let start = clamp(dot(d, m) / max(dot(d, d), LEAST), -ENDLESS, ENDLESS);
    let b = beside(stretch, own, m, error_m, start);
    let tube = ends_of(tube_of(stretch, b, own.to_next.x));
    let far = moved(ends_of(ball(stretch, b.m + b.length * b.axis, far_error(b), own.to_next.x)), start);
    let first = along_axis(stretch, b, tube.enters_first, tube.enters_last);
    let last = along_axis(stretch, b, tube.leaves_first, tube.leaves_last);
    let entered = at_place(near, moved(tube, start), far, b, first);
    let left = at_place(near, moved(tube, start), far, b, last);
    return Ends(
        entered.enters_first, entered.enters_last, left.leaves_first, left.leaves_last,
        entered.is_met, tube.is_passed || entered.is_passed,
    );
}

// The place on the ray is off by what m lost, by `start` times what d lost and 1 unit, and by a unit of the difference. The axis as stored is
// off by a unit of its size; over its length, twice that over its length and 6 units.
fn beside(stretch: Stretch, own: BvhTriangle, m: vec3<f32>, error_m: f32, start: f32) -> Beside {
    let place = m - start * stretch.d;
    let error_place = error_m + abs(start) * (stretch.error_d + 2.0 * UNIT) + 2.0 * UNIT * largest_of(place);
    let size = length(own.from_last);
    let error = UNIT * own.size;
    let axis = own.from_last / max(size, LEAST);
    return Beside(place, error_place, axis, 4.0 * error / max(size, LEAST) + 8.0 * UNIT, size, 3.0 * error + 6.0 * UNIT * size);
}

fn far_error(b: Beside) -> f32 {
    return b.error_m + b.error_length + b.length * b.error_axis + 3.0 * UNIT * (b.length + largest_of(b.m));
}

// The ball of d x u and m x u. A component of such a product is off by twice the sum of what its factors lose, each times the size of the other,
// and by 4 units of both sizes; u has the size 1. The square of u . (d x m) stands for that of the product of the two.
fn tube_of(stretch: Stretch, b: Beside, r: f32) -> Quadratic {
    let d = stretch.d;
    let size_m = largest_of(b.m);
    let across = cross(d, b.axis);
    let away = cross(b.m, b.axis);
    let error_across = 2.0 * (b.error_axis * (1.0 + stretch.error_d) + stretch.error_d) + 6.0 * UNIT;
    let error_away = 2.0 * (size_m * b.error_axis + b.error_m * (1.0 + b.error_axis)) + 6.0 * UNIT * size_m;
    let size_across = abs(across.x) + abs(across.y) + abs(across.z);
    let size_away = largest_of(away);
    let w = cross(d, b.m);
    let size_w = abs(w.x) + abs(w.y) + abs(w.z);
    let error_w = 2.0 * (b.error_m + (size_m + b.error_m) * stretch.error_d) + 12.0 * UNIT * size_m;
    let side = dot(b.axis, w);
    let error_side = 3.0 * error_w * (1.0 + b.error_axis) + b.error_axis * size_w + 6.0 * UNIT * size_w;
    let a = dot(across, across);
    let error_a = error_across * (2.0 * size_across + 3.0 * error_across) + 5.0 * UNIT * a;
    let below = r * r * a - side * side;
    let error_below = r * r * (error_a + 8.0 * UNIT * a) + error_side * (2.0 * abs(side) + error_side)
        + 6.0 * UNIT * side * side + UNIT * abs(below) + LEAST;
    let error_along = size_across * error_away + 3.0 * (size_away + error_away) * error_across
        + 15.0 * UNIT * size_across * size_away + LEAST;
    return Quadratic(a, error_a, dot(across, away), error_along, below, error_below);
}

// u . (s d - m). Of u . d the axis loses the sum of |d|, of u . m that of |m|.
fn along_axis(stretch: Stretch, b: Beside, s_first: f32, s_last: f32) -> AlongAxis {
    let slope = dot(b.axis, stretch.d);
    let error_slope = 3.0 * (b.error_axis * (1.0 + stretch.error_d) + stretch.error_d) + 15.0 * UNIT;
    let size_m = largest_of(b.m);
    let offset = dot(b.axis, b.m);
    let error_offset = 3.0 * (b.error_axis * (size_m + b.error_m) + b.error_m) + 15.0 * UNIT * size_m;
    let size_s = max(abs(s_first), abs(s_last));
    let error = size_s * (error_slope + 4.0 * UNIT) + error_offset + 4.0 * UNIT * abs(offset);
    let one = s_first * slope - offset;
    let other = s_last * slope - offset;
    return AlongAxis(min(one, other) - error, max(one, other) + error);
}

// The same after so much of the ray.
fn moved(ends: Ends, start: f32) -> Ends {
    return Ends(
        no_later(ends.enters_first, start), -no_later(-ends.enters_last, -start),
        no_later(ends.leaves_first, start), -no_later(-ends.leaves_last, -start),
        ends.is_met, ends.is_passed,
    );
}

// No more than a sum.
fn no_later(s: f32, start: f32) -> f32 {
    return max(s + start - 2.0 * UNIT * (abs(s) + abs(start)), -ENDLESS);
}

// The ends of those parts of the surface where the place may be.
fn at_place(near: Ends, tube: Ends, far: Ends, b: Beside, place: AlongAxis) -> Ends {
    let may_be_near = !(place.low > 0.0);
    let may_be_far = !(place.high < b.length - b.error_length);
    let may_be_between = !(place.high < 0.0) && !(place.low > b.length + b.error_length);
    var ends = Ends(ENDLESS, -ENDLESS, ENDLESS, -ENDLESS, true, true);
    ends = either_end(ends, near, may_be_near);
    ends = either_end(ends, far, may_be_far);
    return either_end(ends, tube, may_be_between);
}

fn either_end(a: Ends, b: Ends, may: bool) -> Ends {
    return Ends(
        select(a.enters_first, min(a.enters_first, b.enters_first), may),
        select(a.enters_last, max(a.enters_last, b.enters_last), may),
        select(a.leaves_first, min(a.leaves_first, b.leaves_first), may),
        select(a.leaves_last, max(a.leaves_last, b.leaves_last), may),
        a.is_met && (b.is_met || !may),
        a.is_passed && (b.is_passed || !may),
    );
}

// Entered in range, or surely not before it and left in range.
fn with_ends(path: Path, stretch: Stretch, before: Seen, own: BvhTriangle, ends: Ends) -> Seen {
    let two_sided = (own.word & ONE_SIDED) == 0u;
    let is_entered = ends.enters_first >= stretch.inner_first && ends.enters_last <= stretch.inner_last;
    let is_left_alone = two_sided && ends.enters_last < stretch.first
        && ends.leaves_first >= stretch.inner_first && ends.leaves_last <= stretch.inner_last;
    let is_sure = ends.is_met && (is_entered || is_left_alone);
    let first = select(ends.enters_first, ends.leaves_first, is_sure && !is_entered);
    let last = select(ends.leaves_last, ends.enters_last, is_sure && is_entered);
    return with_hit(path, stretch, before, own, first, last, ends.is_passed, is_sure);
}

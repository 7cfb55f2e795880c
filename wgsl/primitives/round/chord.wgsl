// Where a straight ray enters and leaves a sphere or capsule, in recheck arithmetic.
//
// With m = c h - p and R = r h a ray is on the ball about c where |t d - m| = R. The tube about a line through c along a unit vector u is the
// ball of d x u and m x u. A capsule lies in the tube about its segment: where a ray enters the tube between the ends, it enters the capsule;
// where it enters the tube beyond an end, it enters the ball about that end later, or misses the capsule. It leaves in the same way.

#import arithmetic
#import primitives/round/capsule.wgsl
#import primitives/round/kinds.wgsl
#import rays/affine_bundle.wgsl

struct Chord {
    enters: real,           // t
    leaves: real,
    below: real,            // the square of half the way between them, times |d|^4; below 0: the ray passes, and both are where it is nearest
}

// Where |t d - m| = R, `below` being d . d R^2 - |d x m|^2. With d . m of a root's sign nothing cancels; the product of the two t is
// (m . m - R^2) / d . d.
fn chord_between(d: real3, m: real3, large: real, below: real) -> Chord {
    let a = dot(d, d);
    let root = sqrt(max(below, 0.0));
    let along = dot(d, m);
    let far = along + select(root, -root, along < 0.0);
    let one = far / a;
    let other = select((dot(m, m) - large * large) / far, 0.0, far == 0.0);
    if below < 0.0 {
        return Chord(along / a, along / a, below);
    }
    return Chord(min(one, other), max(one, other), below);
}

fn ball_chord(d: real3, m: real3, large: real) -> Chord {
    let w = cross(d, m);
    return chord_between(d, m, large, dot(d, d) * large * large - dot(w, w));
}

// Units of the sizes of d and m by which a ray may seem to leave the direction of a capsule; a ray within that is parallel to it.
const PARALLEL_UNITS: real = 64.0;

// Along a parallel ray the tube has no ends, and `below` says whether the ray is in it.
fn tube_chord(d: real3, m: real3, axis: real3, large: real) -> Chord {
    let across = cross(d, axis);
    let away = cross(m, axis);
    let a = dot(across, across);
    let noise = PARALLEL_UNITS * REAL_UNIT * size3(d) * size3(m);
    if a * large * large <= noise * noise {
        let endless = real(ENDLESS_T);
        return Chord(-endless, endless, large * large - dot(away, away));
    }
    let w = dot(axis, cross(d, m));
    return chord_between(across, away, large, a * large * large - w * w);
}

const ENDLESS_T: f32 = 1.0e37;

fn chord_of(b: Bundle, s: Capsule) -> Chord {
    let m = s.end * b.h - b.p;
    let large = s.radius * b.h;
    let near = ball_chord(b.d, m, large);
    if !CAPSULES || s.length == 0.0 {
        return near;
    }
    // from the place of the ray that is nearest to the end, so that the axis loses nothing by the distance
    let start = dot(b.d, m) / dot(b.d, b.d);
    let own = tube_chord(b.d, m - start * b.d, s.axis, large);
    let tube = Chord(own.enters + start, own.leaves + start, own.below);
    if tube.below < 0.0 {
        return tube;
    }
    let far = ball_chord(b.d, m + s.length * b.h * s.axis, large);
    let first = part_at(b, s, m, tube.enters);
    let last = part_at(b, s, m, tube.leaves);
    let entered = chord_at(near, tube, far, first);
    let left = chord_at(near, tube, far, last);
    if entered.below < 0.0 {
        return entered;
    }
    return Chord(entered.enters, max(left.leaves, entered.enters), min(entered.below, max(left.below, 0.0)));
}

// Where the point at t lies along the segment: -1 before its end, 1 beyond its other end, else 0.
fn part_at(b: Bundle, s: Capsule, m: real3, t: real) -> i32 {
    let place = (t * dot(b.d, s.axis) - dot(m, s.axis)) / b.h;
    return select(0, 1, place > s.length) - select(0, 1, place < 0.0);
}

fn chord_at(near: Chord, tube: Chord, far: Chord, part: i32) -> Chord {
    if part < 0 {
        return near;
    }
    if part > 0 {
        return far;
    }
    return tube;
}

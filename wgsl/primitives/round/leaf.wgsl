// Leaves of a hierarchy that hold triangles, spheres and capsules.

#import hierarchy/segment.wgsl
#import primitives/round/kinds.wgsl

fn nearer_solid(segment: Segment, found: Found, leaf: LeafTriangle) -> Found {
    if leaf.is_round == 0u {
        return nearer(segment, found, leaf);
    }
    return nearer_round(segment, found, leaf);
}

// Units of m . m and r^2 by which their difference is off: places and radius are rounded, 2 units each, m is a difference, and there are two
// squares, three products and three sums. A segment that starts so near to a surface starts on it, and does not meet it there.
const ON_SURFACE: f32 = 16.0 / 16777216.0;

// Where a segment enters and leaves the ball or tube |s d - m| = r; `below` under 0: it passes.
struct Passage {
    enters: f32,
    leaves: f32,
    below: f32,
}

// `below` is d . d r^2 - |d x m|^2.
fn passage(d: vec3<f32>, m: vec3<f32>, r: f32, below: f32) -> Passage {
    let a = dot(d, d);
    let root = sqrt(max(below, 0.0));
    let along = dot(d, m);
    let far = along + select(root, -root, along < 0.0);
    let beyond = dot(m, m) - r * r;
    let is_on = abs(beyond) <= ON_SURFACE * (dot(m, m) + r * r);
    let one = far / a;
    let other = select(beyond / far, 0.0, is_on || far == 0.0);
    return Passage(min(one, other), max(one, other), below);
}

fn ball_passage(d: vec3<f32>, m: vec3<f32>, r: f32) -> Passage {
    let w = cross(d, m);
    return passage(d, m, r, dot(d, d) * r * r - dot(w, w));
}

// As wgsl/primitives/round/chord.wgsl. Along a parallel segment the tube has no ends.
fn capsule_passage(d: vec3<f32>, m: vec3<f32>, axis: vec3<f32>, r: f32) -> Passage {
    let size = length(axis);
    let u = axis / size;
    let across = cross(d, u);
    let away = cross(m, u);
    let a = dot(across, across);
    let w = dot(u, cross(d, m));
    var tube = passage(across, away, r, a * r * r - w * w);
    if a <= 1.0e-12 * dot(d, d) {
        tube = Passage(-1.0e30, 1.0e30, r * r - dot(away, away));
    }
    if tube.below < 0.0 {
        return tube;
    }
    let slope = dot(d, u);
    let offset = dot(m, u);
    let near = ball_passage(d, m, r);
    let far = ball_passage(d, m + axis, r);
    var entered = tube;
    if tube.enters * slope < offset {
        entered = near;
    } else if tube.enters * slope > offset + size {
        entered = far;
    }
    var left = tube;
    if tube.leaves * slope < offset {
        left = near;
    } else if tube.leaves * slope > offset + size {
        left = far;
    }
    return Passage(entered.enters, max(entered.enters, left.leaves), entered.below);
}

// The nearer of a previous hit and a sphere or capsule, from either side; of equals the smaller id.
fn nearer_round(segment: Segment, found: Found, leaf: LeafTriangle) -> Found {
    let r = leaf.v1.x;
    let m = leaf.v0 - segment.p;
    var own = ball_passage(segment.d, m, r);
    let axis = leaf.v2 - leaf.v0;
    if CAPSULES && any(axis != vec3<f32>(0.0)) {
        own = capsule_passage(segment.d, m, axis, r);
    }
    let s = select(own.leaves, own.enters, own.enters > segment.first);
    let in_range = s > segment.first && s <= segment.last;
    if own.below >= 0.0 && in_range && (s < found.s || (s == found.s && leaf.id < found.id)) {
        return Found(s, leaf.id);
    }
    return found;
}

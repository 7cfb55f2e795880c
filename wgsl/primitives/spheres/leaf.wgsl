// Leaves of a hierarchy that hold triangles and spheres.

#import hierarchy/segment.wgsl

fn nearer_solid(segment: Segment, found: Found, leaf: LeafTriangle) -> Found {
    if leaf.is_sphere == 0u {
        return nearer(segment, found, leaf);
    }
    return nearer_sphere(segment, found, leaf);
}

// Units of m . m and r^2 by which their difference is off: places and radius are rounded, 2 units each, m is a difference, and there are two
// squares, three products and three sums. A segment that starts so near to a sphere starts on it, and does not meet it there.
const ON_SPHERE: f32 = 16.0 / 16777216.0;

// The nearer of a previous hit and a sphere, from either side; of equals the smaller id.
fn nearer_sphere(segment: Segment, found: Found, leaf: LeafTriangle) -> Found {
    let r = leaf.v1.x;
    let m = leaf.v0 - segment.p;
    let w = cross(segment.d, m);
    let a = dot(segment.d, segment.d);
    let below = a * r * r - dot(w, w);
    let root = sqrt(max(below, 0.0));
    let along = dot(segment.d, m);
    let far = along + select(root, -root, along < 0.0);
    let beyond = dot(m, m) - r * r;
    let is_on = abs(beyond) <= ON_SPHERE * (dot(m, m) + r * r);
    let one = far / a;
    let other = select(beyond / far, 0.0, is_on || far == 0.0);
    let enters = min(one, other);
    let leaves = max(one, other);
    let s = select(leaves, enters, enters > segment.first);
    let in_range = s > segment.first && s <= segment.last;
    if below >= 0.0 && in_range && (s < found.s || (s == found.s && leaf.id < found.id)) {
        return Found(s, leaf.id);
    }
    return found;
}

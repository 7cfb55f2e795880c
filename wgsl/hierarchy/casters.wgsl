// The first hit of a segment, by a bounding volume hierarchy.

#import hierarchy/segment.wgsl
#import masks/leaf
#import shading/casters
#import shared/params.wgsl

// Stack size; the host refuses deeper hierarchies.
const STACK: u32 = 96u;

// Rounding of where a box is entered and left: 2 gamma_3 (Ize 2013).
const MARGIN: f32 = 1.0000004;

// Where the segment enters a box, and whether that is before the hit found so far.
struct Entry {
    s: f32,
    enters: bool,
}

fn entry(node: BvhNode, segment: Segment, inverse: vec3<f32>, nearest: f32) -> Entry {
    let a = (node.lo - segment.p) * inverse;
    let b = (node.hi - segment.p) * inverse;
    let near = min(a, b);
    let far = max(a, b);
    let enters = max(max(near.x, near.y), max(near.z, segment.first));
    let leaves = min(min(far.x, far.y), min(far.z, min(nearest, segment.last)));
    // ends of t below 0 have their margin on the other side
    return Entry(enters, enters <= max(leaves * MARGIN, leaves / MARGIN));
}

fn traced(segment: Segment) -> Found {
    var found = nothing();
    // where a segment runs along a side of a box, 0 times infinity would be no number
    let least = vec3<f32>(1.0e-20);
    let inverse = 1.0 / select(segment.d, least, abs(segment.d) < least);
    var waiting: array<u32, STACK>;
    var count = 0u;
    var at = first_node();
    loop {
        let node = node_at(at);
        var next = NONE;
        if node.count > 0u {
            for (var k = 0u; k < node.count; k++) {
                found = nearer_leaf(segment, found, leaf_at(node.first + k));
            }
        } else {
            let one = entry(node_at(node.first), segment, inverse, found.s);
            let other = entry(node_at(node.first + 1u), segment, inverse, found.s);
            let second_first = u32(other.enters && (!one.enters || other.s < one.s));
            if one.enters || other.enters {
                next = node.first + second_first;
            }
            if one.enters && other.enters {
                waiting[count] = node.first + 1u - second_first;
                count++;
            }
        }
        if next == NONE {
            if count == 0u {
                break;
            }
            count--;
            next = waiting[count];
        }
        at = next;
    }
    return found;
}

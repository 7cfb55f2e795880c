// Leaves of a hierarchy that hold triangles alone.

#import hierarchy/segment.wgsl

fn nearer_solid(segment: Segment, found: Found, leaf: LeafTriangle) -> Found {
    return nearer(segment, found, leaf);
}

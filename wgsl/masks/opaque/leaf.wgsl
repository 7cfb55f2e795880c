// Leaves of a hierarchy without alpha masks.

#import hierarchy/segment.wgsl
#import primitives/leaf

fn nearer_leaf(segment: Segment, found: Found, leaf: LeafTriangle) -> Found {
    return nearer_solid(segment, found, leaf);
}

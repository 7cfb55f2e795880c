// Leaves of a hierarchy that hold triangles alone.
// Provides: nearer_leaf
// Needs: Found, LeafTriangle, Segment, nearer

fn nearer_leaf(segment: Segment, found: Found, leaf: LeafTriangle) -> Found {
    return nearer(segment, found, leaf);
}

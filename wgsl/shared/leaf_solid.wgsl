// Leaves of a hierarchy without alpha masks.
// Provides: nearer_leaf
// Needs: Found, LeafTriangle, Segment, nearer_solid

fn nearer_leaf(segment: Segment, found: Found, leaf: LeafTriangle) -> Found {
    return nearer_solid(segment, found, leaf);
}

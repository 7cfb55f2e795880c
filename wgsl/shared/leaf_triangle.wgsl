// Leaves of a hierarchy that hold triangles alone.
// Provides: nearer_solid
// Needs: Found, LeafTriangle, Segment, nearer

fn nearer_solid(segment: Segment, found: Found, leaf: LeafTriangle) -> Found {
    return nearer(segment, found, leaf);
}

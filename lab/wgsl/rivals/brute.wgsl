// What a segment meets first, by testing every triangle.
// Provides: traced
// Needs: Found, Segment, nearer, nothing
// Binds: leaves

fn traced(segment: Segment) -> Found {
    var found = nothing();
    for (var k = 0u; k < arrayLength(&leaves); k++) {
        found = nearer(segment, found, leaves[k]);
    }
    return found;
}

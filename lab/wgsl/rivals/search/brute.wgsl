// What a segment meets first, by testing every triangle.

#import hierarchy/segment.wgsl

var<storage, read> leaves: array<LeafTriangle>;

fn traced(segment: Segment) -> Found {
    var found = nothing();
    for (var k = 0u; k < arrayLength(&leaves); k++) {
        found = nearer(segment, found, leaves[k]);
    }
    return found;
}

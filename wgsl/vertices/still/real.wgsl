// Vertices in recheck arithmetic.

#import arithmetic
#import vertices/still/vertex.wgsl
#import vertices/vertex

// A vertex relative to the anchor, as stored.
fn vertex_real(index: u32) -> real3 {
    return real3(vertex(index)) + real3(vertex_lo(index));
}

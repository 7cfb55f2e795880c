// Vertices in recheck arithmetic.
// Provides: vertex_real
// Needs: real3, vertex, vertex_lo

// A vertex relative to the anchor, as stored.
fn vertex_real(index: u32) -> real3 {
    return real3(vertex(index)) + real3(vertex_lo(index));
}

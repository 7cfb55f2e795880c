// Vertices at the moment of this thread's pixel, in recheck arithmetic.

#import arithmetic
#import vertices/timed/vertex.wgsl

fn vertex_real_at_step(index: u32, step: u32) -> real3 {
    return real3(vertex_at_step(index, step)) + real3(vertex_lo_at_step(index, step));
}

// A vertex relative to the anchor.
fn vertex_real(index: u32) -> real3 {
    let from_step = vertex_real_at_step(index, moment_step);
    return from_step + real(moment_share) * (vertex_real_at_step(index, next_step()) - from_step);
}

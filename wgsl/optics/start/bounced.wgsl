// Rays that start on a surface and do not hit it at their origin.

#import optics/layout.wgsl

// No bounced ray hits the triangle.
fn is_excluded(id: u32) -> bool {
    return id >= optic.first_id && optic.sees_itself == 0u;
}

// The triangle that the pixel's ray starts on.
fn start_of(pixel: u32) -> u32 {
    return paths[pixel].last;
}

// Rays that start on no triangle: the camera's own.

#import shared/params.wgsl

fn is_excluded(id: u32) -> bool {
    return false;
}

// The triangle that the pixel's ray starts on.
fn start_of(pixel: u32) -> u32 {
    return NONE;
}

// Share of a triangle in a pixel: the number of samples that see it.

#import resolve.wgsl
#import samples/cells.wgsl

fn measure(pixel: u32, record: u32) {}

fn share_of(k: u32, some: u32) -> f32 {
    return f32(countOneBits(some));
}

// The samples that see the same triangle as the first one left.
fn seen_next(k: u32, record: u32, left: u32) -> u32 {
    return seen_alike(record, left);
}

// The sum of all shares.
fn whole() -> f32 {
    return f32(SAMPLES);
}

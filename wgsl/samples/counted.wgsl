// What share of a pixel triangles have: the number of its samples that see them.
// Provides: measure, seen_next, share_of, whole
// Needs: SAMPLES, seen_alike

fn measure(pixel: u32, row: u32) {}

fn share_of(k: u32, some: u32) -> f32 {
    return f32(countOneBits(some));
}

// The samples that see what the first of those left does.
fn seen_next(k: u32, row: u32, left: u32) -> u32 {
    return seen_alike(row, left);
}

// That all shares come to.
fn whole() -> f32 {
    return f32(SAMPLES);
}

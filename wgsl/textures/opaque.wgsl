// No surface has an alpha mask, and none is blended.
// Provides: take_place

fn take_place(pixel: vec2<u32>) {}

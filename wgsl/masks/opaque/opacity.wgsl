// No surface has an alpha mask, and none is blended.

fn take_place(pixel: vec2<u32>) {}

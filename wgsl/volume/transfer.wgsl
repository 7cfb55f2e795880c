// The transfer function: what values look like.

#import volume/layout.wgsl

// The piece of the transfer function that begins at a value or holds it: the first one that ends behind it. Without a loop: software
// drivers count the rounds of all loops of a thread.
fn piece_of(value: f32) -> u32 {
    var j = select(0u, 32u, medium.value[31].y <= value);
    j += select(0u, 16u, medium.value[j + 15u].y <= value);
    j += select(0u, 8u, medium.value[j + 7u].y <= value);
    j += select(0u, 4u, medium.value[j + 3u].y <= value);
    j += select(0u, 2u, medium.value[j + 1u].y <= value);
    return j + select(0u, 1u, medium.value[j].y <= value);
}

// Colour and extinction of a value in its piece.
fn look(j: u32, value: f32) -> vec4<f32> {
    return medium.point[j] + (value - medium.value[j].x) * medium.slope[j];
}

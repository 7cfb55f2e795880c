// Where a triangle is shaded that some samples of a pixel see, and how wide it is filtered there, as rasterizers do: at the pixel's centre,
// over the whole pixel.

struct Part {
    middle: vec2<f32>,  // px from the pixel's centre, right and down
    sides: vec2<f32>,   // px
}

fn part_of(some: u32) -> Part {
    return Part(vec2<f32>(0.0), vec2<f32>(1.0));
}

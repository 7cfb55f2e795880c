// Where a triangle is shaded that some samples of a pixel see, and how wide it is filtered there: the part of the pixel that they stand for, as
// a box.

#import samples/cells.wgsl
#import samples/offsets.wgsl

struct Part {
    middle: vec2<f32>,  // px from the pixel's centre, right and down
    sides: vec2<f32>,   // px
}

// Each sample is the middle of a column and of a row of its own, 1 / SAMPLES px wide, so all of them have the variance of the pixel: a box's is
// its side squared over 12. The area is that of as many samples.
fn part_of(some: u32) -> Part {
    var sum = vec2<f32>(0.0);
    var squares = vec2<f32>(0.0);
    for (var others = some; others != 0u; others &= others - 1u) {
        let off = sample_offset(firstTrailingBit(others));
        sum += off;
        squares += off * off;
    }
    let count = f32(countOneBits(some));
    let all = f32(SAMPLES);
    let middle = sum / count;
    let variance = max(squares / count - middle * middle, vec2<f32>(0.0)) + 1.0 / (12.0 * all * all);
    let sides = sqrt(12.0 * variance);
    return Part(middle, sides * sqrt(count / all / (sides.x * sides.y)));
}

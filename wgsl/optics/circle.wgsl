// Cosine and sine, also in f64, which WGSL's built-ins lack.

#import arithmetic

const TWO_PI: real = 6.283185307179586;

// Cosine and sine of an angle in revolutions, each within 4 roundings; for small angles the sine within 4 roundings of itself: the nearest
// quarter is taken off without a rounding, and Taylor's series of what is left, an eighth at most, are cut off at 2^-60 and
// 2^-58. Whole revolutions are counted in f32: up to 2^20.
fn circle(revolutions: real) -> vec2<real> {
    let part = revolutions - real(round(f32(revolutions)));
    let quarter = round(4.0 * f32(part));
    let x = TWO_PI * (part - real(0.25) * real(quarter));
    let xx = x * x;
    let c = 1.0 + xx * (-0.5 + xx * (0.041666666666666664 + xx * (-0.001388888888888889 + xx * (2.48015873015873e-05 + xx * (-2.755731922398589e-07 + xx * (2.08767569878681e-09 + xx * (-1.1470745597729725e-11 + xx * (4.779477332387385e-14))))))));
    let s = x + x * xx * (-0.16666666666666666 + xx * (0.008333333333333333 + xx * (-0.0001984126984126984 + xx * (2.7557319223985893e-06 + xx * (-2.505210838544172e-08 + xx * (1.6059043836821613e-10 + xx * (-7.647163731819816e-13)))))));
    if abs(quarter) == 2.0 {
        return vec2<real>(-c, -s);
    }
    if quarter == 1.0 {
        return vec2<real>(-s, c);
    }
    if quarter == -1.0 {
        return vec2<real>(s, -c);
    }
    return vec2<real>(c, s);
}

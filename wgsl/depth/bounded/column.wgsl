// The rays of one column of a tile in f32: of its four upper pixels, then of its four lower ones.

// Origins, less a point, and directions of four pixels below each other, with bounds on the sums of the errors of their components.
// Directions have sizes of 1/2 to 1: they were divided by `back`, a power of two. All is 0 of a ray of which f32 knows nothing.
struct Strip {
    px: vec4<f32>,
    py: vec4<f32>,
    pz: vec4<f32>,
    error_p: vec4<f32>,
    dx: vec4<f32>,
    dy: vec4<f32>,
    dz: vec4<f32>,
    error_d: vec4<f32>,
    back: vec4<f32>,
}

struct Column {
    upper: Strip,
    lower: Strip,
    has_upper: vec4<bool>,      // a ray
    has_lower: vec4<bool>,
}

const ZERO: vec4<f32> = vec4<f32>(0.0);
const NO_STRIP: Strip = Strip(ZERO, ZERO, ZERO, ZERO, ZERO, ZERO, ZERO, ZERO, vec4<f32>(1.0));

fn either(a: Strip, b: Strip, is_b: vec4<bool>) -> Strip {
    return Strip(
        select(a.px, b.px, is_b), select(a.py, b.py, is_b), select(a.pz, b.pz, is_b), select(a.error_p, b.error_p, is_b),
        select(a.dx, b.dx, is_b), select(a.dy, b.dy, is_b), select(a.dz, b.dz, is_b), select(a.error_d, b.error_d, is_b),
        select(a.back, b.back, is_b),
    );
}

fn size4(x: vec4<f32>, y: vec4<f32>, z: vec4<f32>) -> vec4<f32> {
    return abs(x) + abs(y) + abs(z);
}

// Sizes of a ray that f32 does not take for 0 or infinite.
const SIZE_LEAST: f32 = 1.0e-25;
const SIZE_MOST: f32 = 1.0e30;

// A strip from origins and directions of any size.
fn strip_of(p: array<vec4<f32>, 3>, error_p: vec4<f32>, d: array<vec4<f32>, 3>, error_d: vec4<f32>, is_sure: vec4<bool>) -> Strip {
    let size_d = size4(d[0], d[1], d[2]);
    let size_p = size4(p[0], p[1], p[2]) + error_p;
    let is_known = is_sure & (size_d > vec4<f32>(SIZE_LEAST)) & (size_d < vec4<f32>(SIZE_MOST)) & (size_p < vec4<f32>(SIZE_MOST));
    let exponent = clamp(bitcast<vec4<u32>>(size_d) >> vec4<u32>(23u), vec4<u32>(1u), vec4<u32>(252u));
    let share = bitcast<vec4<f32>>((253u - exponent) << vec4<u32>(23u));
    let back = bitcast<vec4<f32>>((exponent + 1u) << vec4<u32>(23u));
    let strip = Strip(p[0], p[1], p[2], error_p, d[0] * share, d[1] * share, d[2] * share, error_d * share, back);
    return either(NO_STRIP, strip, is_known);
}

// Of four pixels or rays those that are so, as bits.
fn row_bits(is_so: vec4<bool>) -> u32 {
    let bits = select(vec4<u32>(0u), vec4<u32>(1u, 2u, 4u, 8u), is_so);
    return bits.x | bits.y | bits.z | bits.w;
}

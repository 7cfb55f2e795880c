// Whether rays whose origins and directions lie in boxes may pass through a point.

// Relative rounding of a quotient, 2.5 units in the last place, and of the product with this: space for eight units.
const QUOTIENT_TOLERANCE: f32 = 1e-6;

fn least(v: vec3<f32>) -> f32 {
    return min(v.x, min(v.y, v.z));
}

fn most(v: vec3<f32>) -> f32 {
    return max(v.x, max(v.y, v.z));
}

// Some s t in `range`, 0 <= t, takes a ray with directions s D to the point: t d_lo <= above and t d_hi >= -below, where
// `above` and `below` are the point's distances from the lower and the upper ends of the origins.
fn half_meets(above: vec3<f32>, below: vec3<f32>, d_lo: vec3<f32>, d_hi: vec3<f32>, range: vec2<f32>) -> bool {
    let zero = vec3<f32>(0.0);
    if any((d_lo == zero) & (above < zero)) || any((d_hi == zero) & (below < zero)) {
        return false;
    }
    let t_lo = above / d_lo;
    let t_hi = -below / d_hi;
    let far = vec3<f32>(range.y);
    let near = vec3<f32>(range.x);
    let hi = min(least(select(far, t_lo, d_lo > zero)), least(select(far, t_hi, d_hi < zero)));
    let lo = max(most(select(near, t_lo, d_lo < zero)), most(select(near, t_hi, d_hi > zero)));
    return max(lo, range.x) * (1.0 - QUOTIENT_TOLERANCE) <= min(hi, range.y) * (1.0 + QUOTIENT_TOLERANCE);
}

// Cubic polynomials over [0, 1] by their Bernstein coefficients. What is interpolated trilinearly is one of them along a line.

// What is interpolated trilinearly of a cell's eight corners, from one place of the cell to another. `lo` are the corners with x = 0 and
// `hi` those with x = 1, in the order (y, z) = 00, 10, 01, 11. Coefficient k is the mean of values with k of the three coordinates from the
// second place.
fn along(lo: vec4<f32>, hi: vec4<f32>, a: vec3<f32>, b: vec3<f32>) -> vec4<f32> {
    let x0 = mix(lo, hi, a.x);
    let x1 = mix(lo, hi, b.x);
    let x0y0 = mix(x0.xz, x0.yw, a.y);
    let x0y1 = mix(x0.xz, x0.yw, b.y);
    let x1y0 = mix(x1.xz, x1.yw, a.y);
    let x1y1 = mix(x1.xz, x1.yw, b.y);
    let one = mix(x1y0.x, x1y0.y, a.z) + mix(x0y1.x, x0y1.y, a.z) + mix(x0y0.x, x0y0.y, b.z);
    let two = mix(x1y1.x, x1y1.y, a.z) + mix(x1y0.x, x1y0.y, b.z) + mix(x0y1.x, x0y1.y, b.z);
    return vec4<f32>(mix(x0y0.x, x0y0.y, a.z), one / 3.0, two / 3.0, mix(x1y1.x, x1y1.y, b.z));
}

// The same polynomial over [a, b] instead, by blossoms.
fn part_of(c: vec4<f32>, a: f32, b: f32) -> vec4<f32> {
    let at_a = mix(c.xyz, c.yzw, a);
    let at_b = mix(c.xyz, c.yzw, b);
    let aa = mix(at_a.xy, at_a.yz, a);
    let ab = mix(at_a.xy, at_a.yz, b);
    let bb = mix(at_b.xy, at_b.yz, b);
    return vec4<f32>(mix(aa.x, aa.y, a), mix(aa.x, aa.y, b), mix(ab.x, ab.y, b), mix(bb.x, bb.y, b));
}

// The polynomial lies between these.
fn least(c: vec4<f32>) -> f32 {
    return min(min(c.x, c.y), min(c.z, c.w));
}

fn most(c: vec4<f32>) -> f32 {
    return max(max(c.x, c.y), max(c.z, c.w));
}

// Its integral.
fn mean(c: vec4<f32>) -> f32 {
    return 0.25 * (c.x + c.y + c.z + c.w);
}

// The integral of a product of two.
fn inner(a: vec4<f32>, b: vec4<f32>) -> f32 {
    let next = a.xyz * b.yzw + a.yzw * b.xyz;
    let second = a.xy * b.zw + a.zw * b.xy;
    let same = a * b;
    return (same.x + same.w + 0.6 * (same.y + same.z) + 0.5 * (next.x + next.z) + 0.45 * next.y + 0.2 * (second.x + second.y)
        + 0.05 * (a.x * b.w + a.w * b.x)) / 7.0;
}

// The mean of an image over a footprint: up to TAPS_MAX trilinear taps along the longer axis of the ellipse that has the
// footprint's second moments.
//
// A tap at level l, 2^l texels wide, has a variance of (4^l - 1) / 12 from the means of the level's texels and of 4^l / 6 from
// bilinear weights between them. A box w texels wide over bilinear weights between texels has w^2 / 12 + 1/6. They are equal
// where 4^l = 1 + w^2 / 3: no level is sharper than the first, and none is blurred more than the pixel itself.
//
// The surface's cosine to the ray is taken to change linearly along the axis. With tau along the surface, in lengths of the footprint on
// the flat triangle, and s across the pixel, from -1/2 to 1/2:
//   ds = (1 + bend tau) dtau,  s = tau + bend tau^2 / 2,  tau = 2 s / (1 + sqrt(1 + 2 bend s))
// The footprint ends at s = 1/2. It begins at s = -1/2, or at tau = -1 / bend if this horizon lies within the pixel: the cosine is 0 there.
// Taps are evenly spaced in tau, so each has the weight 1 + bend tau.

#import shading/materials/material.wgsl
#import shading/textures/layout.wgsl
#import shading/textures/levels.wgsl
#import shading/textures/mapped.wgsl

const TAPS_MAX: f32 = 16.0;

fn image_mean(m: Material, f: Footprint) -> vec3<f32> {
    // the ellipse's axes, texels
    let size = vec2<f32>(m.size);
    let a = f.right * size;
    let b = f.down * size;
    let xx = a.x * a.x + b.x * b.x;
    let yy = a.y * a.y + b.y * b.y;
    let xy = a.x * a.y + b.x * b.y;
    let half = 0.5 * (xx - yy);
    let root = sqrt(half * half + xy * xy);
    let major = sqrt(0.5 * (xx + yy) + root);
    let minor = abs(a.x * b.y - a.y * b.x) / max(major, 1e-30);
    let vector = select(vec2<f32>(half + root, xy), vec2<f32>(xy, root - half), xx < yy);
    let axis = select(vec2<f32>(1.0, 0.0), vector / length(vector), root > 0.0);

    // edge-on nothing is known but the whole
    let grows = dot(f.bend, vec2<f32>(dot(a, axis), dot(b, axis))) / max(major, 1e-30);
    let is_known = major < 1e9 && abs(grows) < 1e9;
    let bend = select(0.0, abs(grows), is_known);
    let begin = -1.0 / (max(bend, 1.0) + sqrt(max(1.0 - bend, 0.0)));
    let end = 1.0 / (1.0 + sqrt(1.0 + bend));
    let long = major * (end - begin);
    let taps = select(1.0, clamp(ceil(long / max(minor, 1.0)), 1.0, TAPS_MAX), is_known);
    let width = max(minor, long / taps);
    let level = select(f32(m.levels - 1u), 0.5 * log2(1.0 + width * width / 3.0), is_known);
    let upward = select(axis, -axis, grows < 0.0);
    let step = select(vec2<f32>(0.0), upward * (long / taps) / size, is_known);
    let first = taps * begin / (end - begin);
    let weight_step = bend * (end - begin) / taps;
    var sum = vec4<f32>(0.0);
    for (var k = 0.5; k < taps; k += 1.0) {
        sum += (1.0 + (first + k) * weight_step) * trilinear(m, f.uv + (first + k) * step, level);
    }
    // colours are stored times their opacity
    return sum.xyz / max(sum.w, 1e-6 * taps);
}

fn trilinear(m: Material, uv: vec2<f32>, level: f32) -> vec4<f32> {
    let whole = min(u32(level), m.levels - 1u);
    let part = level - f32(whole);
    let place = vec2<f32>(into_image(uv.x, wrap_u(m.texture)), into_image(uv.y, wrap_v(m.texture)));
    let fine = bilinear(m, place, whole);
    if whole + 1u >= m.levels || part <= 0.0 {
        return fine;
    }
    return mix(fine, bilinear(m, place, whole + 1u), min(part, 1.0));
}

// The mean of an image over a footprint: up to TAPS_MAX trilinear taps along the longer axis of the ellipse that has the
// footprint's second moments.
//
// A tap at level l, 2^l texels wide, has a variance of (4^l - 1) / 12 from the means of the level's texels and of 4^l / 6 from
// bilinear weights between them. A box w texels wide over bilinear weights between texels has w^2 / 12 + 1/6. They are equal
// where 4^l = 1 + w^2 / 3: no level is sharper than the first, and none is blurred more than the pixel itself.

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
    let way = select(vec2<f32>(half + root, xy), vec2<f32>(xy, root - half), xx < yy);
    let axis = select(vec2<f32>(1.0, 0.0), way / length(way), root > 0.0);

    // edge-on nothing is known but the whole
    let is_known = major < 1e9;
    let taps = select(1.0, clamp(ceil(major / max(minor, 1.0)), 1.0, TAPS_MAX), is_known);
    let width = max(minor, major / taps);
    let level = select(f32(m.levels - 1u), 0.5 * log2(1.0 + width * width / 3.0), is_known);
    let step = select(vec2<f32>(0.0), axis * (major / taps) / size, is_known);
    var sum = vec4<f32>(0.0);
    for (var k = 0.0; k < taps; k += 1.0) {
        sum += trilinear(m, f.uv + (k - 0.5 * (taps - 1.0)) * step, level);
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

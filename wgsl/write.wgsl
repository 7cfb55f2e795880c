// write: one thread per pixel of the band. Reads the colour planes; writes 8-bit sRGB with alpha 255, four bytes a word.

// The sRGB curve of IEC 61966-2-1.
fn srgb(linear: f32) -> u32 {
    let c = clamp(linear, 0.0, 1.0);
    let encoded = select(1.055 * pow(c, 1.0 / 2.4) - 0.055, 12.92 * c, c <= 0.0031308);
    return u32(encoded * 255.0 + 0.5);
}

@compute @workgroup_size(64)
fn write(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    // take a pixel
    let pixel = item_index(group, groups, lane);
    let count = params.width * params.height;
    if pixel >= count {
        return;
    }
    // encode it
    let r = bitcast<f32>(planes[PLANE_R * count + pixel]);
    let g = bitcast<f32>(planes[PLANE_G * count + pixel]);
    let b = bitcast<f32>(planes[PLANE_B * count + pixel]);
    srgb8[pixel] = srgb(r) | (srgb(g) << 8u) | (srgb(b) << 16u) | 0xff000000u;
}

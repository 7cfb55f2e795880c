// What a fragment leaves at all samples that its triangle covers, in the picture that take_samples reads.

struct Drawn {
    @location(0) seen: vec4<u32>,   // layer and id, and the bits of t at the pixel's centre: a low and a high half of each
}

fn drawn(layer: u32, id: u32, t: f32) -> Drawn {
    let first = (layer << 28u) | id;
    let second = bitcast<u32>(t);
    return Drawn(vec4<u32>(first & 0xffffu, first >> 16u, second & 0xffffu, second >> 16u));
}

// The least w, of pieces whose rays all start in one point.
const NEAR: f32 = 0x1p-20;

// Depth is NEAR / w at each sample: larger is nearer.
fn clip_depth(w: f32) -> f32 {
    return NEAR;
}

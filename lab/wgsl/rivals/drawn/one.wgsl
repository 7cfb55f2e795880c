// What a fragment leaves in the picture that take reads.

#import rivals/drawing.wgsl

struct Drawn {
    @location(0) seen: vec2<u32>,       // layer and id, and the bits of t
    @builtin(frag_depth) depth: f32,    // larger is nearer, those of lower layers first
}

fn drawn(layer: u32, id: u32, t: f32) -> Drawn {
    let near = 0.5 / (1.0 + abs(t));
    let depth = select(1.0 - near, near, t >= 0.0);
    // a chain's t is in [0, 1]; of a lone layer all of the depth's bits are its t's
    let sorted = select((f32(LAYERS - 1u - layer) + depth) / f32(LAYERS), depth, LAYERS == 1u);
    return Drawn(vec2<u32>((layer << 28u) | id, bitcast<u32>(t)), sorted);
}

// Of a corner at `w`: within what is kept, since the fragment says its depth itself.
fn clip_depth(w: f32) -> f32 {
    return 0.5 * w;
}

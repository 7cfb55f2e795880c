// Ambient light arrives from all around.

#import shading/surface.wgsl

fn openness(lit: Lit) -> f32 {
    return 1.0;
}

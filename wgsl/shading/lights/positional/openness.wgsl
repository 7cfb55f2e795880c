// No shadows.

#import shading/surface.wgsl

fn reaches(lit: Lit, l: vec3<f32>, far: f32) -> bool {
    return true;
}

fn openness(lit: Lit) -> f32 {
    return 1.0;
}

// Diffuse reflection.

#import shading/surface.wgsl

fn sent_back(lit: Lit, albedo: vec3<f32>) -> vec3<f32> {
    return albedo * received(lit);
}

// Surfaces as they are lit.

#import shading/styles/shaded_hit.wgsl

const STYLED: bool = false;

fn pattern_at(hit: ShadedHit) -> vec3<f32> {
    return vec3<f32>(1.0);
}

fn drawn(hit: ShadedHit, n: vec3<f32>, colour: vec3<f32>) -> vec3<f32> {
    return colour;
}

// No pictures are thrown onto surfaces.

#import rays/ray.wgsl
#import shading/surface.wgsl

const PICTURES: bool = false;

struct Painted {
    lit: vec3<f32>,
    seen: vec3<f32>,
}

fn painted(lit: Lit, differential: RayDifferential, albedo: vec3<f32>) -> Painted {
    return Painted(albedo, vec3<f32>(0.0));
}

fn thrown(k: u32, lit: Lit) -> Arriving {
    return Arriving(vec3<f32>(0.0), vec3<f32>(0.0));
}

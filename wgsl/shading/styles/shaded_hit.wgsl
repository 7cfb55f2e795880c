// A hit to be shaded.

#import rays/ray.wgsl

struct ShadedHit {
    slot: u32,
    p: vec3<f32>,           // relative to the anchor
    z: f32,                 // along the whole path
    d: vec3<f32>,           // the ray's direction
    differential: RayDifferential,
    share: f32,             // of the pixel's width, that it stands for
}

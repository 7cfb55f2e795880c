// Materials of triangles.

struct Material {
    diffuse: vec3<f32>,
    texture: u32,           // how its image goes on beyond its borders, two bits each way: repeat, clamp, mirror; NONE: it has no image
    origin: vec2<u32>,      // of the image's first level in its page, texels; its size
    size: vec2<u32>,
    page: u32,
    levels: u32,
    span: u32,              // see level_origin
    cutoff: f32,            // the least opacity at which there is a surface
    specular: vec3<f32>,    // reflected straight on, of what is no metal
    alpha: f32,             // of its microfacets: the square of its roughness
    emissive: vec3<f32>,
    metallic: f32,
    pattern_light: vec3<f32>,   // of what the diffuse colour is multiplied by too; which, 0: nothing
    pattern: u32,
    pattern_dark: vec3<f32>,
    pattern_size: f32,          // world units
    opacity: f32,           // of a blended material: the factor of its image's
    is_blended: u32,        // 1: samples see it by its opacity, whatever the cutoff
    pad0: u32,
    pad1: u32,
}

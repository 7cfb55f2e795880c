// Surfaces and materials of triangles, from their tables.
// Provides: Material, material_at, surface_row
// Needs: table_texel
// Binds: materials, surfaces

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
}

const MATERIAL_ROWS: u32 = 7u;

fn material_row(index: u32, k: u32) -> vec4<u32> {
    return textureLoad(materials, table_texel(MATERIAL_ROWS * index + k), 0);
}

fn material_at(index: u32) -> Material {
    let diffuse = material_row(index, 0u);
    let image = material_row(index, 1u);
    let levels = material_row(index, 2u);
    let specular = material_row(index, 3u);
    let emissive = material_row(index, 4u);
    let light = material_row(index, 5u);
    let dark = material_row(index, 6u);
    return Material(
        bitcast<vec3<f32>>(diffuse.xyz), diffuse.w, image.xy, image.zw, levels.x, levels.y, levels.z, bitcast<f32>(levels.w),
        bitcast<vec3<f32>>(specular.xyz), bitcast<f32>(specular.w), bitcast<vec3<f32>>(emissive.xyz), bitcast<f32>(emissive.w),
        bitcast<vec3<f32>>(light.xyz), light.w, bitcast<vec3<f32>>(dark.xyz), bitcast<f32>(dark.w),
    );
}

// A row of the table of surfaces.
fn surface_row(k: u32) -> vec4<u32> {
    return textureLoad(surfaces, table_texel(k), 0);
}

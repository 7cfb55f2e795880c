// The tables of surfaces and of materials.

#import shading/materials/material.wgsl
#import shared/table.wgsl

var materials: texture_2d<u32>;
var surfaces: texture_2d<u32>;

const MATERIAL_ROWS: u32 = 8u;

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
    let blend = material_row(index, 7u);
    return Material(
        bitcast<vec3<f32>>(diffuse.xyz), diffuse.w, image.xy, image.zw, levels.x, levels.y, levels.z, bitcast<f32>(levels.w),
        bitcast<vec3<f32>>(specular.xyz), bitcast<f32>(specular.w), bitcast<vec3<f32>>(emissive.xyz), bitcast<f32>(emissive.w),
        bitcast<vec3<f32>>(light.xyz), light.w, bitcast<vec3<f32>>(dark.xyz), bitcast<f32>(dark.w),
        bitcast<f32>(blend.x), blend.y, 0u, 0u,
    );
}

// A row of the table of surfaces.
fn surface_row(k: u32) -> vec4<u32> {
    return textureLoad(surfaces, table_texel(k), 0);
}

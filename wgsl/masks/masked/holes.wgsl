// Which triangles may have holes, in scenes with alpha masks or blended surfaces.

#import shading/materials/rows.wgsl
#import shading/textures/layout.wgsl

// Whether a triangle is there everywhere.
fn is_solid(slot: u32) -> bool {
    let material = material_at(triangle_surface(slot).w);
    return material.is_blended == 0u && material.cutoff <= 0.0;
}

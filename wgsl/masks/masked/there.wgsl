// Triangles with alpha masks, and blended ones. Whether a point is masked follows from the image's first level alone, whatever the camera: masks
// are part of the scene's shape.

#import arithmetic
#import masks/masked/opacity.wgsl
#import rays/affine_bundle.wgsl
#import shading/materials/material.wgsl
#import shading/materials/rows.wgsl
#import shading/textures/layout.wgsl
#import shading/textures/levels.wgsl
#import shared/params.wgsl
#import vertices/real
#import vertices/triangle.wgsl
#import vertices/vertex

fn is_there(slot: u32, b: Bundle) -> bool {
    let material = material_at(triangle_surface(slot).w);
    let triangle = triangle_at(slot);
    if material.is_blended == 0u && material.cutoff <= 0.0 {
        return true;
    }
    return is_opaque(material, alpha_at(material, slot, triangle, b), triangle_id(triangle));
}

// The opacity of the material's image where a ray meets the triangle; 1 without an image.
fn alpha_at(material: Material, slot: u32, triangle: vec4<u32>, b: Bundle) -> f32 {
    if material.texture == NONE || !has_uv(slot) {
        return 1.0;
    }
    let v0 = vertex_real(triangle.x);
    let v1 = vertex_real(triangle.y);
    let v2 = vertex_real(triangle.z);
    let g0 = cross(b.d, v0 * b.h - b.p);
    let e = real3(dot(v2 - v1, cross(b.d, v1 * b.h - b.p)), dot(v0 - v2, g0), dot(v1 - v0, g0));
    let uv = image_place(corner_uv(slot, triangle), on_triangle(e), material.texture);
    let place = vec2<f32>(into_image(uv.x, wrap_u(material.texture)), into_image(uv.y, wrap_v(material.texture)));
    return bilinear(material, place, 0u).w;
}

// Shadow casters with alpha masks, and blended ones. Two rows for each caster follow the leaves in `lights`: the texture coordinates of its
// corners, v downwards; then, as z, the number of its material, counted from 1, or 0 if it is there everywhere; and as w whether it has texture
// coordinates.

#import hierarchy/segment.wgsl
#import masks/masked/opacity.wgsl
#import primitives/leaf
#import shading/lights/rows.wgsl
#import shading/materials/rows.wgsl
#import shading/numbers.wgsl
#import shading/textures/layout.wgsl
#import shading/textures/levels.wgsl
#import shared/params.wgsl

fn nearer_leaf(segment: Segment, found: Found, leaf: LeafTriangle) -> Found {
    let nearest = nearer_solid(segment, found, leaf);
    if nearest.id != leaf.id || found.id == leaf.id || stops_light(segment, leaf) {
        return nearest;
    }
    return found;
}

// Whether a caster that a segment meets is there at that place.
fn stops_light(segment: Segment, leaf: LeafTriangle) -> bool {
    let of_image = light_row(shading.masks_first + 2u * leaf.id + 1u);
    let number = bitcast<u32>(of_image.z);
    if number == 0u {
        return true;
    }
    let material = material_at(number - 1u);
    if material.texture == NONE || of_image.w == 0.0 {
        return is_opaque(material, 1.0, leaf.id);
    }
    let first = light_row(shading.masks_first + 2u * leaf.id);
    let w = caster_weights(segment, leaf);
    let uv = w.x * first.xy + w.y * first.zw + w.z * of_image.xy;
    let place = vec2<f32>(into_image(uv.x, wrap_u(material.texture)), into_image(uv.y, wrap_v(material.texture)));
    return is_opaque(material, bilinear(material, place, 0u).w, leaf.id);
}

// Weights of the corners where a segment meets a triangle.
fn caster_weights(segment: Segment, triangle: LeafTriangle) -> vec3<f32> {
    let m0 = triangle.v0 - segment.p;
    let m1 = triangle.v1 - segment.p;
    let m2 = triangle.v2 - segment.p;
    let w = vec3<f32>(
        dot(segment.d, cross(triangle.v2 - triangle.v1, m1 + m2)),
        dot(segment.d, cross(triangle.v0 - triangle.v2, m2 + m0)),
        dot(segment.d, cross(triangle.v1 - triangle.v0, m0 + m1)),
    );
    return clamp(w / (w.x + w.y + w.z), vec3<f32>(0.0), vec3<f32>(1.0));
}

// Proofs about alpha masks and blended surfaces, where a straight ray may meet them.

#import arithmetic
#import masks/holes
#import masks/masked/opacity.wgsl
#import masks/masked/there.wgsl
#import rays/coverage
#import rays/straight/triangle_proof.wgsl
#import shading/materials/rows.wgsl
#import shading/textures/layout.wgsl
#import shared/params.wgsl
#import vertices/triangle.wgsl
#import vertices/vertex

// 1: the triangle is proven to be there where the ray meets it, -1: proven to have a hole there; 0: neither. The opacity of an image is
// continuous, and changes by 1 a texel at most.
fn mask_side(slot: u32, q: Weighed, v: array<real3, 3>) -> i32 {
    if is_solid(slot) {
        return 1;
    }
    let material = material_at(triangle_surface(slot).w);
    let triangle = triangle_at(slot);
    let id = triangle_id(triangle);
    if material.texture == NONE || !has_uv(slot) {
        return select(-1, 1, is_opaque(material, 1.0, id));
    }

    // weights of the corners: values of edges, divided by their sum
    let from_v = offset_of(q, v[0]);
    let a = side_value(q, from_v, v[0], v[1]);
    let b = side_value(q, from_v, v[0], v[2]);
    let c = side_value(q, offset_of(q, v[1]), v[1], v[2]);
    let sum = abs(a.value - b.value + c.value);
    let lost = 1.25 * (a.bound + b.bound + c.bound);
    if sum <= 2.0 * lost {
        return 0;
    }
    let lost_weight = f32(2.0 * lost / (sum - lost));

    // texture coordinates: the weights times their differences, and what is lost of them as stored and of a place in f32
    let uv = corner_uv(slot, triangle);
    let range = abs(uv[1] - uv[0]) + abs(uv[2] - uv[0]);
    let most = max(max(abs(uv[0]), abs(uv[1])), max(abs(uv[2]), vec2<f32>(1.0)));
    let lost_uv = 2.0 * lost_weight * range + 4.0 * UNIT * most;
    let texels = vec2<f32>(material.size) * (lost_uv + 4.0 * UNIT);
    let bound = 1.25 * (texels.x + texels.y) + 16.0 * UNIT;

    let alpha = alpha_at(material, slot, triangle, q.b);
    let is_sure = is_opaque(material, alpha - bound, id);
    return select(select(0, -1, !is_opaque(material, alpha + bound, id)), 1, is_sure);
}

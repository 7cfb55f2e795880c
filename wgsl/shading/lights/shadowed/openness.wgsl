// Shadows and ambient occlusion: segments traced through the hierarchy of the scene's triangles.

#import hierarchy/casters.wgsl
#import hierarchy/segment.wgsl
#import primitives/flat
#import shading/numbers.wgsl
#import shading/surface.wgsl
#import shared/params.wgsl
#import vertices/vertex

// Offset of segments above a surface, relative to the largest coordinate of the hit and its triangle.
const ABOVE: f32 = 4e-6;

fn start_above(lit: Lit, flat: vec3<f32>) -> vec3<f32> {
    return lit.p + ABOVE * max(largest(lit.p), lit.reach) * flat;
}

// The first hit of a segment with a unit direction.
fn met(start: vec3<f32>, direction: vec3<f32>, far: f32) -> Found {
    let found = traced(Segment(start * shading.shadow_bvh_scale, direction, 0.0, min(far * shading.shadow_bvh_scale, 3e38)));
    return Found(found.s / shading.shadow_bvh_scale, found.id);
}

// Whether no triangle lies between a hit and a light.
fn reaches(lit: Lit, l: vec3<f32>, far: f32) -> bool {
    let flat = flat_normal(triangle_at(lit.slot), lit.view);
    return dot(flat, l) > 0.0 && met(start_above(lit, flat), l, far).id == NONE;
}

// Ambient visibility: the cosine-weighted share of directions about the normal without an obstacle within reach; far obstacles count
// less. The directions are a Fibonacci spiral on the unit disc, the same at every hit: where triangles meet in a pixel, no line shows.
fn openness(lit: Lit) -> f32 {
    let rays = by_thread(shading.occlusion_rays, lit.slot);
    if rays == 0u {
        return 1.0;
    }
    let flat = flat_normal(triangle_at(lit.slot), lit.view);
    let start = start_above(lit, flat);
    // a frame about the normal (Duff et al. 2017)
    let n = lit.n;
    let side = select(-1.0, 1.0, n.z >= 0.0);
    let a = -1.0 / (side + n.z);
    let b = n.x * n.y * a;
    let right = vec3<f32>(1.0 + side * n.x * n.x * a, side * b, -side * n.x);
    let up = vec3<f32>(b, side + n.y * n.y * a, -n.y);
    var hidden = 0.0;
    for (var k = 0u; k < rays; k++) {
        let square = (f32(k) + 0.5) / f32(rays);
        // angles by the golden section, 2^32 per revolution
        let angle = 6.2831853 / 4294967296.0 * f32(k * 1640531527u);
        let d = sqrt(square) * (cos(angle) * right + sin(angle) * up) + sqrt(1.0 - square) * n;
        if dot(d, flat) > 0.0 {
            let found = met(start, d, shading.occlusion_reach);
            if found.id != NONE {
                hidden += 1.0 - found.s / shading.occlusion_reach;
            }
        }
    }
    return 1.0 - hidden / f32(rays);
}

// Whether a ray of the node may meet the triangle's box.

#import nodes/conics.wgsl
#import nodes/meets.wgsl
#import shared/params.wgsl

fn box_met(node: Node, v0: vec3<f32>, v1: vec3<f32>, v2: vec3<f32>) -> bool {
    let lo = min(v0, min(v1, v2));
    let hi = max(v0, max(v1, v2));
    let rounding = BOUND_TOLERANCE * max(abs(lo), abs(hi));
    return node_meets(node, 0.5 * (lo + hi), 0.5 * (hi - lo) + rounding);
}

// Coherent rays: what a node meets, its rays may meet.

#import shared/params.wgsl

fn tile_meets(x: u32, y: u32, node: Node, centre: vec3<f32>, half: vec3<f32>) -> bool {
    return true;
}

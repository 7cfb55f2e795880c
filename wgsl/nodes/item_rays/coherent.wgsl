// Items of coherent rays: what a node meets, its rays may meet.

#import shared/params.wgsl

fn item_rays(address: u32, node: Node, centre: vec3<f32>, half: vec3<f32>, is_met: bool, thread: u32) -> vec2<u32> {
    return vec2<u32>(0xffffffffu);
}

fn item_meets(address: u32, rays: vec2<u32>, node: Node, centre: vec3<f32>, half: vec3<f32>) -> bool {
    return true;
}

fn item_pixels(address: u32, rays: vec2<u32>, node: Node, centre: vec3<f32>, half: vec3<f32>) -> vec4<u32> {
    return vec4<u32>(0u, 0u, TILE, TILE);
}

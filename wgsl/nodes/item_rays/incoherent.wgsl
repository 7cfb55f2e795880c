// Items of incoherent rays, by single threads. An item of one tile is tested ray by ray.

#import nodes/index.wgsl
#import nodes/tile_rays
#import shared/params.wgsl

// The rays that may meet the boxes of all threads: here all, untested.
fn item_rays(address: u32, node: Node, centre: vec3<f32>, half: vec3<f32>, is_met: bool, thread: u32) -> vec2<u32> {
    return vec2<u32>(0xffffffffu);
}

fn item_meets(address: u32, rays: vec2<u32>, node: Node, centre: vec3<f32>, half: vec3<f32>) -> bool {
    return node_level(address) != 0u || tile_meets(node_x(address), node_y(address), node, centre, half);
}

fn item_pixels(address: u32, rays: vec2<u32>, node: Node, centre: vec3<f32>, half: vec3<f32>) -> vec4<u32> {
    return vec4<u32>(0u, 0u, TILE, TILE);
}

// What rays meet of an item, tile by tile where it has one, as every thread tells by itself.

// Those that may meet what all threads of an item have: not told.
fn item_rays(address: u32, node: Node, centre: vec3<f32>, half: vec3<f32>, is_met: bool, thread: u32) -> vec2<u32> {
    return vec2<u32>(0xffffffffu);
}

fn item_meets(address: u32, rays: vec2<u32>, node: Node, centre: vec3<f32>, half: vec3<f32>) -> bool {
    return node_level(address) != 0u || tile_meets(node_x(address), node_y(address), node, centre, half);
}

fn item_pixels(address: u32, rays: vec2<u32>, node: Node, centre: vec3<f32>, half: vec3<f32>) -> vec4<u32> {
    return vec4<u32>(0u, 0u, TILE, TILE);
}

// Items of incoherent rays, by the lanes of a subgroup. An item of one tile is tested ray by ray: each lane tests a column of rays against
// one box around the boxes of all lanes, then each lane tests only the rays left against its own box.

#import lanes/together.wgsl
#import nodes/index.wgsl
#import nodes/tile_rays/incoherent.wgsl
#import rays/field/table.wgsl
#import shared/params.wgsl

// The rays that may meet a box around the lanes' boxes that are met: bit 8 x + y, 32 bits a word. All lanes call it.
fn item_rays(address: u32, node: Node, centre: vec3<f32>, half: vec3<f32>, is_met: bool, thread: u32) -> vec2<u32> {
    let lane = thread % LANES;
    if node_level(address) != 0u || lanes_any(u32(is_met), lane) == 0u {
        return vec2<u32>(0xffffffffu);
    }
    let lo = select(vec3<f32>(ENDLESS), centre - half, is_met);
    let hi = select(vec3<f32>(-ENDLESS), centre + half, is_met);
    let from_all = -vec3<f32>(lanes_max(-lo.x, lane), lanes_max(-lo.y, lane), lanes_max(-lo.z, lane));
    let to_all = vec3<f32>(lanes_max(hi.x, lane), lanes_max(hi.y, lane), lanes_max(hi.z, lane));
    let tolerance = RAY_TOLERANCE * (abs(from_all) + abs(to_all));
    let own = column_rays(address, node, 0.5 * (from_all + to_all), 0.5 * (to_all - from_all) + tolerance, lane);
    return vec2<u32>(
        subgroupShuffle(own, 0u) | (subgroupShuffle(own, 1u) << 8u) | (subgroupShuffle(own, 2u) << 16u) | (subgroupShuffle(own, 3u) << 24u),
        subgroupShuffle(own, 4u) | (subgroupShuffle(own, 5u) << 8u) | (subgroupShuffle(own, 6u) << 16u) | (subgroupShuffle(own, 7u) << 24u),
    );
}

// Beyond every box.
const ENDLESS: f32 = 3.0e38;

fn column_rays(address: u32, node: Node, centre: vec3<f32>, half: vec3<f32>, lane: u32) -> u32 {
    let column = TILE * node_x(address) + lane;
    let first = TILE * node_y(address);
    var met = 0u;
    if column < params.width {
        for (var row = 0u; row < min(TILE, params.height - first); row++) {
            met |= select(0u, 1u << row, ray_meets(field_at(column, first + row), node, centre, half));
        }
    }
    return met;
}

fn item_meets(address: u32, rays: vec2<u32>, node: Node, centre: vec3<f32>, half: vec3<f32>) -> bool {
    let pixels = item_pixels(address, rays, node, centre, half);
    return all(pixels.xy < pixels.zw);
}

// Bounds of the pixels of the item's tile whose rays may meet a box: first column and row, and one past the last.
fn item_pixels(address: u32, rays: vec2<u32>, node: Node, centre: vec3<f32>, half: vec3<f32>) -> vec4<u32> {
    if node_level(address) != 0u {
        return vec4<u32>(0u, 0u, TILE, TILE);
    }
    let corner = TILE * vec2<u32>(node_x(address), node_y(address));
    var lo = vec2<u32>(TILE);
    var hi = vec2<u32>(0u);
    var left = rays;
    while any(left != vec2<u32>(0u)) {
        let is_first = left.x != 0u;
        let word = select(left.y, left.x, is_first);
        let bit = firstTrailingBit(word);
        left = select(vec2<u32>(0u, word & (word - 1u)), vec2<u32>(word & (word - 1u), left.y), is_first);
        let pixel = vec2<u32>(select(4u, 0u, is_first) + bit / TILE, bit % TILE);
        if all(corner + pixel < vec2<u32>(params.width, params.height))
            && ray_meets(field_at(corner.x + pixel.x, corner.y + pixel.y), node, centre, half) {
            lo = min(lo, pixel);
            hi = max(hi, pixel + 1u);
        }
    }
    return vec4<u32>(lo, hi);
}

// Every pixel of the band is taken, those of a tile by one workgroup.

#import shared/items.wgsl
#import shared/params.wgsl

// The column and the row of a thread's pixel; beyond the band where it has none.
fn pixel_at(group: vec3<u32>, groups: vec3<u32>, lane: u32) -> vec2<u32> {
    let tile = group_index(group, groups);
    return TILE * vec2<u32>(tile % params.tiles_x, tile / params.tiles_x) + vec2<u32>(lane % TILE, lane / TILE);
}

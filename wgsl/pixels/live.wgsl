// The pixels of tiles that have a ray after a bounce are taken; of a camera's own rays those of tiles that may meet the optics. `live` says
// how many tiles that are; then come pairs: the k-th has the number of the k-th of them, and after a bounce whether tile k is one.

#import shared/items.wgsl
#import shared/params.wgsl

var<storage, read> live: array<u32>;

// The column and the row of a thread's pixel; beyond the band where it has none.
fn pixel_at(group: vec3<u32>, groups: vec3<u32>, lane: u32) -> vec2<u32> {
    let index = group_index(group, groups);
    if index >= live[0] {
        return vec2<u32>(NONE);
    }
    let tile = live[1u + 2u * index];
    return TILE * vec2<u32>(tile % params.tiles_x, tile / params.tiles_x) + vec2<u32>(lane % TILE, lane / TILE);
}

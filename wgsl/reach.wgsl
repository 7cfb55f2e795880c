// reach: one thread per tile of the band, in each slab.
// Reads its node; writes the list of tiles of which a ray may meet the box around the optics, each once.

#import nodes/index.wgsl
#import nodes/meets.wgsl
#import nodes/slabs.wgsl
#import optics/layout.wgsl
#import shared/items.wgsl
#import shared/params.wgsl

var<storage, read> nodes: array<Node>;
var<storage, read_write> live: array<atomic<u32>>;

@compute @workgroup_size(64)
fn reach(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let tile = item_index(group, groups, lane);
    let width = level_width(0u);
    if tile >= width * level_height(0u) {
        return;
    }
    if node_meets(nodes[node_index(0u, tile % width, tile / width)], optic.box_centre, optic.box_half) {
        let corner = tile_corner(tile);
        let of_band = corner.y / TILE * params.tiles_x + corner.x / TILE;
        if !SLABBED || atomicExchange(&live[2u + 2u * of_band], 1u) == 0u {
            atomicStore(&live[1u + 2u * atomicAdd(&live[0], 1u)], of_band);
        }
    }
}

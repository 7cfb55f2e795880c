// allot: one thread per tile.
// Reads bin's pair count of each tile, in `ends`; writes the tile's run of the sorted list, from `starts` to `ends`, and
// lists the tiles that have any pairs in `busy`.

#import shared/items.wgsl
#import shared/params.wgsl

var<storage, read_write> busy: array<u32>;
var<storage, read_write> ends: array<u32>;
var<storage, read_write> starts: array<u32>;

@compute @workgroup_size(64)
fn allot(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let tile = item_index(group, groups, lane);
    if tile >= params.tiles_x * params.tiles_y {
        return;
    }
    let count = ends[tile];
    if count == 0u {
        return;
    }
    let first = atomicAdd(&counters[COUNT_SORTED], count);
    starts[tile] = first;
    ends[tile] = first + count;
    busy[atomicAdd(&counters[COUNT_BUSY], 1u)] = tile;
}

// sort: one thread per pair.
// Reads `unsorted` pairs, their places among those of their tile, and where the run of each tile starts; writes `pairs`, those of a
// tile side by side.

#import pairs/pair.wgsl
#import shared/items.wgsl
#import shared/params.wgsl

var<storage, read> ranks: array<u32>;
var<storage, read> starts: array<u32>;
var<storage, read> unsorted: array<vec2<u32>>;
var<storage, read_write> pairs: array<vec2<u32>>;

@compute @workgroup_size(64)
fn sort(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let index = item_index(group, groups, lane);
    if index >= min(atomicLoad(&counters[COUNT_PAIRS]), params.pair_capacity) {
        return;
    }
    let pair = unsorted[index];
    pairs[starts[pair_tile(pair)] + ranks[index]] = pair;
}

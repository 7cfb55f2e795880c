// Items of bin: the triangles that small leaves.

#import bin/item.wgsl
#import nodes/address.wgsl
#import shared/items.wgsl
#import shared/params.wgsl

var<storage, read> large: array<vec2<u32>>;
var<storage, read> nodes: array<Node>;

fn bin_item(group: vec3<u32>, groups: vec3<u32>, thread: u32) -> BinItem {
    let index = item_index(group, groups, thread);
    var item: BinItem;
    item.slot = NONE;
    if index < min(atomicLoad(&counters[COUNT_LARGE]), params.pair_capacity) {
        item.slot = large[index].x;
        item.address = large[index].y;
        item.node = nodes[address_node(item.address)];
    }
    return item;
}

// Items of bin: the triangles that small leaves.
// Provides: bin_item
// Needs: BinItem, COUNT_LARGE, NONE, address_node, item_index
// Binds: counters, large, nodes, params

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

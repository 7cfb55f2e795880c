// Items of bin: the triangles that small leaves.
// Provides: bin_item
// Needs: COUNT_LARGE, NONE, Node, address_node, item_index
// Binds: counters, large, nodes, params

// A triangle, and the node whose rays may meet it.
struct BinItem {
    slot: u32,          // NONE: there is no such item
    address: u32,       // of the node
    node: Node,
    rays: vec2<u32>,    // of incoherent ones those that may meet it
}

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

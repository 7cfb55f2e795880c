// Items of bin: the triangles of `tasks`.
// Provides: bin_item
// Needs: COUNT_TASKS, NONE, Node, TRIANGLE_GROUP, address_node, item_index, item_node, item_rays, task_triangle_group
// Binds: counters, params, tasks

// A triangle, and the node whose rays may meet it.
struct BinItem {
    slot: u32,          // NONE: there is no such item
    address: u32,       // of the node
    node: Node,
    rays: vec2<u32>,    // of incoherent ones those that may meet it
}

fn bin_item(group: vec3<u32>, groups: vec3<u32>, thread: u32) -> BinItem {
    let index = item_index(group, groups, thread) / TRIANGLE_GROUP;
    var item: BinItem;
    item.slot = NONE;
    if index >= min(atomicLoad(&counters[COUNT_TASKS]), params.task_capacity) {
        return item;
    }
    let triangle_group = task_triangle_group(tasks[index].x, thread);
    item.address = tasks[index].y;
    item.node = item_node(address_node(item.address), thread);
    item.rays = item_rays(item.address, item.node, triangle_group.centre, triangle_group.half, true, thread);
    if thread % TRIANGLE_GROUP < triangle_group.count {
        item.slot = triangle_group.first + thread % TRIANGLE_GROUP;
    }
    return item;
}

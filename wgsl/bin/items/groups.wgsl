// Items of bin: the triangles of `tasks`.

#import bin/item.wgsl
#import lanes/loads/node
#import lanes/loads/triangle_group
#import nodes/address.wgsl
#import nodes/item_rays
#import shared/items.wgsl
#import shared/params.wgsl

var<storage, read> tasks: array<vec2<u32>>;

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

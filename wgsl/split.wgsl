// split: one thread per triangle group of the cluster of an item of `work`.
// Reads triangle groups and nodes; writes (triangle group, node) items where a ray of the node may meet the triangle group's box. `tasks`
// may overflow: the counter keeps counting.

#import lanes/loads/node
#import nodes/address.wgsl
#import nodes/item_rays
#import nodes/meets.wgsl
#import shared/items.wgsl
#import shared/params.wgsl
#import shared/places.wgsl

var<storage, read> triangle_groups: array<Cluster>;
var<storage, read> work: array<vec2<u32>>;
var<storage, read_write> tasks: array<vec2<u32>>;

const TRIANGLE_GROUPS: u32 = CLUSTER / TRIANGLE_GROUP;

// Without it everything may meet everything, and `bin` tells.
override CULLING: bool = true;

@compute @workgroup_size(64)
fn split(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    // take a triangle group
    let item = item_index(group, groups, lane) / TRIANGLE_GROUPS;
    if item >= min(atomicLoad(&counters[COUNT_WORK]), params.work_capacity) {
        return;
    }
    let address = work[item].y;
    let node = item_node(address_node(address), lane);
    let index = work[item].x * TRIANGLE_GROUPS + lane % TRIANGLE_GROUPS;
    let triangle_group = triangle_groups[index];

    // test its box against the rays of the node
    let is_met = triangle_group.count > 0u && (!CULLING || node_meets(node, triangle_group.centre, triangle_group.half));
    let rays = item_rays(address, node, triangle_group.centre, triangle_group.half, is_met, lane);
    if is_met && item_meets(address, rays, node, triangle_group.centre, triangle_group.half) {
        let at = take_places(COUNT_TASKS, 1u);
        if at < params.task_capacity {
            tasks[at] = vec2<u32>(index, address);
        }
    }
}

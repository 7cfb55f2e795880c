// split: one thread per bunch of the cluster of an item of `work`.
// Reads bunches and nodes; writes (bunch, node) items where a ray of the node may meet the bunch's box. `tasks` may overflow: the
// counter keeps counting.
// Needs: BUNCH, CLUSTER, COUNT_TASKS, COUNT_WORK, address_node, item_index, item_meets, item_node, item_rays, node_meets
// Binds: bunches, counters, params, tasks, work

const BUNCHES: u32 = CLUSTER / BUNCH;

// Without it everything may meet everything, and `bin` tells.
override CULLING: bool = true;

@compute @workgroup_size(64)
fn split(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    // take a bunch
    let item = item_index(group, groups, lane) / BUNCHES;
    if item >= min(atomicLoad(&counters[COUNT_WORK]), params.work_capacity) {
        return;
    }
    let address = work[item].y;
    let node = item_node(address_node(address), lane);
    let index = work[item].x * BUNCHES + lane % BUNCHES;
    let bunch = bunches[index];

    // test its box against the rays of the node
    let is_met = bunch.count > 0u && (!CULLING || node_meets(node, bunch.centre, bunch.half));
    let rays = item_rays(address, node, bunch.centre, bunch.half, is_met, lane);
    if is_met && item_meets(address, rays, node, bunch.centre, bunch.half) {
        let at = atomicAdd(&counters[COUNT_TASKS], 1u);
        if at < params.task_capacity {
            tasks[at] = vec2<u32>(index, address);
        }
    }
}

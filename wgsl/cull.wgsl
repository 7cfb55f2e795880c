// cull: one thread per (cluster, node) item of the step's queue; in step 0 per cluster, at a node above the top level.
// Reads clusters and nodes; writes the children that the cluster may meet to the next queue, or to `work`: at level 1,
// or where the cluster meets so many children of one affine bundle that going on with single triangles is cheaper.
// `queue_out` and `work` may overflow: counters keep counting.

// Children met by which a cluster is handed on undivided: descending costs every triangle of the cluster a set-up a
// child, handing on costs 16 tests; a set-up is worth about four tests.
const HAND_ON: u32 = 4u;

@compute @workgroup_size(64)
fn cull(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    // take an item
    let index = item_index(group, groups, lane);
    var cluster = params.cluster_first + index;
    var node = node_pack(params.levels, 0u, 0u);
    if step.value == 0u {
        if index >= params.cluster_count {
            return;
        }
    } else {
        if index >= min(atomicLoad(&counters[step.value]), params.queue_capacity) {
            return;
        }
        cluster = queue_in[index].x;
        node = queue_in[index].y;
    }
    let level = node_level(node);
    let x = node_x(node) * BRANCH;
    let y = node_y(node) * BRANCH;

    // test the cluster's box against the rays of each child
    let centre = clusters[cluster].centre;
    let half = clusters[cluster].half;
    let columns = min(BRANCH, level_width(level - 1u) - x);
    let rows = min(BRANCH, level_height(level - 1u) - y);
    var kept = 0u;
    for (var j = 0u; j < rows; j++) {
        for (var i = 0u; i < columns; i++) {
            if node_meets(node_index(level - 1u, x + i, y + j), centre, half) {
                kept |= 1u << (j * BRANCH + i);
            }
        }
    }
    let count = countOneBits(kept);
    if count == 0u {
        return;
    }

    // hand the cluster on undivided, where the node's one bundle bounds its tiles too
    if level < params.levels && count > HAND_ON && nodes[node_index(level, x / BRANCH, y / BRANCH)].rays == RAYS_AFFINE {
        let at = atomicAdd(&counters[COUNT_WORK], 1u);
        if at < params.work_capacity {
            work[at] = vec2<u32>(cluster, node);
        }
        return;
    }

    // descend
    let last = level == 2u;
    var at = atomicAdd(&counters[select(step.value + 1u, COUNT_WORK, last)], count);
    loop {
        if kept == 0u {
            break;
        }
        let bit = firstTrailingBit(kept);
        kept &= kept - 1u;
        let item = vec2<u32>(cluster, node_pack(level - 1u, x + bit % BRANCH, y + bit / BRANCH));
        if last {
            if at < params.work_capacity {
                work[at] = item;
            }
        } else if at < params.queue_capacity {
            queue_out[at] = item;
        }
        at++;
    }
}

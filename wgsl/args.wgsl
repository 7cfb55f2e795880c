// args: one thread in all. Reads a stage's count in `counters` and the capacity of its list, or how many tiles there are;
// writes the indirect arguments of the next dispatch, in two dimensions, clamped to the list's end.

#import shared/params.wgsl

var<storage, read_write> indirect: array<u32>;

const GROUPS_A_SIDE: u32 = 65535u;

@compute @workgroup_size(1)
fn args() {
    // find the count and how many items a workgroup takes
    let is_of_tiles = step.value == NONE;
    var count = atomicLoad(&counters[select(step.value, 0u, is_of_tiles)]);
    var items = GROUP;
    if is_of_tiles {
        items = 1u;
    } else if step.value == COUNT_WORK {
        count = min(count, params.work_capacity);
        items = GROUP / (CLUSTER / TRIANGLE_GROUP);
    } else if step.value == COUNT_TASKS {
        count = min(count, params.task_capacity);
        items = GROUP / TRIANGLE_GROUP;
    } else if step.value == COUNT_PAIRS || step.value == COUNT_LARGE {
        count = min(count, params.pair_capacity);
    } else if step.value == COUNT_RECHECK_ITEMS {
        count = min(count, params.recheck_capacity);
    } else if step.value == COUNT_EDGES {
        count = min(count, params.edge_capacity);
    } else if step.value == COUNT_RECHECK_SAMPLES {
        count = min(count, params.recheck_capacity / 2u);
    } else if step.value == COUNT_BLOCKS {
        items = GROUP / LANES;
    } else if step.value == COUNT_BUSY {
        // those that were listed since the last time
        let first = atomicExchange(&counters[COUNT_BUSY_END], count);
        atomicStore(&counters[COUNT_BUSY_FIRST], first);
        count -= first;
        items = GROUP / LANES;
    } else if step.value < COUNT_WORK {
        count = min(count, params.queue_capacity);
    }
    // lay the groups out in rows
    let groups = (count + items - 1u) / items;
    let rows = (groups + GROUPS_A_SIDE - 1u) / GROUPS_A_SIDE;
    let columns = select((groups + rows - 1u) / max(rows, 1u), 0u, rows == 0u);
    indirect[0] = columns;
    indirect[1] = rows;
    indirect[2] = 1u;
}

// The bunch of a task, whose rows all lanes load together.
// Provides: task_bunch
// Needs: Cluster
// Binds: bunches

fn task_bunch(index: u32, thread: u32) -> Cluster {
    let row = bunches[2u * index + (thread & 1u)];
    let a = subgroupShuffle(row, 0u);
    let b = subgroupShuffle(row, 1u);
    return Cluster(a.xyz, bitcast<u32>(a.w), b.xyz, bitcast<u32>(b.w));
}

// The triangle group of a task, whose rows all lanes load together.
// Provides: task_triangle_group
// Needs: Cluster
// Binds: triangle_groups

fn task_triangle_group(index: u32, thread: u32) -> Cluster {
    let row = triangle_groups[2u * index + (thread & 1u)];
    let a = subgroupShuffle(row, 0u);
    let b = subgroupShuffle(row, 1u);
    return Cluster(a.xyz, bitcast<u32>(a.w), b.xyz, bitcast<u32>(b.w));
}

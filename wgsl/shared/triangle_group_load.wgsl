// The triangle group of a task, as every thread loads it by itself.
// Provides: task_triangle_group
// Needs: Cluster
// Binds: triangle_groups

fn task_triangle_group(index: u32, thread: u32) -> Cluster {
    return triangle_groups[index];
}

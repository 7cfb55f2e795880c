// The bunch of a task, as every thread loads it by itself.
// Provides: task_bunch
// Needs: Cluster
// Binds: bunches

fn task_bunch(index: u32, thread: u32) -> Cluster {
    return bunches[index];
}

// The triangle group of a task, as every thread loads it by itself.

#import shared/params.wgsl

var<storage, read> triangle_groups: array<Cluster>;

fn task_triangle_group(index: u32, thread: u32) -> Cluster {
    return triangle_groups[index];
}

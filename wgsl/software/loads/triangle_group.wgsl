// The triangle group of a task, whose vec4s all lanes load together.

#import shared/params.wgsl

var<storage, read> triangle_groups: array<vec4<f32>>;

fn task_triangle_group(index: u32, thread: u32) -> Cluster {
    let own = triangle_groups[2u * index + (thread & 1u)];
    let a = subgroupShuffle(own, 0u);
    let b = subgroupShuffle(own, 1u);
    return Cluster(a.xyz, bitcast<u32>(a.w), b.xyz, bitcast<u32>(b.w));
}

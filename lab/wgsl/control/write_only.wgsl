// write_only: one thread per stride of a list. Reads nothing; writes its own index to every item of the list.

#import shared/items.wgsl
#import shared/params.wgsl

var<storage, read_write> list: array<vec4<u32>>;

@compute @workgroup_size(64)
fn write_only(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let threads = groups.x * groups.y * GROUP;
    let length = arrayLength(&list);
    for (var at = item_index(group, groups, lane); at < length; at += threads) {
        list[at] = vec4<u32>(at);
    }
}

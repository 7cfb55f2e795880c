// read_only: one thread per stride of a list. Reads every item of the list once; writes a word only where an item has all bits, which
// none has: so no read can be left out.

#import shared/items.wgsl
#import shared/params.wgsl

var<storage, read> list: array<vec4<u32>>;
var<storage, read_write> found: array<u32>;

@compute @workgroup_size(64)
fn read_only(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let threads = groups.x * groups.y * GROUP;
    let length = arrayLength(&list);
    var bits = vec4<u32>(0u);
    for (var at = item_index(group, groups, lane); at < length; at += threads) {
        bits |= list[at];
    }
    if any(bits == vec4<u32>(NONE)) {
        found[0] = 1u;
    }
}

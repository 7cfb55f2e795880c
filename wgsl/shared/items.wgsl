// Work items from workgroups that the host or `args` laid out in two dimensions.

#import shared/params.wgsl

fn item_index(group: vec3<u32>, groups: vec3<u32>, lane: u32) -> u32 {
    return (group.y * groups.x + group.x) * GROUP + lane;
}

fn group_index(group: vec3<u32>, groups: vec3<u32>) -> u32 {
    return group.y * groups.x + group.x;
}

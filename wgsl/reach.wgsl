// reach: one thread per tile of the band.
// Reads its node; writes the list of tiles of which a ray may meet the box around the optics.
// Needs: item_index, level_height, level_width, node_index, node_meets
// Binds: live, nodes, optic

@compute @workgroup_size(64)
fn reach(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let tile = item_index(group, groups, lane);
    let width = level_width(0u);
    if tile >= width * level_height(0u) {
        return;
    }
    if node_meets(nodes[node_index(0u, tile % width, tile / width)], optic.box_centre, optic.box_half) {
        atomicStore(&live[1u + 2u * atomicAdd(&live[0], 1u)], tile);
    }
}

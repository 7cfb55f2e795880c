// The node of a work item, whose rows all lanes load together.
// Provides: item_node
// Needs: LANES, Node
// Binds: nodes

fn item_node(index: u32, thread: u32) -> Node {
    let lane = thread % LANES;
    let row = nodes[6u * index + min(lane, 5u)];
    let p = subgroupShuffle(row, 0u);
    let px = subgroupShuffle(row, 1u);
    let py = subgroupShuffle(row, 2u);
    let d = subgroupShuffle(row, 3u);
    let dx = subgroupShuffle(row, 4u);
    let dy = subgroupShuffle(row, 5u);
    return Node(p.xyz, p.w, px.xyz, px.w, py.xyz, bitcast<u32>(py.w), d.xyz, d.w, dx.xyz, dx.w, dy.xyz, dy.w);
}

// The node of a work item, whose vec4s all lanes load together.

#import shared/params.wgsl

var<storage, read> nodes: array<vec4<f32>>;

fn item_node(index: u32, thread: u32) -> Node {
    let lane = thread % LANES;
    let own = nodes[6u * index + min(lane, 5u)];
    let p = subgroupShuffle(own, 0u);
    let px = subgroupShuffle(own, 1u);
    let py = subgroupShuffle(own, 2u);
    let d = subgroupShuffle(own, 3u);
    let dx = subgroupShuffle(own, 4u);
    let dy = subgroupShuffle(own, 5u);
    return Node(p.xyz, p.w, px.xyz, px.w, py.xyz, bitcast<u32>(py.w), d.xyz, d.w, dx.xyz, bitcast<u32>(dx.w), dy.xyz, dy.w);
}

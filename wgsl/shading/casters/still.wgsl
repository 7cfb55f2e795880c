// The hierarchy of shadow casters, which follows the lights in `lights`.

#import hierarchy/segment.wgsl
#import shading/lights/rows.wgsl
#import shading/numbers.wgsl

fn first_node() -> u32 {
    return 0u;
}

fn node_at(k: u32) -> BvhNode {
    let a = light_row(shading.nodes_first + 2u * k);
    let b = light_row(shading.nodes_first + 2u * k + 1u);
    return BvhNode(a.xyz, bitcast<u32>(a.w), b.xyz, bitcast<u32>(b.w));
}

fn leaf_at(k: u32) -> LeafTriangle {
    let at = shading.leaves_first + 3u * k;
    let a = light_row(at);
    let b = light_row(at + 1u);
    let c = light_row(at + 2u);
    return LeafTriangle(a.xyz, bitcast<u32>(a.w), b.xyz, bitcast<u32>(b.w), c.xyz, bitcast<u32>(c.w));
}

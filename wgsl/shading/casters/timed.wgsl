// The hierarchies of shadow casters, one for the way from each time step to the next. They follow the lights in `lights`: a row for each
// way with its first node; the nodes; six rows a triangle, the corners at both ends of the way.

#import hierarchy/segment.wgsl
#import shading/lights/rows.wgsl
#import shading/numbers.wgsl
#import shared/params.wgsl
#import vertices/timed/vertex.wgsl

fn first_node() -> u32 {
    return bitcast<u32>(light_row(shading.nodes_first + min(moment_step, params.steps - 2u)).x);
}

fn node_at(k: u32) -> BvhNode {
    let at = shading.nodes_first + params.steps - 1u + 2u * k;
    let a = light_row(at);
    let b = light_row(at + 1u);
    return BvhNode(a.xyz, bitcast<u32>(a.w), b.xyz, bitcast<u32>(b.w));
}

fn leaf_at(k: u32) -> LeafTriangle {
    // the moment of the last step lies at the end of the last way
    let share = select(moment_share, 1.0, moment_step + 1u == params.steps);
    let at = shading.leaves_first + 6u * k;
    let a = light_row(at);
    let b = light_row(at + 1u);
    let c = light_row(at + 2u);
    let v0 = a.xyz + share * (light_row(at + 3u).xyz - a.xyz);
    let v1 = b.xyz + share * (light_row(at + 4u).xyz - b.xyz);
    let v2 = c.xyz + share * (light_row(at + 5u).xyz - c.xyz);
    return LeafTriangle(v0, bitcast<u32>(a.w), v1, bitcast<u32>(b.w), v2, bitcast<u32>(c.w));
}

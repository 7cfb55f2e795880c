// The hierarchy in buffers of its own.

#import hierarchy/casters.wgsl
#import hierarchy/segment.wgsl

var<storage, read> bvh: array<BvhNode>;
var<storage, read> leaves: array<LeafTriangle>;

fn first_node() -> u32 {
    return 0u;
}

fn node_at(k: u32) -> BvhNode {
    return bvh[k];
}

fn leaf_at(k: u32) -> LeafTriangle {
    return leaves[k];
}

// The hierarchy in buffers of its own.
// Provides: first_node, leaf_at, node_at
// Needs: BvhNode, LeafTriangle
// Binds: bvh, leaves

fn first_node() -> u32 {
    return 0u;
}

fn node_at(k: u32) -> BvhNode {
    return bvh[k];
}

fn leaf_at(k: u32) -> LeafTriangle {
    return leaves[k];
}

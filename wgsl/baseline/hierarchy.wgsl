// The hierarchy in buffers of its own.

fn node_at(k: u32) -> BvhNode {
    return bvh[k];
}

fn leaf_at(k: u32) -> LeafTriangle {
    return leaves[k];
}

// The hierarchy in buffers of its own.
// Provides: leaf_at, node_at
// Needs: BvhNode, LeafTriangle
// Binds: bvh, leaves

fn node_at(k: u32) -> BvhNode {
    return bvh[k];
}

fn leaf_at(k: u32) -> LeafTriangle {
    return leaves[k];
}

// The node and the cluster of a work item, as every thread loads them by itself.

fn item_node(index: u32, thread: u32) -> Node {
    return nodes[index];
}

fn item_cluster(index: u32, thread: u32) -> Cluster {
    return clusters[index];
}

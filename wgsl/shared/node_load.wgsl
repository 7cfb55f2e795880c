// A node, as every thread loads it by itself.
// Provides: item_node
// Needs: Node
// Binds: nodes

fn item_node(index: u32, thread: u32) -> Node {
    return nodes[index];
}

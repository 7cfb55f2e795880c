// A node, as every thread loads it by itself.
fn item_node(index: u32, thread: u32) -> Node {
    return nodes[index];
}

// A node, as every thread loads it by itself.

#import shared/params.wgsl

var<storage, read> nodes: array<Node>;

fn item_node(index: u32, thread: u32) -> Node {
    return nodes[index];
}

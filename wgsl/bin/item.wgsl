// An item of bin.

#import shared/params.wgsl

// A triangle, and the node whose rays may meet it.
struct BinItem {
    slot: u32,          // NONE: there is no such item
    address: u32,       // of the node
    node: Node,
    rays: vec2<u32>,    // of incoherent ones those that may meet it
}

// The index of a square's node, or of a cell's.

#import nodes/index.wgsl
#import nodes/tables.wgsl
#import shared/params.wgsl

fn address_node(address: u32) -> u32 {
    let level = node_level(address);
    if level == LEVEL_CELL {
        return cells[node_cell(address)].node;
    }
    return node_index(level, node_x(address), node_y(address));
}

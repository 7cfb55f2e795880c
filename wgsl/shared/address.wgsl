// The index of a square's node, or of a cell's.
// Provides: address_node
// Needs: LEVEL_CELL, node_cell, node_index, node_level, node_x, node_y
// Binds: cells

fn address_node(address: u32) -> u32 {
    let level = node_level(address);
    if level == LEVEL_CELL {
        return cells[node_cell(address)].node;
    }
    return node_index(level, node_x(address), node_y(address));
}

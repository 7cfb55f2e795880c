// Addresses and indices of nodes and cells.

#import shared/params.wgsl

// A node's address: level, column and row in one word; or LEVEL_CELL and a cell.
fn node_pack(level: u32, x: u32, y: u32) -> u32 {
    return (level << 28u) | (y << 14u) | x;
}

fn cell_pack(cell: u32) -> u32 {
    return (LEVEL_CELL << 28u) | cell;
}

fn node_cell(node: u32) -> u32 {
    return node & 0x0fffffffu;
}

fn node_level(node: u32) -> u32 {
    return node >> 28u;
}

fn node_x(node: u32) -> u32 {
    return node & 0x3fffu;
}

fn node_y(node: u32) -> u32 {
    return (node >> 14u) & 0x3fffu;
}

fn level_width(level: u32) -> u32 {
    return params.level_width[level >> 2u][level & 3u];
}

fn level_height(level: u32) -> u32 {
    return params.level_height[level >> 2u][level & 3u];
}

fn node_index(level: u32, x: u32, y: u32) -> u32 {
    return params.level_start[level >> 2u][level & 3u] + y * level_width(level) + x;
}

// The cells of each tile: those from tile_start[tile] up to tile_start[tile + 1].

#import shared/params.wgsl

var<storage, read> tile_start: array<u32>;
var<storage, read> cells: array<Cell>;

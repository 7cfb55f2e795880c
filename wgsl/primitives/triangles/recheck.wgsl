// Items of triangles alone.

#import recheck.wgsl
#import shared/params.wgsl

fn recheck_primitive(slot: u32, triangle: vec4<u32>, is_proven: bool, cell: Cell, bit: u32) {
    recheck_triangle(slot, triangle, is_proven, cell, bit);
}

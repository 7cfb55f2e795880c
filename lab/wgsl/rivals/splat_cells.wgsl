// Cells of the texture S: squares of SAMPLES texels a side, row by row, of which the half above the diagonal is used.

#import rivals/layout.wgsl

var<uniform> splat: Splat;

override SAMPLES: u32 = 10u;

fn cell_texel(cell: u32) -> vec2<u32> {
    let columns = splat.side / SAMPLES;
    return vec2<u32>(cell % columns, cell / columns) * SAMPLES;
}

fn cell_slot(cell: u32) -> u32 {
    return (splat.first + cell) % splat.slots;
}

fn cell_piece(cell: u32) -> u32 {
    return (splat.first + cell) / splat.slots;
}

// The rays of a column of a tile in f32, from the pieces that own its pixels.

#import depth/bounded/column.wgsl
#import depth/column
#import depth/edges.wgsl
#import lanes/loads/piece
#import nodes/tables.wgsl
#import shared/params.wgsl

// From a tile's centre to its outermost pixel centres, px.
const TILE_REACH: f32 = 0.5 * f32(TILE - 1u);

// The rays of four pixels of a cell below each other, origins less a point; (x, y) of the first from the tile's centre.
//
// Errors, of sums of components: h, p and d as stored 1 unit each, products and sums 5 of the sizes of what is summed up; what is taken off
// p, a product of h, 6. A quotient loses what its dividend and its divisor lost, over 1 - loss_h, and 5 units.
fn cell_strip(cell: Cell, q: Piece, x: f32, y: f32, less: vec3<f32>) -> Strip {
    let rows = vec4<f32>(y) + vec4<f32>(0.0, 1.0, 2.0, 3.0);
    let h = cell.h + x * q.hx_hi + rows * q.hy_hi;
    let p = cell.p - cell.h * less + x * (q.px_hi - q.hx_hi * less);
    let py = q.py_hi - q.hy_hi * less;
    let d = cell.d + x * q.dx_hi;
    let origins = array<vec4<f32>, 3>((p.x + rows * py.x) / h, (p.y + rows * py.y) / h, (p.z + rows * py.z) / h);
    let directions = array<vec4<f32>, 3>((d.x + rows * q.dy_hi.x) / h, (d.y + rows * q.dy_hi.y) / h, (d.z + rows * q.dy_hi.z) / h);

    let reach_h = abs(cell.h) + TILE_REACH * (abs(q.hx_hi) + abs(q.hy_hi));
    let reach_p = size(cell.p) + TILE_REACH * (size(q.px_hi) + size(q.py_hi)) + reach_h * size(less);
    let reach_d = size(cell.d) + TILE_REACH * (size(q.dx_hi) + size(q.dy_hi));
    let loss_h = 5.0 * UNIT * reach_h / abs(h);
    let more = 1.0 / max(1.0 - loss_h, vec4<f32>(0.5));
    let size_p = size4(origins[0], origins[1], origins[2]);
    let size_d = size4(directions[0], directions[1], directions[2]);
    let error_p = more * (loss_h * size_p + 6.0 * UNIT * reach_p / abs(h)) + 5.0 * UNIT * size_p;
    let error_d = more * (loss_h * size_d + 6.0 * UNIT * reach_d / abs(h)) + 5.0 * UNIT * size_d;
    return strip_of(origins, error_p, directions, error_d, loss_h < vec4<f32>(0.25));
}

fn tile_column(tile: u32, x: u32, less: vec3<f32>) -> Column {
    let bits = vec4<u32>(x) + vec4<u32>(0u, TILE, 2u * TILE, 3u * TILE);
    var column = Column(NO_STRIP, NO_STRIP, vec4<bool>(false), vec4<bool>(false));
    let end = tile_start[tile + 1u];
    var k = tile_start[tile];
    loop {
        // a tile of a hole has none
        let one = vec4<u32>(select(0u, 1u, k < end));
        let cell = cells[k];
        let upper = ((vec4<u32>(cell.mask_lo) >> bits) & one) != vec4<u32>(0u);
        let lower = ((vec4<u32>(cell.mask_hi) >> bits) & one) != vec4<u32>(0u);
        let q = lanes_piece(cell.piece, x);
        column.upper = either(column.upper, cell_strip(cell, q, f32(x) - TILE_REACH, -TILE_REACH, less), upper);
        column.lower = either(column.lower, cell_strip(cell, q, f32(x) - TILE_REACH, 4.0 - TILE_REACH, less), lower);
        column.has_upper = column.has_upper | upper;
        column.has_lower = column.has_lower | lower;
        k++;
        if k >= end {
            break;
        }
    }
    return column;
}

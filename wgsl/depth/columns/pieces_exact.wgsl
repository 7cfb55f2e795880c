// The rays of a column of a tile, from the pieces that own its pixels.

#import arithmetic
#import depth/column
#import lanes/loads/piece
#import nodes/slabs.wgsl
#import nodes/tables.wgsl
#import rays/affine_bundle.wgsl
#import rays/pieces/piece.wgsl
#import shared/params.wgsl

// The rays of four pixels of a piece below each other, origins less a point; (x, y) of the first from the piece's origin.
fn piece_strip(b: Bundle, x: real, y: real, less: real3) -> Strip {
    let rows = real4(y) + real4(0.0, 1.0, 2.0, 3.0);
    let p = b.p + x * b.px;
    let d = b.d + x * b.dx;
    let share = 1.0 / (b.h + x * b.hx + rows * b.hy);
    return Strip(
        (p.x + rows * b.py.x) * share - less.x,
        (p.y + rows * b.py.y) * share - less.y,
        (p.z + rows * b.py.z) * share - less.z,
        (d.x + rows * b.dy.x) * share,
        (d.y + rows * b.dy.y) * share,
        (d.z + rows * b.dy.z) * share,
    );
}

fn tile_column(tile: u32, x: u32, centre: vec3<f32>) -> Column {
    let less = real3(centre);
    let corner = tile_corner(tile);
    let bits = vec4<u32>(x) + vec4<u32>(0u, TILE, 2u * TILE, 3u * TILE);
    var column = Column(NO_STRIP, NO_STRIP, vec4<bool>(false), vec4<bool>(false));
    let end = tile_start[tile + 1u];
    var k = tile_start[tile];
    loop {
        // a tile of a hole has none
        let one = vec4<u32>(select(0u, 1u, k < end));
        let upper = ((vec4<u32>(cells[k].mask_lo) >> bits) & one) != vec4<u32>(0u);
        let lower = ((vec4<u32>(cells[k].mask_hi) >> bits) & one) != vec4<u32>(0u);
        let q = lanes_piece(cells[k].piece, x);
        let b = piece_bundle(q);
        let at = vec2<f32>(corner + vec2<u32>(x, 0u)) - vec2<f32>(q.origin_x, q.origin_y);
        column.upper = either(column.upper, piece_strip(b, real(at.x), real(at.y), less), upper);
        column.lower = either(column.lower, piece_strip(b, real(at.x), real(at.y + 4.0), less), lower);
        column.has_upper = column.has_upper | upper;
        column.has_lower = column.has_lower | lower;
        k++;
        if k >= end {
            break;
        }
    }
    return column;
}

// Rays of a camera made of pieces: of a pixel, and the bundle of a cell in recheck arithmetic.

// Half of a tile from its middle to the outermost pixel centre, px.
const TILE_REACH: f32 = 3.5;

// The bundle about the middle of the cell's tile.
fn cell_bundle(cell: Cell) -> Bundle {
    let q = pieces[cell.piece];
    let x = real(f32((cell.tile % params.tiles_x) * TILE) + TILE_REACH - q.origin_x);
    let y = real(f32((cell.tile / params.tiles_x) * TILE) + TILE_REACH - q.origin_y);
    return bundle_at(piece_bundle(q), x, y);
}

// The bundle of one pixel of a cell whose bundle is `whole`; (x, y) from the tile's middle.
fn pixel_bundle(whole: Bundle, cell: Cell, x: u32, y: u32) -> Bundle {
    return bundle_at(whole, real(f32(x) - TILE_REACH), real(f32(y) - TILE_REACH));
}

fn piece_bundle(q: Piece) -> Bundle {
    return Bundle(
        real3(q.p_hi) + real3(q.p_lo), real3(q.px_hi) + real3(q.px_lo), real3(q.py_hi) + real3(q.py_lo),
        real3(q.d_hi) + real3(q.d_lo), real3(q.dx_hi) + real3(q.dx_lo), real3(q.dy_hi) + real3(q.dy_lo),
        real(q.h_hi) + real(q.h_lo), real(q.hx_hi) + real(q.hx_lo), real(q.hy_hi) + real(q.hy_lo),
    );
}

// The bundle of a pixel of the band, whose piece is looked up.
fn ray_bundle(x: u32, y: u32) -> Bundle {
    let q = pieces[pixel_piece(x, y)];
    return bundle_at(piece_bundle(q), real(f32(x) - q.origin_x), real(f32(y) - q.origin_y));
}

// The ray of a pixel that a piece owns, from its cell.
fn pixel_ray(x: u32, y: u32) -> Ray {
    let cell = cells[pixel_cell(x, y)];
    let fx = f32(x % TILE) - TILE_REACH;
    let fy = f32(y % TILE) - TILE_REACH;
    let px = pieces[cell.piece].px_hi;
    let py = pieces[cell.piece].py_hi;
    let dx = pieces[cell.piece].dx_hi;
    let dy = pieces[cell.piece].dy_hi;
    let h = cell.h + fx * pieces[cell.piece].hx_hi + fy * pieces[cell.piece].hy_hi;
    return Ray((cell.p + fx * px + fy * py) / h, (cell.d + fx * dx + fy * dy) / h);
}

// The cell of a pixel of the band; NONE: no piece owns it.
fn pixel_cell(x: u32, y: u32) -> u32 {
    let tile = (y / TILE) * params.tiles_x + x / TILE;
    let bit = (y % TILE) * TILE + x % TILE;
    for (var k = tile_start[tile]; k < tile_start[tile + 1u]; k++) {
        let mask = select(cells[k].mask_lo, cells[k].mask_hi, bit >= 32u);
        if (mask & (1u << (bit & 31u))) != 0u {
            return k;
        }
    }
    return NONE;
}

fn pixel_piece(x: u32, y: u32) -> u32 {
    return cells[pixel_cell(x, y)].piece;
}

// That piece's number in the camera.
fn piece_number(x: u32, y: u32) -> u32 {
    return pieces[pixel_piece(x, y)].number;
}

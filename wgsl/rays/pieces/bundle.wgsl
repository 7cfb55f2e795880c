// Rays of a camera made of pieces: of a pixel, and the bundle of a cell in recheck arithmetic.

#import arithmetic
#import nodes/slabs.wgsl
#import rays/affine_bundle.wgsl
#import rays/pieces/piece.wgsl
#import rays/pieces/table.wgsl
#import shared/params.wgsl

// Half of a tile from its centre to the outermost pixel centre, px.
const TILE_REACH: f32 = 3.5;

// The bundle about the centre of the cell's tile.
fn cell_bundle(cell: Cell) -> Bundle {
    let q = piece_at(cell.piece);
    let centre = vec2<f32>(tile_corner(cell.tile)) + TILE_REACH - vec2<f32>(q.origin_x, q.origin_y);
    return bundle_at(piece_bundle(q), real(centre.x), real(centre.y));
}

// The bundle of one pixel of a cell whose bundle is `whole`; (x, y) from the tile's centre.
fn pixel_bundle(whole: Bundle, cell: Cell, x: u32, y: u32) -> Bundle {
    return bundle_at(whole, real(f32(x) - TILE_REACH), real(f32(y) - TILE_REACH));
}

// A piece, as every thread loads it by itself.

#import rays/pieces/table.wgsl
#import shared/params.wgsl

fn lanes_piece(index: u32, lane: u32) -> Piece {
    return piece_at(index);
}

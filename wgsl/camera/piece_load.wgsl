// A piece, as every thread loads it by itself.
// Provides: lanes_piece
// Needs: Piece, piece_at

fn lanes_piece(index: u32, lane: u32) -> Piece {
    return piece_at(index);
}

// A piece, whose rows all lanes load together.

#import rays/pieces/table.wgsl
#import shared/params.wgsl

fn lanes_piece(index: u32, lane: u32) -> Piece {
    let own = piece_row(index, lane);
    let more = piece_row(index, 8u + lane % 4u);
    return piece_from(array<vec4<f32>, 12>(
        subgroupShuffle(own, 0u), subgroupShuffle(own, 1u), subgroupShuffle(own, 2u), subgroupShuffle(own, 3u),
        subgroupShuffle(own, 4u), subgroupShuffle(own, 5u), subgroupShuffle(own, 6u), subgroupShuffle(own, 7u),
        subgroupShuffle(more, 0u), subgroupShuffle(more, 1u), subgroupShuffle(more, 2u), subgroupShuffle(more, 3u),
    ));
}

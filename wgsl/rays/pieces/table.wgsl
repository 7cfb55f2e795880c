// The table of pieces.

#import shared/params.wgsl
#import shared/table.wgsl

var pieces: texture_2d<u32>;

// The k-th of the twelve rows of a piece.
fn piece_row(index: u32, k: u32) -> vec4<f32> {
    return bitcast<vec4<f32>>(textureLoad(pieces, table_texel(12u * index + k), 0));
}

fn piece_at(index: u32) -> Piece {
    return piece_from(array<vec4<f32>, 12>(
        piece_row(index, 0u), piece_row(index, 1u), piece_row(index, 2u), piece_row(index, 3u),
        piece_row(index, 4u), piece_row(index, 5u), piece_row(index, 6u), piece_row(index, 7u),
        piece_row(index, 8u), piece_row(index, 9u), piece_row(index, 10u), piece_row(index, 11u),
    ));
}

fn piece_from(r: array<vec4<f32>, 12>) -> Piece {
    return Piece(
        r[0].xyz, r[0].w, r[1].xyz, r[1].w, r[2].xyz, r[2].w, r[3].xyz, r[3].w, r[4].xyz, r[4].w, r[5].xyz, bitcast<u32>(r[5].w),
        r[6].xyz, r[6].w, r[7].xyz, r[7].w, r[8].xyz, r[8].w, r[9].xyz, r[9].w, r[10].xyz, r[10].w, r[11].xyz, r[11].w,
    );
}

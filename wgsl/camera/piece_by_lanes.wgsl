// A piece, whose vec4s all lanes load together.
// Provides: lanes_piece
// Needs: Piece
// Binds: pieces

fn lanes_piece(index: u32, lane: u32) -> Piece {
    let own = pieces[12u * index + lane];
    var more = vec4<f32>(0.0);
    if lane < 4u {
        more = pieces[12u * index + 8u + lane];
    }
    let p = subgroupShuffle(own, 0u);
    let px = subgroupShuffle(own, 1u);
    let py = subgroupShuffle(own, 2u);
    let d = subgroupShuffle(own, 3u);
    let dx = subgroupShuffle(own, 4u);
    let dy = subgroupShuffle(own, 5u);
    let p_lo = subgroupShuffle(own, 6u);
    let px_lo = subgroupShuffle(own, 7u);
    let py_lo = subgroupShuffle(more, 0u);
    let d_lo = subgroupShuffle(more, 1u);
    let dx_lo = subgroupShuffle(more, 2u);
    let dy_lo = subgroupShuffle(more, 3u);
    return Piece(
        p.xyz, p.w, px.xyz, px.w, py.xyz, py.w, d.xyz, d.w, dx.xyz, dx.w, dy.xyz, bitcast<u32>(dy.w),
        p_lo.xyz, p_lo.w, px_lo.xyz, px_lo.w, py_lo.xyz, py_lo.w, d_lo.xyz, d_lo.w, dx_lo.xyz, dx_lo.w, dy_lo.xyz, dy_lo.w,
    );
}

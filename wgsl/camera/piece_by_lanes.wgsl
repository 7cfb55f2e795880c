// A piece, whose rows all lanes load together.
fn lanes_piece(index: u32, lane: u32) -> Piece {
    let row = pieces[12u * index + lane];
    let more = pieces[12u * index + min(8u + lane, 11u)];
    let p = subgroupShuffle(row, 0u);
    let px = subgroupShuffle(row, 1u);
    let py = subgroupShuffle(row, 2u);
    let d = subgroupShuffle(row, 3u);
    let dx = subgroupShuffle(row, 4u);
    let dy = subgroupShuffle(row, 5u);
    let p_lo = subgroupShuffle(row, 6u);
    let px_lo = subgroupShuffle(row, 7u);
    let py_lo = subgroupShuffle(more, 0u);
    let d_lo = subgroupShuffle(more, 1u);
    let dx_lo = subgroupShuffle(more, 2u);
    let dy_lo = subgroupShuffle(more, 3u);
    return Piece(
        p.xyz, p.w, px.xyz, px.w, py.xyz, py.w, d.xyz, d.w, dx.xyz, dx.w, dy.xyz, bitcast<u32>(dy.w),
        p_lo.xyz, p_lo.w, px_lo.xyz, px_lo.w, py_lo.xyz, py_lo.w, d_lo.xyz, d_lo.w, dx_lo.xyz, dx_lo.w, dy_lo.xyz, dy_lo.w,
    );
}

// The bundle of a piece about its origin, in recheck arithmetic.

#import arithmetic
#import rays/affine_bundle.wgsl
#import shared/params.wgsl

fn piece_bundle(q: Piece) -> Bundle {
    return Bundle(
        real3(q.p_hi) + real3(q.p_lo), real3(q.px_hi) + real3(q.px_lo), real3(q.py_hi) + real3(q.py_lo),
        real3(q.d_hi) + real3(q.d_lo), real3(q.dx_hi) + real3(q.dx_lo), real3(q.dy_hi) + real3(q.dy_lo),
        real(q.h_hi) + real(q.h_lo), real(q.hx_hi) + real(q.hx_lo), real(q.hy_hi) + real(q.hy_lo),
    );
}

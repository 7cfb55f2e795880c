// Error bounds of the ray of a pixel of a piece.

#import arithmetic
#import nodes/slabs.wgsl
#import rays/affine_bundle.wgsl
#import rays/bundle
#import rays/pieces/table.wgsl
#import rays/straight/triangle_proof.wgsl
#import shared/params.wgsl

// A stored number 1 unit, a slope times a distance from the piece's origin 2, sums 2: 4 of what is summed up, which at the origin is
// at most what it is here and the slopes' part.
fn weighed(cell: Cell, whole: Bundle, x: u32, y: u32) -> Weighed {
    let q = piece_at(cell.piece);
    let at = vec2<f32>(tile_corner(cell.tile) + vec2<u32>(x, y)) - vec2<f32>(q.origin_x, q.origin_y);
    let far_x = 2.0 * real(abs(at.x));
    let far_y = 2.0 * real(abs(at.y));
    let b = pixel_bundle(whole, cell, x, y);
    let p = size3(b.p) + far_x * size3(b.px) + far_y * size3(b.py);
    let d = size3(b.d) + far_x * size3(b.dx) + far_y * size3(b.dy);
    let h = abs(b.h) + far_x * abs(b.hx) + far_y * abs(b.hy);
    let units = 4.0 * REAL_UNIT;
    return Weighed(b, units * p + h * real(params.origin_error), units * d, units * h);
}

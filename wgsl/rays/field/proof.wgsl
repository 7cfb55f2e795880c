// Error bounds of the ray of a pixel of a field: the rounding of stored values.

#import arithmetic
#import nodes/slabs.wgsl
#import rays/affine_bundle.wgsl
#import rays/field/bundle.wgsl
#import rays/straight/triangle_proof.wgsl
#import shared/params.wgsl

fn weighed(cell: Cell, whole: Bundle, x: u32, y: u32) -> Weighed {
    let corner = tile_corner(cell.tile);
    let b = field_bundle(corner.x + x, corner.y + y);
    return Weighed(b, REAL_UNIT * size3(b.p) + real(params.origin_error), REAL_UNIT * size3(b.d), 0.0);
}

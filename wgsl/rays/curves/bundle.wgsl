// The bundle of a cell of curves.

#import arithmetic
#import rays/affine_bundle.wgsl
#import shared/params.wgsl

// Curves have no bundle.
fn cell_bundle(cell: Cell) -> Bundle {
    let z = real3(0.0);
    return Bundle(z, z, z, z, z, z, real(1.0), real(0.0), real(0.0));
}

// Triangles without alpha masks.

#import rays/affine_bundle.wgsl

fn is_there(slot: u32, b: Bundle) -> bool {
    return true;
}

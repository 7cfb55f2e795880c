// The tolerance within which hits count as hits at an end of t_range.

#import arithmetic
#import rays/affine_bundle.wgsl
#import shared/params.wgsl

// Where the sine of the ray's angle to the plane is smaller than this, the tolerance shrinks with it, so that no hit is moved by more than 2^-32 of
// the scene's size.
const LEAST_SINE: real = 1.0 / 1024.0;

// The sine of a ray's angle to a triangle's plane, 2^-21, below which the ray sees the triangle edge-on. Bounds in f32 prove no t there.
const EDGE_ON: real = 1.0 / 2097152.0;

// Largest N . (v - X) of a hit that counts as a hit at an end of t_range, where its ray along d is at X (`docs/reference/definitions.md`,
// Ends of t_range); across = N . d.
fn plane_tolerance(normal: real3, d: real3, across: real) -> real {
    return PERTURB * real(params.scene_size) * min(size3(normal), abs(across) / (LEAST_SINE * size3(d)));
}

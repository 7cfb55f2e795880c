// Where a segment of a chain meets a sphere or capsule about its end.

#import arithmetic
#import primitives/round/capsule.wgsl
#import rays/affine_bundle.wgsl

// By how much t is off where a segment of a chain ends: the offset t d - m by 16 units of what is summed up, as for triangles, and t by
// that over the cosine of d to the surface, times |d|. Where the ray nearly touches, by the root of what it is off at twice that place.
fn end_margin(b: Bundle, s: Capsule, below: real) -> real {
    let off = 16.0 * REAL_UNIT * ((size3(s.end) + s.radius + s.length) * abs(b.h) + size3(b.p) + size3(b.d));
    let large = s.radius * abs(b.h);
    let flat = sqrt(2.0 * off * large / dot(b.d, b.d));
    return select(flat, min(flat, off * large / sqrt(max(below, 0.0))), below > 0.0);
}

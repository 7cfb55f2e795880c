// Where on a sphere a curve is at t, whose bundle is its tangent there.

#import arithmetic
#import primitives/spheres/chord.wgsl
#import rays/affine_bundle.wgsl

// From the centre, in radii, of a t that is rounded to f32: the tangent enters or leaves there, whichever is nearer.
fn outward(b: Bundle, s: Sphere, t: f32) -> real3 {
    let chord = chord_of(b, s);
    let at = select(chord.enters, chord.leaves, abs(chord.leaves) < abs(chord.enters));
    return (b.p + at * b.d - s.centre) / s.radius;
}

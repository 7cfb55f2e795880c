// Where on a sphere a straight ray is at t.

#import arithmetic
#import primitives/spheres/chord.wgsl
#import rays/affine_bundle.wgsl

// From the centre, in radii, of a t that is rounded to f32: in recheck arithmetic the ray enters or leaves there, whichever is nearer to it.
fn outward(b: Bundle, s: Sphere, t: f32) -> real3 {
    let chord = chord_of(b, s);
    let is_left = abs(chord.leaves - real(t)) < abs(chord.enters - real(t));
    return (select(chord.enters, chord.leaves, is_left) * b.d - (s.centre * b.h - b.p)) / (s.radius * b.h);
}

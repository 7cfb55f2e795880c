// Where on a sphere or capsule a curve is at t, whose bundle is its tangent there.

#import arithmetic
#import primitives/round/capsule.wgsl
#import primitives/round/chord.wgsl
#import rays/affine_bundle.wgsl

// From the nearest point of the segment, in radii. As t is rounded to f32, the tangent enters or leaves there, whichever is nearer.
fn outward(b: Bundle, s: Capsule, t: f32) -> real3 {
    let chord = chord_of(b, s);
    let at = select(chord.enters, chord.leaves, abs(chord.leaves) < abs(chord.enters));
    let place = b.p + at * b.d - s.end;
    return (place - nearest_of_segment(s, place)) / s.radius;
}

// Where on a sphere or capsule a straight ray is at t.

#import arithmetic
#import primitives/round/capsule.wgsl
#import primitives/round/chord.wgsl
#import rays/affine_bundle.wgsl

// From the nearest point of the segment, in radii. As t is rounded to f32, the ray in recheck arithmetic enters or leaves there, whichever
// is nearer to it.
fn outward(b: Bundle, s: Capsule, t: f32) -> real3 {
    let chord = chord_of(b, s);
    let is_left = abs(chord.leaves - real(t)) < abs(chord.enters - real(t));
    let place = select(chord.enters, chord.leaves, is_left) * b.d - (s.end * b.h - b.p);
    return (place - b.h * nearest_of_segment(s, place / b.h)) / (s.radius * b.h);
}

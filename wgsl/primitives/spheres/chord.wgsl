// Where a straight ray enters and leaves a sphere, in recheck arithmetic: with m = c h - p and R = r h it is where |t d - m| = R.

#import arithmetic
#import rays/affine_bundle.wgsl
#import vertices/real

struct Sphere {
    centre: real3,
    radius: real,
}

fn sphere_of(triangle: vec4<u32>) -> Sphere {
    let radius = bitcast<vec2<f32>>(triangle.yz);
    return Sphere(vertex_real(triangle.x), real(radius.x) + real(radius.y));
}

struct Chord {
    enters: real,           // t
    leaves: real,
    below: real,            // the square of half the way between them, times |d|^4; below 0: the ray passes, and both are where it is nearest
}

// With d . m of a root's sign nothing cancels; the product of the two t is (m . m - R^2) / d . d.
fn chord_of(b: Bundle, s: Sphere) -> Chord {
    let m = s.centre * b.h - b.p;
    let large = s.radius * b.h;
    let w = cross(b.d, m);
    let a = dot(b.d, b.d);
    let below = a * large * large - dot(w, w);
    let root = sqrt(max(below, 0.0));
    let along = dot(b.d, m);
    let far = along + select(root, -root, along < 0.0);
    let one = far / a;
    let other = select((dot(m, m) - large * large) / far, 0.0, far == 0.0);
    if below < 0.0 {
        return Chord(along / a, along / a, below);
    }
    return Chord(min(one, other), max(one, other), below);
}

// Rays in f32, and how their points move from pixel to pixel.

// A ray in f32, relative to the anchor.
struct Ray {
    p: vec3<f32>,
    d: vec3<f32>,
}

// Derivatives of a point at constant t: per pixel to the right, and downwards.
struct RayDifferential {
    right: vec3<f32>,
    down: vec3<f32>,
}

// A point moves as those of the neighbours' rays lie: as the mean of both sides, or where these differ much, at a jump, as the
// nearer one. 0: no neighbour there.
fn both_sides(a: vec3<f32>, b: vec3<f32>) -> vec3<f32> {
    let aa = dot(a, a);
    let bb = dot(b, b);
    if aa == 0.0 || bb == 0.0 {
        return a + b;
    }
    let one = select(b, a, aa < bb);
    return select(0.5 * (a + b), one, max(aa, bb) > 4.0 * min(aa, bb));
}

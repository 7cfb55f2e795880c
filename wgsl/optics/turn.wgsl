// What a surface makes of a ray's direction.

// Where a ray is turned, and where to.
struct Turned {
    place: real3,
    d: real3,
}

fn norm(v: real3) -> real {
    return sqrt(dot(v, v));
}

// The unit direction d after a surface with this normal, of any length; `outside` says which side is met. Total
// reflection where Snell's law has no answer.
fn bent(d: real3, normal: real3, outside: real3) -> real3 {
    let n = normal / norm(normal);
    let along = dot(d, n);
    let reflected = d - (along + along) * n;
    let ior = real(optic.ior_hi) + real(optic.ior_lo);
    if ior == real(0.0) {
        return reflected;
    }
    let one = real(1.0);
    let eta = select(ior, one / ior, dot(d, outside) < real(0.0));
    let against = select(-n, n, along < real(0.0));
    let cosine = abs(along);
    let square = one - eta * eta * (one - cosine * cosine);
    if square < real(0.0) {
        return reflected;
    }
    return eta * d + (eta * cosine - sqrt(square)) * against;
}

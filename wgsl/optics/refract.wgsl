// Reflection and refraction of a ray's direction.

#import arithmetic
#import optics/layout.wgsl

// A reflected or refracted ray: origin, direction (0: no ray) and its share of the light.
struct BouncedRay {
    place: real3,
    d: real3,
    share: real,
}

struct Bent {
    d: real3,
    share: real,
    transmitted: bool, // refracted to the other side of the surface
}

fn norm(v: real3) -> real {
    return sqrt(dot(v, v));
}

// The unit normal tilted within its tangent plane's frame (Duff et al. 2017), whose axes follow from the normal alone.
fn tilted(n: real3) -> real3 {
    let x = real(optic.tilt_x_hi) + real(optic.tilt_x_lo);
    let y = real(optic.tilt_y_hi) + real(optic.tilt_y_lo);
    if x == real(0.0) && y == real(0.0) {
        return n;
    }
    let one = real(1.0);
    let side = select(-one, one, n.z >= real(0.0));
    let a = -one / (side + n.z);
    let b = n.x * n.y * a;
    let e1 = real3(one + side * n.x * n.x * a, side * b, -side * n.x);
    let e2 = real3(b, side + n.y * n.y * a, -n.y);
    let v = n + x * e1 + y * e2;
    return v / norm(v);
}

// The unit direction d after a surface with this normal, of any length; `outside` is the geometric normal. Total
// reflection where Snell's law has no solution.
fn bent(d: real3, normal: real3, outside: real3) -> Bent {
    let one = real(1.0);
    let n = tilted(normal / norm(normal));
    let along = dot(d, n);
    let reflected = d - (along + along) * n;
    let ior = real(optic.ior_hi) + real(optic.ior_lo);
    if ior == real(0.0) {
        return Bent(reflected, one, false);
    }
    let eta = select(ior, one / ior, dot(d, outside) < real(0.0));
    let against = select(-n, n, along < real(0.0));
    let cosine = abs(along);
    let square = one - eta * eta * (one - cosine * cosine);
    if square < real(0.0) {
        if optic.branch == 1u {
            return Bent(real3(real(0.0)), real(0.0), false);
        }
        return Bent(reflected, one, false);
    }
    let inner = sqrt(square);
    let refracted = eta * d + (eta * cosine - inner) * against;
    if optic.fresnel == 0u {
        return Bent(refracted, one, true);
    }
    // Fresnel's equations for light without polarization
    let across = (eta * cosine - inner) / (eta * cosine + inner);
    let within = (cosine - eta * inner) / (cosine + eta * inner);
    let back = (across * across + within * within) / (one + one);
    if optic.branch == 1u {
        return Bent(reflected, back, false);
    }
    return Bent(refracted, one - back, true);
}

// The same, but never to the wrong side of the surface: an interpolated or tilted normal may send a direction there, which is then
// reflected by the surface's plane.
fn bent_at(d: real3, normal: real3, outside: real3) -> Bent {
    var after = bent(d, normal, outside);
    let up = outside / norm(outside);
    let height = dot(after.d, up);
    if height != real(0.0) && (height * dot(d, up) < real(0.0)) == after.transmitted {
        after.d -= (height + height) * up;
    }
    return after;
}

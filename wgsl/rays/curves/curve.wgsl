// Curved rays: Bezier curves of one degree, a net of control points a pixel and layer, relative to the anchor.

#import arithmetic
#import shared/params.wgsl

var<storage, read> rays_hi: array<f32>;
var<storage, read> rays_lo: array<f32>;

override DEGREE: u32 = 3u;

// Control points 0 to DEGREE; those above repeat the last.
struct Curve {
    c0: real3,
    c1: real3,
    c2: real3,
    c3: real3,
}

// Where the table has the control points of a pixel of the band.
fn curve_place(layer: u32, x: u32, y: u32) -> u32 {
    return 3u * (DEGREE + 1u) * ((layer * params.height + y) * params.width + x);
}

fn control_point(place: u32, k: u32) -> vec3<f32> {
    let at = place + 3u * k;
    return vec3<f32>(rays_hi[at], rays_hi[at + 1u], rays_hi[at + 2u]);
}

fn control_point_real(place: u32, k: u32) -> real3 {
    let at = place + 3u * k;
    return real3(control_point(place, k)) + real3(vec3<f32>(rays_lo[at], rays_lo[at + 1u], rays_lo[at + 2u]));
}

fn curve_stored(place: u32) -> Curve {
    let c0 = control_point_real(place, 0u);
    let c1 = control_point_real(place, 1u);
    if DEGREE == 1u {
        return Curve(c0, c1, c1, c1);
    }
    let c2 = control_point_real(place, 2u);
    if DEGREE == 2u {
        return Curve(c0, c1, c2, c2);
    }
    return Curve(c0, c1, c2, control_point_real(place, 3u));
}

// Bernstein polynomials 0 to m at t.
fn bernstein(m: u32, t: real) -> real4 {
    let s = 1.0 - t;
    switch m {
        case 0u: { return real4(1.0, 0.0, 0.0, 0.0); }
        case 1u: { return real4(s, t, 0.0, 0.0); }
        case 2u: { return real4(s * s, 2.0 * s * t, t * t, 0.0); }
        default: { return real4(s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t); }
    }
}

fn curve_point(c: Curve, t: real) -> real3 {
    let w = bernstein(DEGREE, t);
    return w.x * c.c0 + w.y * c.c1 + w.z * c.c2 + w.w * c.c3;
}

fn curve_tangent(c: Curve, t: real) -> real3 {
    let w = real(f32(DEGREE)) * bernstein(DEGREE - 1u, t);
    return w.x * (c.c1 - c.c0) + w.y * (c.c2 - c.c1) + w.z * (c.c3 - c.c2);
}

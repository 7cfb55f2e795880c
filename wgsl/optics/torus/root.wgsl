// Intersection of rays with a torus.

#import arithmetic
#import optics/layout.wgsl
#import optics/march.wgsl
#import optics/refract.wgsl
#import optics/smooth/bounce.wgsl

var<storage, read> tori: array<Torus>;

fn torus_place(g: Torus, place: real3) -> real3 {
    return place - real3(g.centre_hi) - real3(g.centre_lo);
}

fn torus_size(g: Torus) -> real {
    return real(g.size_hi) + real(g.size_lo);
}

// A quarter of the gradient.
fn smooth_normal(surface: u32, place: real3) -> real3 {
    let g = tori[surface];
    let ring = real(g.ring_hi) + real(g.ring_lo);
    let axis = real3(g.axis_hi) + real3(g.axis_lo);
    let q = torus_place(g, place) / torus_size(g);
    let away = q - dot(q, axis) * axis;
    return (dot(q, q) + ring + ring - real(1.0)) * q - (ring + ring) * ring * away;
}

// The quartic c0 + c1 s + c2 s^2 + c3 s^3 + s^4.
struct Along {
    c0: real,
    c1: real,
    c2: real,
    c3: real,
}

// The quartic's value and slope.
fn along(a: Along, s: real) -> vec2<real> {
    return vec2<real>(
        a.c0 + s * (a.c1 + s * (a.c2 + s * (a.c3 + s))),
        a.c1 + s * (2.0 * a.c2 + s * (3.0 * a.c3 + 4.0 * s)),
    );
}

// Square of the radius of the ball that is searched, in units of the size: the torus lies well within.
const MARGIN: real = 1.125;

// Most steps; measured: 22, and 75 of rays that leave the torus along it.
const STEPS: u32 = 256u;

// Where the ray p + t d first meets the torus, t in [t_min, t_max]; of a ray that starts on it, the next place: the quartic
// about its start has the root 0, which is dropped with the constant.
fn first_root(surface: u32, p: real3, d: real3, starts: bool, t_min: real, t_max: real) -> Root {
    let g = tori[surface];
    let ring = real(g.ring_hi) + real(g.ring_lo);
    let axis = real3(g.axis_hi) + real3(g.axis_lo);
    // in units of the size, from where the ray is nearest to the centre, or where it starts
    let o = torus_place(g, p);
    let middle = select(-dot(o, d) / dot(d, d), real(0.0), starts);
    let q = (o + middle * d) / torus_size(g);
    let d_length = norm(d);
    let u = d / d_length;
    let speed = d_length / torus_size(g);
    let z = dot(q, axis);
    let w = dot(u, axis);
    let b = dot(q, u);
    let qq = dot(q, q);
    let k = qq + ring + ring - real(1.0);
    let four = real(4.0) * ring * ring;
    let c0 = select(k * k - four * (qq - z * z), real(0.0), starts);
    let c1 = 4.0 * k * b - (four + four) * (b - z * w);
    let c2 = 4.0 * b * b + k + k - four * (1.0 - w * w);
    let a = Along(c0, c1, c2, 4.0 * b);

    // the part within the ball and the range
    let square = b * b + MARGIN - qq;
    if square < real(0.0) {
        return Root(real(0.0), false);
    }
    let chord = sqrt(square);
    var from_s = max(-b - chord, (t_min - middle) * speed);
    let to_s = min(chord - b, (t_max - middle) * speed);
    // the second derivative 2 c2 + 6 c3 s + 12 s^2: its least, and the larger of its ends
    let ends = vec2<real>(from_s * (6.0 * a.c3 + 12.0 * from_s), to_s * (6.0 * a.c3 + 12.0 * to_s));
    let bends = c2 + c2 + vec2<real>(-0.75 * a.c3 * a.c3, max(ends.x, ends.y));
    if starts {
        // c1 s alone outweighs the rest up to twice as far
        from_s = abs(c1) / max(-bends.x, bends.y);
    }
    if !(from_s < to_s) {
        return Root(real(0.0), false);
    }
    var root = first_crossing(a, from_s, to_s, bends, STEPS);
    root.t = middle + root.t / speed;
    root.found = root.found && root.t >= t_min && root.t <= t_max;
    return root;
}

// The path of a pixel in a layer: a curve, a span of t after the other, each about its chord.

#import hierarchy/nodes.wgsl
#import rays/curves/coverage.wgsl
#import rays/curves/curve.wgsl
#import shared/params.wgsl
#import vertices/vertex

struct Path {
    net: array<vec3<f32>, 4>,   // about the origin of the hierarchy
    reach: f32,             // the largest coordinate about the anchor, at which control points were rounded
    item: u32,              // the tile, and in the low 6 bits the pixel
    start: u32,             // the triangle that the ray starts on
}

// X = p + s d for s from `first` to `last`: no point of the path that counts is farther off than the slack, a coordinate.
// s = (t - t_first) t_share.
struct Stretch {
    p: vec3<f32>,
    d: vec3<f32>,
    slack: vec3<f32>,
    first: f32,
    last: f32,
    t_first: f32,
    t_share: f32,
    number: u32,
}

// Along one axis: where the chord begins, how far it goes, and how far the curve is off it at the same t: Bernstein weights are positive
// and add up to 1, and the chord is the curve of evenly spaced control points.
fn chord(net: vec4<f32>, span: vec2<f32>) -> vec3<f32> {
    let b = over_span(net, span);
    if DEGREE == 1u {
        return vec3<f32>(b.x, b.y - b.x, 0.0);
    }
    if DEGREE == 2u {
        return vec3<f32>(b.x, b.z - b.x, abs(b.y - 0.5 * (b.x + b.z)));
    }
    let one = abs(b.y - (2.0 * b.x + b.w) / 3.0);
    return vec3<f32>(b.x, b.w - b.x, max(one, abs(b.z - (b.x + 2.0 * b.w) / 3.0)));
}

fn largest_of(v: vec3<f32>) -> f32 {
    return max(abs(v.x), max(abs(v.y), abs(v.z)));
}

fn stretch_of(path: Path, k: u32, scale: f32) -> Stretch {
    let n = path.net;
    let span = vec2<f32>(f32(k), f32(k + 1u)) / f32(params.spans);
    let x = chord(vec4<f32>(n[0].x, n[1].x, n[2].x, n[3].x) * scale, span);
    let y = chord(vec4<f32>(n[0].y, n[1].y, n[2].y, n[3].y) * scale, span);
    let z = chord(vec4<f32>(n[0].z, n[1].z, n[2].z, n[3].z) * scale, span);
    let far = 1.0 + scale * (path.reach + max(max(largest_of(n[0]), largest_of(n[1])), max(largest_of(n[2]), largest_of(n[3]))));
    let slack = vec3<f32>(x.z, y.z, z.z) + (48.0 + CORNER_UNITS) * UNIT * far + LEAST;
    let more = 8.0 * UNIT * f32(params.spans);
    return Stretch(vec3<f32>(x.x, y.x, z.x), vec3<f32>(x.y, y.y, z.y), slack, -more, 1.0 + more, span.x, f32(params.spans), k);
}

// The complemented key of the nearest hit so far, and a t that is not below its.
struct Seen {
    key: vec2<u32>,
    t: f32,
}

fn nothing_seen() -> Seen {
    return Seen(vec2<u32>(0u), 2.0);
}

fn last_of(stretch: Stretch, seen: Seen) -> f32 {
    let s = (seen.t - stretch.t_first) * stretch.t_share;
    return min(stretch.last, s + 8.0 * UNIT * (abs(s) + stretch.t_first * stretch.t_share));
}

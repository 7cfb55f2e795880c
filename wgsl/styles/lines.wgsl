// Lines on surfaces, as wide in pixels as they shall be through any camera: distances in world or weights, over how these change from
// pixel to pixel.

fn drawn(look: Look, n: vec3<f32>, colour: vec3<f32>) -> vec3<f32> {
    let on = tangents(look);
    var seen = colour;
    if style.hatch_spacing > 0.0 {
        let tone = clamp(dot(colour, vec3<f32>(0.2126, 0.7152, 0.0722)), 0.0, 1.0);
        seen = mix(style.paper, style.ink, hatched(look.p + shading.anchor, on, 1.0 - tone, look.share));
    }
    if style.wire_width > 0.0 {
        let width = style.wire_width * min(1.0, style.wire_depth / look.z);
        seen = mix(seen, style.wire, covered(edge_distance(look, on), width, look.share));
    }
    return seen;
}

// How far the nearest edge of the triangle is, px.
fn edge_distance(look: Look, on: Spread) -> f32 {
    let triangle = triangles[look.slot];
    let v0 = vertex(triangle.x);
    var e1 = vertex(triangle.y) - v0;
    var e2 = vertex(triangle.z) - v0;
    let most = max(abs(e1), abs(e2));
    let size = max(most.x, max(most.y, most.z));
    e1 /= size;
    e2 /= size;
    let n = cross(e1, e2);
    let g1 = cross(e2, n) / dot(n, n);
    let g2 = cross(n, e1) / dot(n, n);
    let at = (look.p - v0) / size;
    let w1 = dot(at, g1);
    let w2 = dot(at, g2);
    let right = on.right / size;
    let down = on.down / size;
    let s1 = vec2<f32>(dot(right, g1), dot(down, g1));
    let s2 = vec2<f32>(dot(right, g2), dot(down, g2));
    let to = vec3<f32>(w1 / length(s1), w2 / length(s2), (1.0 - w1 - w2) / length(s1 + s2));
    return max(0.0, min(to.x, min(to.y, to.z)));
}

// The share of ink where a surface is so dark: strokes along one family of planes up to one half of it, and crossing ones beyond.
fn hatched(p: vec3<f32>, on: Spread, dark: f32, box: f32) -> f32 {
    let first = min(dark, 0.5);
    let second = select(0.0, 1.0 - (1.0 - dark) / (1.0 - first), dark > 0.5);
    let a = strokes(p, vec3<f32>(0.5773503, 0.7113249, 0.4009186), on, first, box);
    let b = strokes(p, vec3<f32>(0.6804138, -0.4082483, 0.6085806), on, second, box);
    return 1.0 - (1.0 - a) * (1.0 - b);
}

// The share of ink of strokes where planes across an axis cut the surface. Their distance in the world is a power of two, so that it is
// once to twice the spacing in pixels; between two powers every other stroke grows thinner.
fn strokes(p: vec3<f32>, axis: vec3<f32>, on: Spread, ink: f32, box: f32) -> f32 {
    let slope = length(vec2<f32>(dot(on.right, axis), dot(on.down, axis)));
    if ink <= 0.0 || !(slope > 1e-30 && slope < 1e30) {
        return ink;
    }
    let level = log2(slope * style.hatch_spacing);
    let period = exp2(floor(level) + 1.0);
    let left = 1.0 - fract(level);
    let at = dot(p, axis) / period;
    let apart = period / slope;
    let width = ink * apart / (1.0 + left);
    let whole = covered(abs(fract(at + 0.5) - 0.5) * apart, width, box);
    let between = covered(abs(fract(at) - 0.5) * apart, width * left, box);
    return min(whole + between, 1.0);
}

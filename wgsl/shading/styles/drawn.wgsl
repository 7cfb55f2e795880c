// Lines on surfaces, as wide in pixels as they shall be through any camera: distances in world or weights, over how these change from
// pixel to pixel.

#import primitives/flat
#import rays/ray.wgsl
#import shading/numbers.wgsl
#import shading/styles/layout.wgsl
#import shading/styles/patterns.wgsl
#import shading/styles/shaded_hit.wgsl
#import shading/surface.wgsl
#import vertices/vertex
#import vertices/weights.wgsl

fn drawn(hit: ShadedHit, n: vec3<f32>, colour: vec3<f32>) -> vec3<f32> {
    var seen = colour;
    if by_thread(bitcast<u32>(style.hatch_spacing), hit.slot) != 0u {
        let on = tangents(hit);
        let tone = clamp(dot(colour, vec3<f32>(0.2126, 0.7152, 0.0722)), 0.0, 1.0);
        seen = mix(style.paper, style.ink, hatched(hit.p + shading.anchor, on, 1.0 - tone, hit.share));
    }
    if by_thread(bitcast<u32>(style.wire_width), hit.slot) != 0u {
        let width = narrowed(style.wire_width, style.wire_depth, hit.z);
        seen = mix(seen, style.wire, covered(edge_distance(hit), width, hit.share));
    }
    return seen;
}

const FAR_EDGE: f32 = 1.0e30;

// How far the nearest edge of the triangle is, px; of a sphere, beyond all widths.
fn edge_distance(hit: ShadedHit) -> f32 {
    if !has_corners(triangle_at(hit.slot)) {
        return FAR_EDGE;
    }
    let w = weights_at(triangle_at(hit.slot), hit.p, hit.d, hit.differential);
    let to = w.at / sqrt(w.right * w.right + w.down * w.down);
    return max(0.0, min(to.x, min(to.y, to.z)));
}

// The share of ink where a surface is so dark: strokes along one family of planes up to one half of it, and crossing ones beyond.
fn hatched(p: vec3<f32>, on: RayDifferential, dark: f32, box: f32) -> f32 {
    let first = min(dark, 0.5);
    let second = select(0.0, 1.0 - (1.0 - dark) / (1.0 - first), dark > 0.5);
    let a = strokes(p, vec3<f32>(0.5773503, 0.7113249, 0.4009186), on, first, box);
    let b = strokes(p, vec3<f32>(0.6804138, -0.4082483, 0.6085806), on, second, box);
    return 1.0 - (1.0 - a) * (1.0 - b);
}

// The share of ink of strokes where planes across an axis cut the surface. Their distance in the world is a power of two, so that it is
// once to twice the spacing in pixels; between two powers every other stroke grows thinner.
fn strokes(p: vec3<f32>, axis: vec3<f32>, on: RayDifferential, ink: f32, box: f32) -> f32 {
    let slope = length(vec2<f32>(dot(on.right, axis), dot(on.down, axis)));
    if ink <= 0.0 || !(slope > 1e-30 && slope < 1e30) {
        return ink;
    }
    let level = log2(slope * style.hatch_spacing);
    let period = exp2(floor(level) + 1.0);
    let left = 1.0 - fract(level);
    let at = dot(p, axis) / period;
    let spacing = period / slope;
    let width = ink * spacing / (1.0 + left);
    let whole = covered(abs(fract(at + 0.5) - 0.5) * spacing, width, box);
    let between = covered(abs(fract(at) - 0.5) * spacing, width * left, box);
    return min(whole + between, 1.0);
}

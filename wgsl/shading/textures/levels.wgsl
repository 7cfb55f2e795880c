// Levels of images.

#import shading/materials/material.wgsl
#import shading/textures/layout.wgsl

var pages: texture_2d_array<f32>;

// Where in [0, 1] an image shows what lies at u.
fn into_image(u: f32, wrap: u32) -> f32 {
    if wrap == WRAP_CLAMP {
        return clamp(u, 0.0, 1.0);
    }
    let mirrored = 2.0 * fract(0.5 * u);
    return select(fract(u), min(mirrored, 2.0 - mirrored), wrap == WRAP_MIRROR);
}

fn bilinear(m: Material, place: vec2<f32>, level: u32) -> vec4<f32> {
    let size = max(m.size >> vec2<u32>(level), vec2<u32>(1u));
    let at = place * vec2<f32>(size) - 0.5;
    let part = fract(at);
    let first = vec2<i32>(floor(at));
    let count = vec2<i32>(size);
    let x0 = next_to(first.x, count.x, wrap_u(m.texture));
    let x1 = next_to(first.x + 1, count.x, wrap_u(m.texture));
    let y0 = next_to(first.y, count.y, wrap_v(m.texture));
    let y1 = next_to(first.y + 1, count.y, wrap_v(m.texture));
    let origin = level_origin(m, level);
    // between equal texels exactly these
    let above = between(texel(m, origin, x0, y0), texel(m, origin, x1, y0), part.x);
    let below = between(texel(m, origin, x0, y1), texel(m, origin, x1, y1), part.x);
    return between(above, below, part.y);
}

fn between(a: vec4<f32>, b: vec4<f32>, part: f32) -> vec4<f32> {
    return a + part * (b - a);
}

// A texel's index, at most one beyond the image's borders.
fn next_to(index: i32, count: i32, wrap: u32) -> i32 {
    let again = select(index + count, index - count, index > 0);
    let beyond = select(clamp(index, 0, count - 1), again, wrap == WRAP_REPEAT);
    return select(beyond, index, index >= 0 && index < count);
}

fn texel(m: Material, origin: vec2<u32>, x: i32, y: i32) -> vec4<f32> {
    return textureLoad(pages, vec2<i32>(origin) + vec2<i32>(x, y), m.page, 0);
}

// Levels after the first stand in a row below an image that is wider than high, in a column right of it otherwise; of both
// together `span` holds at least as many texels as all of them are wide.
fn level_origin(m: Material, level: u32) -> vec2<u32> {
    if level == 0u {
        return m.origin;
    }
    let offset = m.span - (m.span >> (level - 1u));
    let is_wide = m.size.x >= m.size.y;
    return m.origin + select(vec2<u32>(m.size.x, offset), vec2<u32>(offset, m.size.y), is_wide);
}

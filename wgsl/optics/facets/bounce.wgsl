// Reflection and refraction at flat facets.

#import arithmetic
#import optics/layout.wgsl
#import optics/refract.wgsl

var<storage, read> corners: array<Corner>;

// Least sine of the angle between the facet's plane and its corners' bounced rays for which they are scaled to one height.
const FLAT_LEAST: real = 0.015625;

fn corner_place(k: u32) -> real3 {
    return real3(corners[k].p_hi) + real3(corners[k].p_lo);
}

fn corner_normal(k: u32) -> real3 {
    return real3(corners[k].n_hi) + real3(corners[k].n_lo);
}

// The index of the facet's piece among the optics' pieces.
fn piece_of(surface: u32) -> u32 {
    return corners[3u * surface].piece;
}

// The position with weights w on that piece: weights of the piece's second and third corner.
fn piece_weights(surface: u32, w: vec3<f32>) -> vec2<f32> {
    let k = 3u * surface;
    return w.x * vec2<f32>(corners[k].piece_u, corners[k].piece_v)
        + w.y * vec2<f32>(corners[k + 1u].piece_u, corners[k + 1u].piece_v)
        + w.z * vec2<f32>(corners[k + 2u].piece_u, corners[k + 2u].piece_v);
}

// The weights of the corners where the line p + t d meets the facet's plane.
fn facet_weights(surface: u32, p: real3, d: real3) -> real3 {
    let k = 3u * surface;
    let v0 = corner_place(k);
    let v1 = corner_place(k + 1u);
    let v2 = corner_place(k + 2u);
    let g0 = cross(d, v0 - p);
    let e = real3(dot(v2 - v1, cross(d, v1 - p)), dot(v0 - v2, g0), dot(v1 - v0, g0));
    return e / (e.x + e.y + e.z);
}

fn facet_place(surface: u32, w: real3) -> real3 {
    let k = 3u * surface;
    return w.x * corner_place(k) + w.y * corner_place(k + 1u) + w.z * corner_place(k + 2u);
}

// The bounce of the ray p + t d, d of any length, at the facet that it meets.
fn bounce_at(surface: u32, p: real3, d: real3, last: u32) -> BouncedRay {
    let k = 3u * surface;
    let v0 = corner_place(k);
    let v1 = corner_place(k + 1u);
    let v2 = corner_place(k + 2u);
    let n0 = corner_normal(k);
    let n1 = corner_normal(k + 1u);
    let n2 = corner_normal(k + 2u);
    let outside = cross(v1 - v0, v2 - v0);

    let w = facet_weights(surface, p, d);
    let place = facet_place(surface, w);
    if optic.law == LAW_NORMALS {
        let after = bent_at(d / norm(d), w.x * n0 + w.y * n1 + w.z * n2, outside);
        return BouncedRay(place, after.d, after.share);
    }

    // bounce the corners' own rays; scale them to one height over the facet if all leave it
    let eye = real3(optic.eye_hi) + real3(optic.eye_lo);
    let d0 = bent((v0 - eye) / norm(v0 - eye), n0, outside);
    let d1 = bent((v1 - eye) / norm(v1 - eye), n1, outside);
    let d2 = bent((v2 - eye) / norm(v2 - eye), n2, outside);
    let up = outside / norm(outside);
    let heights = real3(dot(d0.d, up), dot(d1.d, up), dot(d2.d, up));
    let least = min(heights.x, min(heights.y, heights.z));
    let most = max(heights.x, max(heights.y, heights.z));
    var scale = real3(real(1.0));
    if least >= FLAT_LEAST || most <= -FLAT_LEAST {
        scale = real3(real(1.0)) / abs(heights);
    }
    let share = w.x * d0.share + w.y * d1.share + w.z * d2.share;
    return BouncedRay(place, w.x * scale.x * d0.d + w.y * scale.y * d1.d + w.z * scale.z * d2.d, share);
}

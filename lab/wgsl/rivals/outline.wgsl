// Pieces, and their outlines in the image.

#import rays/ray.wgsl
#import rivals/layout.wgsl
#import shared/params.wgsl

// An outline in band pixels, centres at whole numbers.
fn outline_corners(o: Outline) -> array<vec2<f32>, 3> {
    let shift = vec2<f32>(0.5, f32(params.band_row) + 0.5);
    return array<vec2<f32>, 3>(o.a - shift, o.b - shift, o.c - shift);
}

// The piece holds the place, in band pixels, centres at whole numbers.
fn outline_contains(o: Outline, q: vec2<f32>) -> bool {
    let corners = outline_corners(o);
    let ab = winding(corners[1] - corners[0], q - corners[0]);
    let bc = winding(corners[2] - corners[1], q - corners[1]);
    let ca = winding(corners[0] - corners[2], q - corners[2]);
    return o.is_whole != 0u || (ab >= 0.0 && bc >= 0.0 && ca >= 0.0) || (ab <= 0.0 && bc <= 0.0 && ca <= 0.0);
}

// Without it what lies outside a piece is drawn too, and fragments tell.
override CULLING: bool = true;

// Above 0 on the inner side of each edge and up to half a pixel outside: fragments tell exactly. The place is (w x, w y, w) in band
// pixels, w above 0, centres at whole numbers.
fn outline_distances(o: Outline, q: vec3<f32>) -> array<f32, 3> {
    let corners = outline_corners(o);
    var distances = array<f32, 3>(1.0, 1.0, 1.0);
    for (var k = 0u; CULLING && k < 3u && o.is_whole == 0u; k++) {
        let a = corners[k];
        let e = corners[(k + 1u) % 3u] - a;
        let inner = select(-1.0, 1.0, winding(e, corners[(k + 2u) % 3u] - a) > 0.0);
        distances[k] = inner * winding(e, q.xy - a * q.z) + 0.5 * length(e) * q.z;
    }
    return distances;
}

fn winding(e: vec2<f32>, m: vec2<f32>) -> f32 {
    return e.x * m.y - e.y * m.x;
}

// The ray of a piece at a place in pixels from its origin.
fn outline_ray(q: Piece, at: vec2<f32>) -> Ray {
    let h = q.h_hi + at.x * q.hx_hi + at.y * q.hy_hi;
    return Ray((q.p_hi + at.x * q.px_hi + at.y * q.py_hi) / h, (q.d_hi + at.x * q.dx_hi + at.y * q.dy_hi) / h);
}

// In band pixels; the row has pixels of the image.
fn piece_origin(q: Piece) -> vec2<f32> {
    return vec2<f32>(q.origin_x, q.origin_y - f32(params.band_row));
}

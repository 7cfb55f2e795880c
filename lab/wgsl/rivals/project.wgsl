// Where a piece shows a point, by Newton's method: p(x, y) + t d(x, y) = h(x, y) X for x, y and t. One image: where a piece
// shows a point more than once, the one that the central ray leads to (as Popescu et al., section 4.2).

#import shared/params.wgsl

const NEWTON_STEPS: u32 = 8u;

struct Image {
    place: vec2<f32>,   // px from the piece's origin
    t: f32,
    width: f32,         // of a pixel's beam there: square root of its section, relative
}

fn image_of(q: Piece, point: vec3<f32>) -> Image {
    var x = 0.0;
    var y = 0.0;
    let toward = point * q.h_hi - q.p_hi;
    var t = dot(toward, q.d_hi) / dot(q.d_hi, q.d_hi);
    var section = 0.0;
    for (var k = 0u; k < NEWTON_STEPS; k++) {
        let fx = q.px_hi + t * q.dx_hi - q.hx_hi * point;
        let fy = q.py_hi + t * q.dy_hi - q.hy_hi * point;
        let d = q.d_hi + x * q.dx_hi + y * q.dy_hi;
        let off = (q.p_hi - q.h_hi * point) + x * fx + y * fy + t * q.d_hi;
        let across = cross(fx, fy);
        let volume = dot(across, d);
        x -= dot(cross(fy, d), off) / volume;
        y -= dot(cross(d, fx), off) / volume;
        t -= dot(across, off) / volume;
        section = abs(volume) / length(d);
    }
    return Image(vec2<f32>(x, y), t, sqrt(section));
}

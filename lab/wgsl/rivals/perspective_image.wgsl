// Where a piece whose rays start in one point shows a point: (s x, s y, s), (x, y) in pixels from the piece's origin, with
// X = eye + s (d + x dx + y dy); linear in X, and s above 0 before the eye.

#import shared/params.wgsl

fn perspective_image(q: Piece, point: vec3<f32>) -> vec3<f32> {
    let m = point - q.p_hi / q.h_hi;
    let volume = dot(cross(q.dx_hi, q.dy_hi), q.d_hi);
    return vec3<f32>(dot(cross(q.dy_hi, q.d_hi), m), dot(cross(q.d_hi, q.dx_hi), m), dot(cross(q.dx_hi, q.dy_hi), m)) / volume;
}

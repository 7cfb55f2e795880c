// warp: vertices where the camera shows them, edges straight between them (Brosz et al. 2007; Popescu et al., section 4.2).
// Every triangle is first split into 4^LEVELS, and with several layers each part is cut off where t begins and ends. An instance is a piece.

#import rays/pieces/table.wgsl
#import rivals/drawing.wgsl
#import rivals/drawn
#import rivals/layout.wgsl
#import rivals/outline.wgsl
#import rivals/project.wgsl
#import rivals/range.wgsl
#import rivals/seen_through.wgsl
#import shared/params.wgsl
#import vertices/vertex

override LEVELS: u32 = 0u;

// Triangles that are drawn of a part: 3 if it is cut, since two planes leave five corners at most, else 1.
override FAN: u32 = 1u;

// Of t, where a part is cut at 0.
const CUT_ROUNDING: f32 = 1e-4;

// A convex polygon.
struct Cut {
    corners: array<vec3<f32>, 5>,
    count: u32,
}

// The plane of all points of a piece's rays at one t: dot(normal, X) + offset is above 0 where t is larger. All 0 where the rays meet.
fn plane_at(q: Piece, t: f32) -> vec4<f32> {
    let a = vec4<f32>(q.p_hi + t * q.d_hi, q.h_hi);
    let b = vec4<f32>(q.px_hi + t * q.dx_hi, q.hx_hi);
    let c = vec4<f32>(q.py_hi + t * q.dy_hi, q.hy_hi);
    let normal = a.w * cross(b.xyz, c.xyz) + b.w * cross(c.xyz, a.xyz) + c.w * cross(a.xyz, b.xyz);
    let plane = vec4<f32>(normal, -dot(a.xyz, cross(b.xyz, c.xyz)));
    return select(-plane, plane, dot(normal, q.d_hi) >= 0.0);
}

// What of a polygon lies on a plane's upper side.
fn cut_off(whole: Cut, plane: vec4<f32>) -> Cut {
    var left: Cut;
    for (var k = 0u; k < whole.count; k++) {
        let a = whole.corners[k];
        let b = whole.corners[(k + 1u) % whole.count];
        let above_a = dot(plane, vec4<f32>(a, 1.0));
        let above_b = dot(plane, vec4<f32>(b, 1.0));
        if above_a >= 0.0 {
            left.corners[left.count] = a;
            left.count++;
        }
        if (above_a >= 0.0) != (above_b >= 0.0) {
            left.corners[left.count] = mix(a, b, above_a / (above_a - above_b));
            left.count++;
        }
    }
    return left;
}

// The weights of a corner of one of the 4^LEVELS parts of a triangle.
fn part_weights(part: u32, corner: u32) -> vec3<f32> {
    var a = vec3<f32>(1.0, 0.0, 0.0);
    var b = vec3<f32>(0.0, 1.0, 0.0);
    var c = vec3<f32>(0.0, 0.0, 1.0);
    for (var k = 0u; k < LEVELS; k++) {
        let ab = 0.5 * (a + b);
        let bc = 0.5 * (b + c);
        let ca = 0.5 * (c + a);
        switch (part >> (2u * k)) & 3u {
            case 0u: { b = ab; c = ca; }
            case 1u: { a = ab; c = bc; }
            case 2u: { a = ca; b = bc; }
            default: { a = bc; b = ca; c = ab; }
        }
    }
    return select(select(c, b, corner == 1u), a, corner == 0u);
}

@vertex
fn warp_corner(@builtin(vertex_index) index: u32, @builtin(instance_index) piece: u32) -> Clipped {
    let parts = 1u << (2u * LEVELS);
    let drawn_part = index / (3u * FAN);
    let triangle = triangle_at(drawn_part / parts);
    let v0 = vertex(triangle.x);
    let v1 = vertex(triangle.y);
    let v2 = vertex(triangle.z);
    let q = piece_at(piece);
    var part: Cut;
    part.count = 3u;
    for (var k = 0u; k < 3u; k++) {
        let w = part_weights(drawn_part % parts, k);
        part.corners[k] = w.x * v0 + w.y * v1 + w.z * v2;
    }
    if FAN > 1u {
        part = cut_off(cut_off(part, plane_at(q, range_start())), -plane_at(q, range_end()));
    }
    // the triangles of the fan are of corner 0 and two in turn
    let turn = index / 3u % FAN;
    let corner = select(turn + index % 3u, 0u, index % 3u == 0u);
    if turn + 2u >= part.count {
        return Clipped(vec4<f32>(0.0, 0.0, 0.0, 1.0), array<f32, 3>(-1.0, -1.0, -1.0), 0.0, vec3<f32>(0.0), 0u, piece);
    }
    let image = image_of(q, part.corners[corner]);
    // what lies behind an eye, or beyond the horizon of a part that was cut, is clipped off; corners of a cut lie on it but for rounding
    let h = q.h_hi + image.place.x * q.hx_hi + image.place.y * q.hy_hi;
    let seen = select(image.t, min(h, image.t + CUT_ROUNDING), FAN > 1u);
    let width = select(image.width, -image.width, seen < 0.0);
    let at = piece_origin(q) + image.place;
    let distances = outline_distances(outlines[q.number], vec3<f32>(at, 1.0) * width);
    let normal = file_normal(triangle, v0, v1, v2);
    return Clipped(vec4<f32>(clip_place(at), 0.5, 1.0) * width, distances, image.t, normal, triangle.w, piece);
}

@fragment
fn warp_pixel(corner: Corner) -> Drawn {
    return seen_through(corner);
}

// warp: vertices where the camera shows them, edges straight between them (Brosz et al. 2007; Popescu et al., section 4.2).
// Every triangle is first split into 4^LEVELS. An instance is a piece.
// Needs: Clipped, Corner, Drawn, clip_place, file_normal, image_of, outline_distances, piece_at, piece_origin, seen_through, triangle_at,
//   vertex
// Binds: outlines

override LEVELS: u32 = 0u;

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
    let triangle = triangle_at(index / 3u / parts);
    let v0 = vertex(triangle.x);
    let v1 = vertex(triangle.y);
    let v2 = vertex(triangle.z);
    let w = part_weights(index / 3u % parts, index % 3u);
    let q = piece_at(piece);
    let image = image_of(q, w.x * v0 + w.y * v1 + w.z * v2);
    // what lies behind an eye is clipped off
    let width = select(image.width, -image.width, image.t < 0.0);
    let at = piece_origin(q) + image.place;
    let distances = outline_distances(outlines[q.number], vec3<f32>(at, 1.0) * width);
    let normal = file_normal(triangle, v0, v1, v2);
    return Clipped(vec4<f32>(clip_place(at), 0.5, 1.0) * width, distances, image.t, normal, triangle.w, piece);
}

@fragment
fn warp_pixel(corner: Corner) -> Drawn {
    return seen_through(corner);
}

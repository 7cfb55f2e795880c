// The faces of a cube map: +x, -x, +y, -y, +z, -z.

// A vector from the eye: two coordinates across the face, [-1, 1] of it where they are as large as the third, which is above 0
// before the face.
fn on_face(face: u32, m: vec3<f32>) -> vec3<f32> {
    let s = select(1.0, -1.0, face % 2u == 1u);
    switch face / 2u {
        case 0u: { return vec3<f32>(m.y, m.z, s * m.x); }
        case 1u: { return vec3<f32>(m.z, m.x, s * m.y); }
        default: { return vec3<f32>(m.x, m.y, s * m.z); }
    }
}

// The face that a vector goes through.
fn face_of(m: vec3<f32>) -> u32 {
    let size = abs(m);
    if size.x >= size.y && size.x >= size.z {
        return select(0u, 1u, m.x < 0.0);
    }
    if size.y >= size.z {
        return select(2u, 3u, m.y < 0.0);
    }
    return select(4u, 5u, m.z < 0.0);
}

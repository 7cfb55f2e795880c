// One ordinary picture in place of the faces of a cube map.

#import rivals/layout.wgsl

// A vector from the eye: two coordinates across the picture, [-1, 1] of it where they are as large as the third, which is above 0
// before it.
fn on_face(face: u32, m: vec3<f32>) -> vec3<f32> {
    return vec3<f32>(dot(cube.right, m), dot(cube.up, m), dot(cube.forward, m));
}

// All of it is before the one picture.
fn face_of(m: vec3<f32>) -> u32 {
    return 0u;
}

// A ray in f32, relative to the anchor.
struct Ray {
    p: vec3<f32>,
    d: vec3<f32>,
}

// Light that matte surfaces send back.

fn sent_back(slot: u32, albedo: vec3<f32>, n: vec3<f32>, view: vec3<f32>) -> vec3<f32> {
    return albedo * received(n, view);
}

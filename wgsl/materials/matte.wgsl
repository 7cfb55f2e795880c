// Diffuse reflection.
// Provides: sent_back
// Needs: Lit, received

fn sent_back(lit: Lit, albedo: vec3<f32>) -> vec3<f32> {
    return albedo * received(lit);
}

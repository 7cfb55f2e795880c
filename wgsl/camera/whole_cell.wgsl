// Rays without an affine bundle: the tile's node is all that bounds a cell.
fn cell_pixels(index: u32, v0: vec3<f32>, v1: vec3<f32>, v2: vec3<f32>) -> vec4<u32> {
    return vec4<u32>(0u, 0u, TILE, TILE);
}

// Coherent rays: what a node meets, its rays may meet.
// Provides: tile_meets
// Needs: Node

fn tile_meets(x: u32, y: u32, node: Node, centre: vec3<f32>, half: vec3<f32>) -> bool {
    return true;
}

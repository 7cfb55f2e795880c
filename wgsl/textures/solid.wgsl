// Triangles without alpha masks.
// Provides: is_there, take_place
// Needs: Bundle

fn take_place(pixel: vec2<u32>) {}

fn is_there(slot: u32, b: Bundle) -> bool {
    return true;
}

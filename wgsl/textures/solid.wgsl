// Triangles without alpha masks.
// Provides: is_solid, is_there
// Needs: Bundle

fn is_solid(slot: u32) -> bool {
    return true;
}

fn is_there(slot: u32, b: Bundle) -> bool {
    return true;
}

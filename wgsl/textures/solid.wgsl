// Triangles without holes.
// Provides: is_there
// Needs: Bundle

fn is_there(slot: u32, b: Bundle) -> bool {
    return true;
}

// Triangles without alpha masks.
// Provides: is_there
// Needs: Bundle

fn is_there(slot: u32, b: Bundle) -> bool {
    return true;
}

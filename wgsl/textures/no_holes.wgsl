// No triangle has holes.
// Provides: is_solid

fn is_solid(slot: u32) -> bool {
    return true;
}

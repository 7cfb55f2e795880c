// No triangle has holes.

fn is_solid(slot: u32) -> bool {
    return true;
}

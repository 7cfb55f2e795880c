// What f32 does not prove, left to recheck.
// Provides: leave_to_recheck
// Needs: COUNT_RECHECK_ITEMS
// Binds: counters, params, recheck_items

// An item: twice the pair's index, 1 more for the tile's lower half; and the pixels there.
fn leave_to_recheck(half: u32, uncertain: u32) {
    if uncertain != 0u {
        let at = atomicAdd(&counters[COUNT_RECHECK_ITEMS], 1u);
        if at < params.recheck_capacity {
            recheck_items[at] = vec2<u32>(half, uncertain);
        }
    }
}

// What f32 does not prove, left to recheck.
// Provides: leave_to_recheck
// Needs: COUNT_DOUBTS
// Binds: counters, doubts, params

// A doubt: twice the pair's index, 1 more for the tile's lower half; and the pixels there.
fn leave_to_recheck(half: u32, doubtful: u32) {
    if doubtful != 0u {
        let at = atomicAdd(&counters[COUNT_DOUBTS], 1u);
        if at < params.doubt_capacity {
            doubts[at] = vec2<u32>(half, doubtful);
        }
    }
}

// Pairs that wait until every lane of a subgroup has one.

#import lanes
#import shared/params.wgsl

const UPPER: u32 = 1u;
const LOWER: u32 = 2u;

struct Waiting {
    index: u32,     // in `pairs`
    halves: u32,    // of the tile that it may cover: UPPER, LOWER
}

// The lane that holds the n-th of the bits, LANES or more where there are no more than n.
fn lane_of(bits: u32, n: u32) -> u32 {
    let a = bits & (bits - 1u);
    let b = a & (a - 1u);
    let c = b & (b - 1u);
    let d = c & (c - 1u);
    let e = d & (d - 1u);
    let f = e & (e - 1u);
    let g = f & (f - 1u);
    let low = select(select(bits, a, n == 1u), select(b, c, n == 3u), n >= 2u);
    let high = select(select(d, e, n == 5u), select(f, g, n == 7u), n >= 6u);
    return select(firstTrailingBit(select(low, high, n >= 4u)), LANES, n >= LANES);
}

// The pair at a place in the line, of `count` before: what was there, or of those that the lanes add, whose bits are set.
fn in_line(before: Waiting, added: Waiting, bits: u32, place: u32, count: u32) -> Waiting {
    let lane = lane_of(bits, place - count);
    let is_new = place >= count && lane < LANES;
    let index = subgroupShuffle(added.index, subgroup_lane(lane % LANES));
    let halves = subgroupShuffle(added.halves, subgroup_lane(lane % LANES));
    return Waiting(select(before.index, index, is_new), select(before.halves, halves, is_new));
}

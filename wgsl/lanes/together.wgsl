// What the threads of a subgroup of LANES find together, without loops: software adapters count the rounds of these.

#import lanes

fn lanes_any(bits: u32, lane: u32) -> u32 {
    let two = bits | subgroupShuffle(bits, subgroup_lane(lane ^ 1u));
    let four = two | subgroupShuffle(two, subgroup_lane(lane ^ 2u));
    return four | subgroupShuffle(four, subgroup_lane(lane ^ 4u));
}

fn lanes_max(value: f32, lane: u32) -> f32 {
    let two = max(value, subgroupShuffle(value, subgroup_lane(lane ^ 1u)));
    let four = max(two, subgroupShuffle(two, subgroup_lane(lane ^ 2u)));
    return max(four, subgroupShuffle(four, subgroup_lane(lane ^ 4u)));
}

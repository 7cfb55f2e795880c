// Lanes that are LANES threads, one after the other, of a larger subgroup.

#import shared/params.wgsl

var<private> first_lane: u32;

// The lane of a thread, from its place in the subgroup.
fn take_lane(place: u32) -> u32 {
    first_lane = place & ~(LANES - 1u);
    return place - first_lane;
}

// The place of one of the lanes in the subgroup.
fn subgroup_lane(lane: u32) -> u32 {
    return first_lane + lane;
}

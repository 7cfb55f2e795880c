// Lanes that are a whole subgroup.

// The lane of a thread, from its place in the subgroup.
fn take_lane(place: u32) -> u32 {
    return place;
}

// The place of one of the lanes in the subgroup.
fn subgroup_lane(lane: u32) -> u32 {
    return lane;
}

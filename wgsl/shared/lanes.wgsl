// What the threads of a subgroup of LANES find together, without loops: software adapters count the rounds of these.

fn lanes_any(bits: u32, lane: u32) -> u32 {
    let two = bits | subgroupShuffle(bits, lane ^ 1u);
    let four = two | subgroupShuffle(two, lane ^ 2u);
    return four | subgroupShuffle(four, lane ^ 4u);
}

fn lanes_max(value: f32, lane: u32) -> f32 {
    let two = max(value, subgroupShuffle(value, lane ^ 1u));
    let four = max(two, subgroupShuffle(two, lane ^ 2u));
    return max(four, subgroupShuffle(four, lane ^ 4u));
}

// The number that one of the lanes has.
fn lanes_real(value: real, lane: u32) -> real {
    let words = words_of(value);
    return of_words(vec2<u32>(subgroupShuffle(words.x, lane), subgroupShuffle(words.y, lane)));
}

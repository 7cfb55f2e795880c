// Items are the pixels of the band, row by row.

fn place_of(item: u32) -> vec2<u32> {
    return vec2<u32>(item % params.width, item / params.width);
}

// Rays are looked up where they are asked for.
fn look_at(x: u32, y: u32, thread: u32) {
}

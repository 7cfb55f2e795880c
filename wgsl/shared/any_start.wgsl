// Rays that start on no triangle: all that are not turned.

fn is_apart(id: u32) -> bool {
    return false;
}

fn starts_on(pixel: u32, id: u32) -> bool {
    return false;
}

// Rays that start on a surface, which they do not meet there.

// No turned ray meets the triangle.
fn is_apart(id: u32) -> bool {
    return id >= optic.first_id && optic.sees_itself == 0u;
}

// The pixel's ray starts on the triangle.
fn starts_on(pixel: u32, id: u32) -> bool {
    return ways[pixel].last == id;
}

// What the visibility buffer holds of a pixel.

var<storage, read> visibility: array<vec2<u32>>;

// A complemented visibility key, low word first; 0 of none.
fn pixel_key(pixel: u32) -> vec2<u32> {
    return visibility[pixel];
}

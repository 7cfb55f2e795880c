// What the visibility buffer holds of a pixel.
// Provides: pixel_key
// Binds: visibility

// A complemented visibility key, low word first; 0 of none.
fn pixel_key(pixel: u32) -> vec2<u32> {
    return visibility[pixel];
}

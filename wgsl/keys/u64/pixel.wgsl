// What the visibility buffer holds of a pixel, loaded as one number: software adapters load each number of each thread by itself.

var<storage, read> visibility: array<u64>;

// A complemented visibility key, low word first; 0 of none.
fn pixel_key(pixel: u32) -> vec2<u32> {
    let key = visibility[pixel];
    return vec2<u32>(u32(key & 0xfffffffflu), u32(key >> 32u));
}

// Merges a complemented key by 32-bit atomics, in two dispatches of one pipeline: the high words, then the low words
// of the keys whose high word won. The bytes are those of one 64-bit atomic.

#import shared/params.wgsl

var<storage, read_write> visibility: array<atomic<u32>>;

fn merge(pixel: u32, key: vec2<u32>) {
    if step.value == 0u {
        atomicMax(&visibility[2u * pixel + 1u], key.y);
    } else if atomicLoad(&visibility[2u * pixel + 1u]) == key.y {
        atomicMax(&visibility[2u * pixel], key.x);
    }
}

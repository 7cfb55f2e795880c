// Merges a complemented key by one 64-bit atomic.

var<storage, read_write> visibility: array<atomic<u64>>;

fn merge(pixel: u32, key: vec2<u32>) {
    atomicMax(&visibility[pixel], (u64(key.y) << 32u) | u64(key.x));
}

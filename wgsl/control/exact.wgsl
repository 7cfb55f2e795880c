// exact: one thread per case. Reads a pair of f32 and three numbers; writes what the operations that kernels need without rounding make of
// them: the pair's sum and product, the pair that the first number splits into, and on which side of 1 the product of the others lies.

#choose arithmetic f64
#import arithmetic
#import arithmetic/f64.wgsl

var<storage, read> given: array<vec4<u32>>;
var<storage, read_write> found: array<vec4<u32>>;

@compute @workgroup_size(64)
fn exact(@builtin(local_invocation_index) k: u32) {
    if 2u * k >= arrayLength(&given) {
        return;
    }
    let first = given[2u * k];
    let pair = bitcast<vec2<f32>>(first.xy);
    let number = real_from_bits(first.zw);
    let factors = given[2u * k + 1u];
    let order = order_of_products(real_from_bits(factors.xy), real_from_bits(factors.zw), 1.0, 1.0);
    let sum = real(pair.x) + real(pair.y);
    let product = real(pair.x) * real(pair.y);
    let head = round_to_f32(number);
    found[2u * k] = vec4<u32>(real_to_bits(sum), real_to_bits(product));
    found[2u * k + 1u] = vec4<u32>(bitcast<u32>(f32(head)), bitcast<u32>(f32(number - head)), bitcast<u32>(order), 0u);
}

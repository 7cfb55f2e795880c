// contend: one thread per proven image of points: whether it may be the nearest of its pixel.
// Reads `images`, its length and `nearest`; writes bits of `wanted`: of points with an image that no other is proven to hide, or whose
// pixel is not proven.

#import project/layout.wgsl
#import project/rising.wgsl
#import shared/items.wgsl
#import shared/params.wgsl

var<storage, read> counts: array<u32>;
var<storage, read> images: array<SolveImage>;
var<storage, read> nearest: array<u32>;
var<storage, read_write> wanted: array<atomic<u32>>;

@compute @workgroup_size(64)
fn contend(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let item = item_index(group, groups, lane);
    if item >= min(counts[0], solving.images_most) {
        return;
    }
    let image = images[item];
    if image.point == NONE {
        return;
    }
    if image.pixel == NONE || rising_bits(image.t - image.error_t) <= nearest[image.pixel] {
        atomicOr(&wanted[image.point / 32u], 1u << (image.point % 32u));
    }
}

// claim: one thread per proven image of points: the least t that each pixel is sure to have.
// Reads `images` and its length; writes to `nearest` the upper bound of t, as bits that ascend with it.

#import project/layout.wgsl
#import project/rising.wgsl
#import shared/items.wgsl
#import shared/params.wgsl

var<storage, read> counts: array<u32>;
var<storage, read> images: array<SolveImage>;
var<storage, read_write> nearest: array<atomic<u32>>;

@compute @workgroup_size(64)
fn claim(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let item = item_index(group, groups, lane);
    if item >= min(counts[0], solving.images_most) {
        return;
    }
    let image = images[item];
    if image.pixel != NONE && image.point != NONE {
        atomicMin(&nearest[image.pixel], rising_bits(image.t + image.error_t));
    }
}

// meet: one thread per pixel of the band that may have a ray.
// Reads the pixel's ray, or the rays of its layers, and its path state; merges the visibility key of the nearest smooth surface that
// they meet. Ids of smooth surfaces follow those of all triangles.

#import arithmetic
#import keys/key.wgsl
#import keys/merge
#import nodes/slabs.wgsl
#import optics/layout.wgsl
#import optics/smooth/bounce.wgsl
#import pixels/live.wgsl
#import rays/pixel
#import shared/params.wgsl

@compute @workgroup_size(64)
fn meet(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    // take a pixel that has a ray
    let place = pixel_at(group, groups, lane);
    if place.x >= params.width || place.y >= params.height {
        return;
    }
    let x = place.x;
    let y = place.y;
    let pixel = y * params.width + x;
    if optic.bounces > 0u && optic.sees_itself == 0u {
        return;
    }

    // find the nearest surface in the lowest layer that meets one
    let layers = select(1u, params.tiles_y / max(params.slab_rows * params.spans, 1u), SLABBED);
    var nearest = Root(real(0.0), false);
    var id = NONE;
    for (var layer = 0u; layer < layers && !nearest.found; layer++) {
        if has_ray(layer, x, y) {
            let b = ray_bundle(layer, x, y, 0.0);
            let p = b.p / b.h;
            let d = b.d / b.h;
            for (var k = 0u; k < optic.count; k++) {
                let root = meeting_with(k, p, d, paths[pixel].last);
                if root.found && (!nearest.found || root.t < nearest.t) {
                    nearest = root;
                    id = optic.first_id + k;
                }
            }
            if nearest.found {
                merge(pixel, ~visibility_key(layer, nearest.t, id));
            }
        }
    }
}

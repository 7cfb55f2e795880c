// trace: one thread per pixel, one workgroup per tile.
// Reads the chunk's hierarchy, its triangles and vertices, cells and the camera's rays; follows each pixel's path to the nearest triangle
// that it meets at a t in range, and writes that. Triangles of which f32 proves neither a hit nor a miss are left to recheck.
// The list recheck_items may overflow: the counter keeps counting. What takes too many steps is counted, too.

#import hierarchy/followed.wgsl
#import hierarchy/nodes.wgsl
#import masks/opacity
#import nodes/slabs.wgsl
#import pixels/tiles
#import rays/path
#import rays/pixel
#import rays/seen
#import rays/stretch
#import shared/params.wgsl
#import vertices/followed
#import vertices/vertex

override COUNTING: bool = false;

@compute @workgroup_size(64)
fn trace(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    // take a pixel
    let at = pixel_at(group, groups, lane);
    if at.x >= params.width || at.y >= params.height {
        return;
    }

    // follow its path, layer by layer and stretch by stretch, to the first triangle
    let layers = select(1u, params.tiles_y / max(params.slab_rows * params.spans, 1u), SLABBED);
    var layer = 0u;
    // software adapters end all loops of threads that together have taken 65535 rounds: then this one does not come to its end
    var is_finished = false;
    loop {
        if layer == layers {
            is_finished = true;
            break;
        }
        if has_ray(layer, at.x, at.y) {
            take_moment(at.y * params.width + at.x);
            take_place(at);
            let path = path_of(layer, at.x, at.y);
            var seen = nothing_seen();
            var rounds = 0u;
            var tested = 0u;
            var k = 0u;
            loop {
                if k == stretches() {
                    break;
                }
                let stretch = stretch_of(path, k, bvh_scale());
                let found = followed(path, stretch, seen, rounds);
                seen = found.seen;
                rounds = found.rounds;
                tested += found.tested;
                k++;
                // a hit near the end of a stretch may be level with one in the next
                if last_of(stretch, seen) < stretch.last + 2.0 * min(stretch.first, 0.0) || rounds >= ROUNDS {
                    break;
                }
            }
            if rounds >= ROUNDS {
                atomicAdd(&counters[COUNT_UNFINISHED], 1u);
            }
            var kept = 0u;
            if is_seen(seen) {
                kept = 1u - keep_seen(path, seen, at.y * params.width + at.x);
                layer = layers - 1u;
            }
            if COUNTING && step.value == 0u {
                atomicAdd(&counters[COUNT_FRAGMENTS_TESTED], tested);
                atomicAdd(&counters[COUNT_FRAGMENTS_KEPT], kept);
            }
        }
        layer++;
    }
    if !is_finished {
        atomicAdd(&counters[COUNT_UNFINISHED], 1u);
    }
}

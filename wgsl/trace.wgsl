// trace: one thread per pixel, one workgroup per tile.
// Reads the chunk's hierarchy, its triangles and vertices, cells and the camera's rays; follows each pixel's path to the nearest triangle
// that it meets at a t in range, and writes that. Triangles of which f32 proves neither a hit nor a miss are left to recheck.
// The list recheck_items may overflow: the counter keeps counting. What takes too many steps is counted, too.
// Needs: COUNT_FRAGMENTS_KEPT, COUNT_FRAGMENTS_TESTED, COUNT_UNFINISHED, Path, SLABBED, Seen, Stretch, box_hits, bvh_root, bvh_scale,
//   bvh_triangle, has_ray, is_seen, keep_seen, last_of, nothing_seen, path_of, pixel_at, stretch_of, stretches, take_moment, with_primitive
// Binds: counters, params, step

// The most boxes and triangles that a path is tested against: software adapters end a loop when its 16 threads together have taken 65535
// rounds.
const ROUNDS: u32 = 4000u;

override COUNTING: bool = false;

// Groups of boxes that wait; the host refuses deeper hierarchies.
const STACK: u32 = 32u;

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
    loop {
        if layer == layers {
            break;
        }
        if has_ray(layer, at.x, at.y) {
            take_moment(at.y * params.width + at.x);
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
}

// What a path met, after how many nodes and triangles in all, and how many triangles of its stretch.
struct Followed {
    seen: Seen,
    rounds: u32,
    tested: u32,
}

// Walks a hierarchy with eight boxes a node (Ylitie et al. 2017). A group stands for the children of one node that are nodes themselves:
// x is the index of the first; the low byte of y says which of the eight children are nodes, the high byte which of these the path may
// still meet, the nearest in the highest bit.
fn followed(path: Path, stretch: Stretch, before: Seen, rounds_before: u32) -> Followed {
    let d = stretch.d;
    let least = vec3<f32>(1.0e-20);
    let inverse = 1.0 / select(d, select(least, -least, d < vec3<f32>(0.0)), abs(d) < least);
    let octant = select(4u, 0u, d.x < 0.0) | select(2u, 0u, d.y < 0.0) | select(1u, 0u, d.z < 0.0);
    var seen = before;
    var rounds = rounds_before;
    var tested = 0u;
    var waiting: array<vec2<u32>, STACK>;
    var count = 0u;
    var group = vec2<u32>(bvh_root(), 0x80000000u);
    loop {
        // take the nearest box of the group, and look at the eight below it
        let bit = firstLeadingBit(group.y);
        let node = group.x + countOneBits(group.y & ~(0xffffffffu << ((bit - 24u) ^ octant)));
        group.y &= ~(1u << bit);
        waiting[count] = group;
        count += select(0u, 1u, group.y >= 0x1000000u);
        let met = box_hits(node, stretch, inverse, octant, last_of(stretch, seen));
        group = met.nodes;
        rounds += 1u + countOneBits(met.triangles);
        tested += countOneBits(met.triangles);

        // test the triangles of those that are leaves
        var triangles = met.triangles;
        loop {
            if triangles == 0u {
                break;
            }
            let index = met.first_triangle + firstTrailingBit(triangles);
            triangles &= triangles - 1u;
            seen = with_primitive(path, stretch, seen, bvh_triangle(index));
        }
        if rounds >= ROUNDS {
            break;
        }
        if group.y < 0x1000000u {
            if count == 0u {
                break;
            }
            count--;
            group = waiting[count];
        }
    }
    return Followed(seen, rounds, tested);
}

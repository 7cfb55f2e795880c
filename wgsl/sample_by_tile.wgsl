// sample, tile by tile: one subgroup of LANES threads per block, one thread per strip of it: four samples of an edge pixel.
// Reads triangles, vertices, nodes, the camera's rays, the blocks, the records of `samples` and what pixels pairs may cover; writes the
// nearest key of each sample into its record, and leaves what f32 does not prove to recheck_samples, two words each: the pair, the strip
// and its rays as bits; the pixel.
// The list recheck_items may overflow: the counter keeps counting.
// Loops that run at least once end with their test: software adapters run what stands behind one at the start once more.

#import arithmetic
#import depth/column
#import depth/edges.wgsl
#import depth/exact/test.wgsl
#import depth/test
#import lanes
#import lanes/loads/node
#import lanes/together.wgsl
#import rays/strip
#import samples/cells.wgsl
#import shared/bits.wgsl
#import shared/items.wgsl
#import shared/params.wgsl
#import shared/places.wgsl
#import shared/waiting.wgsl
#import vertices/still/vertex.wgsl
#import vertices/vertex

var<storage, read> blocks: array<vec4<u32>>;
var<storage, read> touches: array<vec4<u32>>;
var<storage, read_write> recheck_items: array<vec2<u32>>;
var<storage, read_write> samples: array<vec2<u32>>;

@compute @workgroup_size(64)
fn sample(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
    @builtin(subgroup_invocation_id) place: u32,
) {
    let lane = take_lane(place);
    // take a block
    let item = group_index(group, groups) * (GROUP / LANES) + thread / LANES;
    if item >= atomicLoad(&counters[COUNT_BLOCKS]) {
        return;
    }
    let block = blocks[item];
    let tile = block.x & 0x00ffffffu;
    let size_of_block = block.x >> 24u;
    let is_one = lane < size_of_block;
    let strip = block.y + min(lane, size_of_block - 1u);
    let record = (strip / STRIPS) * (SAMPLES + 1u);
    let first = 4u * (strip % STRIPS);
    let pixel = samples[record].x;
    let x = pixel % params.width;
    let y = pixel / params.width;
    let bit = bit_mask((y % TILE) * TILE + x % TILE);
    let pixels = vec2<u32>(lanes_any(bit.x, lane), lanes_any(bit.y, lane));
    let node = item_node(tile, lane);
    let centre = real3(node.p);
    let rays = sample_strip(tile, x, y, first, centre);
    let exists = rays.exists & vec4<bool>(is_one);
    let lines = lines_of(rays.strip, exists);
    let reach_q = lanes_max(reach_of(lines), lane);

    var nearest = nothing_nearest();
    let end = block.w;
    var at = block.z;
    var next = Waiting(0u, 0u);
    var after = Waiting(0u, 0u);
    var waiting = 0u;
    loop {
        // examine pairs, one per lane, until every lane has one to test
        loop {
            let index = min(at + lane, end - 1u);
            let may = at + lane < end && any((touches[index].xy & pixels) != vec2<u32>(0u));
            let bits = lanes_any(select(0u, 1u << lane, may), lane);
            next = in_line(next, Waiting(index, 0u), bits, lane, waiting);
            after = in_line(after, Waiting(index, 0u), bits, lane + LANES, waiting);
            waiting += countOneBits(bits);
            at += LANES;
            if waiting >= LANES || at >= end {
                break;
            }
        }
        let pair = next;
        var left = (1u << min(waiting, LANES)) - 1u;
        next = after;
        waiting = max(waiting, LANES) - LANES;
        let triangle = triangle_at(touches[pair.index].z);
        let hi = array<vec3<f32>, 3>(vertex(triangle.x), vertex(triangle.y), vertex(triangle.z));
        let v0 = real3(hi[0]) + real3(vertex_lo(triangle.x));
        let v1 = real3(hi[1]) + real3(vertex_lo(triangle.y));
        let v2 = real3(hi[2]) + real3(vertex_lo(triangle.z));
        let reach = max(size(hi[0]), max(size(hi[1]), size(hi[2]))) + size(node.p);
        let own = shared_of(triangle, v0, v1, v2, centre, reach, reach_q);

        // test each against the strips
        var unproven = 0u;
        loop {
            let is_left = vec4<bool>(left != 0u);
            let k = firstTrailingBit(left) % LANES;
            left &= left - 1u;
            let found = test_pixels(given(own, k), lines, rays.strip, exists & is_left, vec4<u32>(NONE), nearest);
            nearest = found.nearest;
            unproven |= row_bits(found.uncertain) << (4u * k);
            if left == 0u {
                break;
            }
        }

        // leave items to recheck, pair by pair
        var uncertain = lanes_any(unproven, lane);
        loop {
            if uncertain == 0u {
                break;
            }
            let k = firstTrailingBit(uncertain) / 4u;
            uncertain &= ~(15u << (4u * k));
            leave_to_recheck_samples(pixel, subgroupShuffle(pair.index, subgroup_lane(k)), strip, (unproven >> (4u * k)) & 15u);
        }
        if waiting == 0u && at >= end {
            break;
        }
    }

    // write the nearest of each sample
    if is_one {
        for (var k = 0u; k < 4u; k++) {
            if first + k < SAMPLES {
                samples[record + 1u + first + k] = complemented_key(0u, nearest.keys[k]);
            }
        }
    }
}

fn leave_to_recheck_samples(pixel: u32, pair: u32, strip: u32, rays: u32) {
    if rays != 0u {
        let at = take_places(COUNT_RECHECK_SAMPLES, 1u);
        if at < params.recheck_capacity / 2u {
            recheck_items[2u * at] = vec2<u32>(pair, (strip << 4u) | rays);
            recheck_items[2u * at + 1u] = vec2<u32>(pixel, 0u);
        }
    }
}

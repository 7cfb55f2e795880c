// edges, tile by tile: one subgroup of LANES threads per tile, one thread per column of it, once all is in the visibility buffer.
// Reads the runs of pairs of tiles, nodes, the visibility buffer and which cells samples lie in; finds the edge pixels,
// as edges does pair by pair, in one pass over the pairs of a tile: what the triangle seen at a pixel's centre bounds, and how near
// all others may be that may cover any of its samples. Writes a record in `samples` for each such pixel, its number into `edge_of`, of
// each pair the pixels that it may cover and its slot into `touches`, and `blocks` of LANES strips, four samples each, of the records of
// one tile.
// Records and blocks may overflow: the counter of records keeps counting, and blocks have space for all records.

#choose arithmetic f32
#import keys/key.wgsl
#import lanes
#import lanes/loads/node
#import lanes/together.wgsl
#import nodes/conics.wgsl
#import nodes/extent.wgsl
#import nodes/slabs.wgsl
#import nodes/tables.wgsl
#import nodes/within.wgsl
#import pairs/pair.wgsl
#import samples/cells.wgsl
#import samples/depth_bounds.wgsl
#import samples/four.wgsl
#import shared/bits.wgsl
#import shared/items.wgsl
#import shared/params.wgsl
#import vertices/triangle.wgsl
#import vertices/vertex

var<storage, read> ends: array<u32>;
var<storage, read> pairs: array<vec2<u32>>;
var<storage, read> starts: array<u32>;
var<storage, read> visibility: array<vec2<u32>>;
var<storage, read_write> blocks: array<vec4<u32>>;
var<storage, read_write> edge_of: array<u32>;
var<storage, read_write> samples: array<vec2<u32>>;
var<storage, read_write> touches: array<vec4<u32>>;

@compute @workgroup_size(64)
fn edges(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
    @builtin(subgroup_invocation_id) place: u32,
) {
    let lane = take_lane(place);
    // take a tile that has pairs
    let tile = group_index(group, groups) * (GROUP / LANES) + thread / LANES;
    if tile >= params.tiles_x * params.tiles_y {
        return;
    }
    let end = ends[tile];
    if end == 0u {
        return;
    }
    let node = item_node(tile, lane);
    var part = vec2<u32>(0u);
    var whole = vec2<u32>(0u);
    for (var k = tile_start[tile]; k < tile_start[tile + 1u]; k++) {
        part |= pixels_in_part(k);
        whole |= pixels_whole(k);
    }
    let x = (f32(lane) + 0.5) * NODE_PX - 1.0;
    var upper = four(tile, lane, 0u, part, whole);
    var lower = four(tile, lane, 4u, part, whole);

    // bound all its pairs over it
    var at = starts[tile];
    loop {
        let index = min(at + lane, end - 1u);
        let triangle = triangle_at(pair_slot(vec2<u32>(pairs[index].x, 0u)));
        let v0 = vertex(triangle.x);
        let v1 = vertex(triangle.y);
        let v2 = vertex(triangle.z);
        let sides = conics(node, v0, v1, v2);
        let seen = extent(node, v0, v1, v2);
        let may = at + lane < end && !is_empty(pixels_within(seen, TILE, SAMPLE_REACH))
            && may_cover(sides, 0.0, 0.0, CENTRES + SAMPLE_REACH * NODE_PX);
        let flat = plane(node, v0, v1, v2);
        let s = SAMPLE_REACH * NODE_PX;
        let margin = s * vec2<f32>(abs(flat.along.y) + abs(flat.along.z), abs(flat.across.y) + abs(flat.across.z));
        let own = Bounds(
            side(sides.e01, 1.0), side(sides.e02, -1.0), side(sides.e12, 1.0),
            flat.along, flat.across, margin + vec2<f32>(flat.error_along, flat.error_across),
            triangle_id(triangle),
        );
        var left = lanes_any(select(0u, 1u << lane, may), lane);
        var touched = vec2<u32>(0u);
        loop {
            let is_left = left != 0u;
            let k = firstTrailingBit(left) % LANES;
            left &= left - 1u;
            let q = given_bounds(own, k);
            if is_left {
                upper = bound(q, x, upper);
                lower = bound(q, x, lower);
                let pixels = vec2<u32>(rows_mask(1u << lane, upper.touched), rows_mask(1u << lane, lower.touched));
                let all = vec2<u32>(lanes_any(pixels.x, lane), lanes_any(pixels.y, lane));
                touched = select(touched, all, lane == k);
            }
            if left == 0u {
                break;
            }
        }
        if at + lane < end {
            touches[at + lane] = vec4<u32>(touched, pair_slot(vec2<u32>(pairs[index].x, 0u)), 0u);
        }
        at += LANES;
        if at >= end {
            break;
        }
    }

    // list the edge pixels, and their strips
    let edges_upper = edge_pixels(upper);
    let edges_lower = edge_pixels(lower);
    let edge_bits = vec2<u32>(
        lanes_any(rows_mask(1u << lane, edges_upper), lane),
        lanes_any(rows_mask(1u << lane, edges_lower), lane),
    );
    let count = countOneBits(edge_bits.x) + countOneBits(edge_bits.y);
    var first = 0u;
    if lane == 0u {
        first = atomicAdd(&counters[COUNT_EDGES], count);
    }
    first = subgroupShuffle(first, subgroup_lane(0u));
    if count == 0u || first + count > params.edge_capacity {
        return;
    }
    let corner = tile_corner(tile);
    for (var y = 0u; y < TILE; y++) {
        let bit = y * TILE + lane;
        let own = bit_mask(bit);
        if any((edge_bits & own) != vec2<u32>(0u)) {
            let below = vec2<u32>(select(edge_bits.x, edge_bits.x & (own.x - 1u), bit < 32u), select(edge_bits.y & (own.y - 1u), 0u, bit < 32u));
            let record = first + countOneBits(below.x) + countOneBits(below.y);
            let pixel = (corner.y + y) * params.width + corner.x + lane;
            let won = visibility[pixel];
            samples[record * (SAMPLES + 1u)] = vec2<u32>(pixel, select(key_id(~won), NONE, all(won == vec2<u32>(0u))));
            edge_of[pixel] = record + 1u;
        }
    }
    let strips = count * STRIPS;
    let block_count = (strips + LANES - 1u) / LANES;
    var block = 0u;
    if lane == 0u {
        block = atomicAdd(&counters[COUNT_BLOCKS], block_count);
    }
    block = subgroupShuffle(block, subgroup_lane(0u));
    for (var k = lane; k < block_count; k += LANES) {
        let size = min(strips - k * LANES, LANES);
        blocks[block + k] = vec4<u32>(tile | (size << 24u), first * STRIPS + k * LANES, starts[tile], end);
    }
}

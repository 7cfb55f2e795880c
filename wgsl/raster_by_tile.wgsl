// raster, tile by tile: one subgroup of LANES threads per busy tile, one thread per column of it.
// Reads what raster reads pair by pair, the run of pairs of each tile and the busy tiles; writes one triangle per pixel, the nearest
// of all pairs of its tile, and leaves what f32 does not prove to recheck. A tile of more than ROUNDS times LANES pairs is listed as
// busy again, with what is left of its run. The list recheck_items may overflow: the counter keeps counting.
// Loops that run at least once end with their test: software adapters run what stands behind one at the start once more.

#import depth/column
#import depth/columns
#import depth/nearest
#import lanes
#import lanes/loads/node
#import lanes/together.wgsl
#import nodes/conics.wgsl
#import nodes/extent.wgsl
#import nodes/slabs.wgsl
#import nodes/within.wgsl
#import optics/start
#import pairs/pair.wgsl
#import shared/items.wgsl
#import shared/params.wgsl
#import shared/places.wgsl
#import shared/waiting.wgsl
#import vertices/triangle.wgsl
#import vertices/vertex

var<storage, read> ends: array<u32>;
var<storage, read> pairs: array<vec2<u32>>;
var<storage, read_write> busy: array<u32>;
var<storage, read_write> recheck_items: array<vec2<u32>>;
var<storage, read_write> starts: array<u32>;

// Rounds of LANES pairs that a subgroup looks at, at most: software adapters end a thread's loops after 65535 rounds in all. Of what a
// round leaves, LANES pairs at most, each is tested against either half and may be left to recheck: 16 rounds for the tests, 9 for the loop
// over what is left, 16 for the loops in leave_column, and 2 for the loops around: 43.
const ROUNDS: u32 = 1500u;

override COUNTING: bool = false;

@compute @workgroup_size(64)
fn raster(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
    @builtin(subgroup_invocation_id) place: u32,
) {
    let lane = take_lane(place);
    // take a busy tile
    let item = atomicLoad(&counters[COUNT_BUSY_FIRST]) + group_index(group, groups) * (GROUP / LANES) + thread / LANES;
    if item >= atomicLoad(&counters[COUNT_BUSY_END]) {
        return;
    }
    let tile = busy[item];
    let node = item_node(tile, lane);
    let column = tile_column(tile, lane, node.p);
    let upper = lines_of(column.upper, column.has_upper);
    let lower = lines_of(column.lower, column.has_lower);
    let reach = tile_reach(column, upper, lower, lane);
    let corner = tile_corner(tile);
    let first_pixel = corner.y * params.width + corner.x + lane;
    let rows = vec4<u32>(0u, 1u, 2u, 3u) * params.width + first_pixel;
    let starts_upper = starts_of(rows);
    let starts_lower = starts_of(rows + 4u * params.width);

    var nearest_upper = nothing_nearest();
    var nearest_lower = nothing_nearest();
    var tested = 0u;
    var tested_upper = 0u;
    var tested_lower = 0u;
    var kept = 0u;
    let end = ends[tile];
    var at = starts[tile];
    var rounds = 0u;
    var first = Waiting(0u, 0u);
    var next = Waiting(0u, 0u);
    var waiting = 0u;
    var far_upper = INFINITE;
    var far_lower = INFINITE;
    loop {
        // examine pairs, one per lane, until every lane has one to test
        loop {
            let index = min(at + lane, end - 1u);
            let triangle = triangle_at(pair_slot(vec2<u32>(pairs[index].x, 0u)));
            let v0 = vertex(triangle.x);
            let v1 = vertex(triangle.y);
            let v2 = vertex(triangle.z);

            // leave one where the tile's bounds do, and where all pixels show what is nearer
            let seen = extent(node, v0, v1, v2);
            let within = pixels_within(seen, TILE, 0.0);
            let may = at + lane < end && !is_excluded(triangle_id(triangle)) && !is_empty(within)
                && may_cover(conics(node, v0, v1, v2), 0.0, 0.0, CENTRES);
            let may_upper = may && within.y < 4u && !is_behind(seen, far_upper);
            let may_lower = may && within.w > 4u && !is_behind(seen, far_lower);
            let added = Waiting(index, select(0u, UPPER, may_upper) | select(0u, LOWER, may_lower));
            let bits = lanes_any(select(0u, 1u << lane, added.halves != 0u), lane);
            first = in_line(first, added, bits, lane, waiting);
            next = in_line(next, added, bits, lane + LANES, waiting);
            waiting += countOneBits(bits);
            at += LANES;
            rounds++;
            if waiting >= LANES || at >= end || rounds >= ROUNDS {
                break;
            }
        }
        let is_one = lane < waiting;
        let pair = first;
        first = next;
        waiting = max(waiting, LANES) - LANES;
        let slot = pair_slot(vec2<u32>(pairs[pair.index].x, 0u));
        let triangle = triangle_at(slot);
        let hi = array<vec3<f32>, 3>(vertex(triangle.x), vertex(triangle.y), vertex(triangle.z));
        var left_upper = lanes_any(select(0u, 1u << lane, is_one && (pair.halves & UPPER) != 0u), lane);
        var left_lower = lanes_any(select(0u, 1u << lane, is_one && (pair.halves & LOWER) != 0u), lane);
        tested_upper += countOneBits(left_upper);
        tested_lower += countOneBits(left_lower);
        tested += countOneBits(left_upper | left_lower);

        // what the lanes will share of it
        let own = triangle_shared(slot, triangle, hi, node, reach);

        // test each against the pixels of either half
        var uncertain_upper = 0u;
        var uncertain_lower = 0u;
        loop {
            let is_left = vec4<bool>(left_upper != 0u);
            let k = firstTrailingBit(left_upper) % LANES;
            left_upper &= left_upper - 1u;
            let found = test_pixels(given(own, k), upper, column.upper, column.has_upper & is_left, starts_upper, nearest_upper);
            nearest_upper = found.nearest;
            uncertain_upper |= row_bits(found.uncertain) << (4u * k);
            if COUNTING {
                kept += countOneBits(row_bits(found.met));
            }
            if left_upper == 0u {
                break;
            }
        }
        loop {
            let is_left = vec4<bool>(left_lower != 0u);
            let k = firstTrailingBit(left_lower) % LANES;
            left_lower &= left_lower - 1u;
            let found = test_pixels(given(own, k), lower, column.lower, column.has_lower & is_left, starts_lower, nearest_lower);
            nearest_lower = found.nearest;
            uncertain_lower |= row_bits(found.uncertain) << (4u * k);
            if COUNTING {
                kept += countOneBits(row_bits(found.met));
            }
            if left_lower == 0u {
                break;
            }
        }

        far_upper = lanes_max(farthest(nearest_upper, column.upper, column.has_upper), lane);
        far_lower = lanes_max(farthest(nearest_lower, column.lower, column.has_lower), lane);

        // leave items to recheck, pair by pair
        let all = vec2<u32>(lanes_any(uncertain_upper, lane), lanes_any(uncertain_lower, lane));
        var uncertain = all.x | all.y;
        loop {
            if uncertain == 0u {
                break;
            }
            let k = firstTrailingBit(uncertain) / 4u;
            uncertain &= ~(15u << (4u * k));
            let uncertain_slot = subgroupShuffle(slot, subgroup_lane(k));
            let rows_upper = (uncertain_upper >> (4u * k)) & 15u;
            let rows_lower = (uncertain_lower >> (4u * k)) & 15u;
            leave_column(uncertain_slot, (tile << 6u) | lane, rows_upper | (rows_lower << 4u));
        }
        if waiting == 0u && (at >= end || rounds >= ROUNDS) {
            break;
        }
    }

    // keep the nearest of each pixel; recheck counts those that it proves nearest
    kept -= keep_nearest(tile, lane, rows, nearest_upper, nearest_lower);
    if COUNTING {
        atomicAdd(&counters[COUNT_FRAGMENTS_KEPT], kept);
        if lane == 0u {
            atomicAdd(&counters[COUNT_PAIRS_KEPT], tested);
        }
        let owned_upper = countOneBits(row_bits(column.has_upper));
        let owned_lower = countOneBits(row_bits(column.has_lower));
        atomicAdd(&counters[COUNT_FRAGMENTS_TESTED], tested_upper * owned_upper + tested_lower * owned_lower);
    }

    // leave the rest of its pairs
    if lane == 0u {
        if at < end {
            starts[tile] = at;
            busy[atomicAdd(&counters[COUNT_BUSY], 1u)] = tile;
        }
    }
}

// Beyond all t.
const INFINITE: f32 = 3.0e38;

// All that is seen of a triangle lies beyond t. Not said of segments, at whose ends several t are one.
fn is_behind(seen: Extent, t: f32) -> bool {
    return !SLABBED && seen.tight && seen.t_lo > t;
}

// Leaves the rows of a column of a tile to recheck whose bits are set: `item` is that of the first.
fn leave_column(slot: u32, item: u32, bits: u32) {
    var left = bits;
    // a loop: software adapters take every branch
    loop {
        if left == 0u {
            break;
        }
        left = 0u;
        let at = take_places(COUNT_RECHECK_ITEMS, countOneBits(bits));
        leave_row(slot, item, bits, at, 0u);
        leave_row(slot, item, bits, at, 1u);
        leave_row(slot, item, bits, at, 2u);
        leave_row(slot, item, bits, at, 3u);
        leave_row(slot, item, bits, at, 4u);
        leave_row(slot, item, bits, at, 5u);
        leave_row(slot, item, bits, at, 6u);
        leave_row(slot, item, bits, at, 7u);
    }
}

fn leave_row(slot: u32, item: u32, bits: u32, first: u32, row: u32) {
    let at = first + countOneBits(bits & ((1u << row) - 1u));
    if (bits & (1u << row)) != 0u && at < params.recheck_capacity {
        recheck_items[at] = vec2<u32>(slot, item + TILE * row);
    }
}

// The triangles that the rays of four pixels start on; a tile may reach beyond the band, where any will do.
fn starts_of(pixels: vec4<u32>) -> vec4<u32> {
    let rows = min(pixels, vec4<u32>(params.width * params.height - 1u));
    return vec4<u32>(start_of(rows.x), start_of(rows.y), start_of(rows.z), start_of(rows.w));
}

// edges: one thread per pixel of the band, then one per (slot, tile) pair, then one per pixel again, once all is in the visibility buffer.
// Reads what raster reads, the nodes, the visibility buffer and which cells samples lie in; writes a record in `samples` for each edge
// pixel, with the hit at its centre, and its number into `edge_of`. A pixel is an edge pixel unless all its samples are proven to
// see one triangle first, or nothing. The first dispatch finds in each pixel how far from the eye the triangle seen at its centre may lie
// at any sample, if it covers all; the second tests every triangle that may cover a sample before that; the third writes the records.
// `edge_of` has a word per pixel: the depth before which another triangle would be seen instead, KEPT once an edge is
// found; in the end 1 more than the number of its record, 0 of none. The list may overflow: the counter keeps counting.

#choose arithmetic f32
#import depth/nearness.wgsl
#import keys/key.wgsl
#import masks/holes
#import nodes/cells.wgsl
#import nodes/conics.wgsl
#import nodes/slabs.wgsl
#import nodes/tables.wgsl
#import pairs/pair.wgsl
#import samples/cells.wgsl
#import samples/depth_bounds.wgsl
#import shared/bits.wgsl
#import shared/items.wgsl
#import shared/params.wgsl
#import vertices/triangle.wgsl
#import vertices/vertex

var<storage, read> nodes: array<Node>;
var<storage, read> pairs: array<vec2<u32>>;
var<storage, read> slot_of_id: array<u32>;
var<storage, read> visibility: array<u32>;
var<storage, read_write> edge_of: array<atomic<u32>>;
var<storage, read_write> samples: array<u32>;

const STEP_SEEN: u32 = 0u;
const STEP_PAIRS: u32 = 1u;

const KEPT: u32 = 0u;

@compute @workgroup_size(64)
fn edges(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let index = item_index(group, groups, lane);
    if step.value == STEP_PAIRS {
        if index < min(atomicLoad(&counters[COUNT_PAIRS]), params.pair_capacity) {
            test_pair(pairs[index]);
        }
        return;
    }
    if index >= params.width * params.height {
        return;
    }
    if step.value == STEP_SEEN {
        test_pixel(index);
    } else {
        list(index);
    }
}

// The centre of a pixel of a tile in the units of its node.
fn place_of(bit: u32) -> vec2<f32> {
    return (vec2<f32>(f32(bit % TILE), f32(bit / TILE)) + 0.5) * NODE_PX - 1.0;
}

// The farthest depth at which the pixel's triangle may lie. The pixel's triangle may lie in another chunk of the scene, which then tests it
// itself.
fn test_pixel(pixel: u32) {
    let won = vec2<u32>(visibility[2u * pixel], visibility[2u * pixel + 1u]);
    if all(won == vec2<u32>(0u)) {
        if params.id_first == 0u {
            atomicStore(&edge_of[pixel], NONE);
        }
        return;
    }
    let id = key_id(~won);
    if id - params.id_first >= params.id_count {
        return;
    }

    // the cell that all its samples lie in
    let layer = key_layer(~won);
    let x = pixel % params.width;
    let y = pixel / params.width;
    let cell = pixel_cell(layer, x, y);
    let bit = (y % TILE) * TILE + x % TILE;
    var reach = KEPT;
    if cell != NONE && any((pixels_whole(cell) & bit_mask(bit)) != vec2<u32>(0u)) {
        let slot = slot_of_id[id - params.id_first];
        let triangle = triangle_at(slot);
        let v0 = vertex(triangle.x);
        let v1 = vertex(triangle.y);
        let v2 = vertex(triangle.z);
        let node = nodes[cells[cell].node];
        let place = place_of(bit);
        let seen = depths(plane(node, v0, v1, v2), place.x, place.y, SAMPLE_REACH * NODE_PX);
        let is_in_range = seen.near > params.t_min.x && seen.far < params.t_max.x;
        // samples may look through holes of it
        if seen.facing != 0 && is_in_range && is_solid(slot) && covers(conics(node, v0, v1, v2), place.x, place.y, SAMPLE_REACH * NODE_PX) {
            reach = nearness(layer, seen.far) + 1u;
        }
    }
    atomicStore(&edge_of[pixel], reach);
}

// Whether the triangle covers the whole box.
fn covers(q: Conics, x: f32, y: f32, s: f32) -> bool {
    let s01 = conic_sign(q.e01, x, y, s);
    let s20 = -conic_sign(q.e02, x, y, s);
    let s12 = conic_sign(q.e12, x, y, s);
    return s01 != 0 && s01 == s20 && s01 == s12;
}

// Finds the pixels that a pair's triangle may partly cover in front of the visible hit.
fn test_pair(pair: vec2<u32>) {
    let tile = pair_tile(pair);
    let triangle = triangle_at(pair_slot(pair));
    let v0 = vertex(triangle.x);
    let v1 = vertex(triangle.y);
    let v2 = vertex(triangle.z);
    let within = box_mask(pair_from(pair), pair_to(pair));
    let corner = tile_corner(tile);
    let layer = tile_layer(tile);
    for (var k = tile_start[tile]; k < tile_start[tile + 1u]; k++) {
        var left = pixels_in_part(k) & within;
        if all(left == vec2<u32>(0u)) {
            continue;
        }
        let node = nodes[cells[k].node];
        let sides = conics(node, v0, v1, v2);
        let own = plane(node, v0, v1, v2);
        loop {
            let bit = first_bit(left);
            if bit == NONE {
                break;
            }
            left = without_bit(left, bit);
            let place = place_of(bit);
            if !may_cover(sides, place.x, place.y, SAMPLE_REACH * NODE_PX) {
                continue;
            }
            let pixel = (corner.y + bit / TILE) * params.width + corner.x + bit % TILE;
            let reach = atomicLoad(&edge_of[pixel]);
            let met = depths(own, place.x, place.y, SAMPLE_REACH * NODE_PX);
            let near = clamp(met.near, params.t_min.x, params.t_max.x);
            let is_out_of_range = met.far < params.t_min.x || met.near > params.t_max.x;
            if reach == KEPT || (!SLABBED && is_out_of_range) || nearness(layer, near) - 1u > reach {
                continue;
            }
            let won = vec2<u32>(visibility[2u * pixel], visibility[2u * pixel + 1u]);
            let is_seen = key_id(~won) == triangle_id(triangle) && key_layer(~won) == layer;
            if all(won == vec2<u32>(0u)) || !is_seen {
                atomicStore(&edge_of[pixel], KEPT);
            }
        }
    }
}

fn list(pixel: u32) {
    if atomicLoad(&edge_of[pixel]) != KEPT {
        atomicStore(&edge_of[pixel], 0u);
        return;
    }
    let record = atomicAdd(&counters[COUNT_EDGES], 1u);
    if record < params.edge_capacity {
        let won = vec2<u32>(visibility[2u * pixel], visibility[2u * pixel + 1u]);
        samples[record * 2u * (SAMPLES + 1u)] = pixel;
        samples[record * 2u * (SAMPLES + 1u) + 1u] = select(key_id(~won), NONE, all(won == vec2<u32>(0u)));
        atomicStore(&edge_of[pixel], record + 1u);
    }
}

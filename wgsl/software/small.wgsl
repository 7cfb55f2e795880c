// small: one thread per triangle of a (triangle group, node) item of `tasks`.
// Reads triangles, vertices, nodes and pieces; draws the triangles that cover few pixels of a node whose pixels are all of one piece:
// merges their visibility keys, and leaves what f32 does not prove to recheck. All others go to `large`. Both lists may overflow: counters
// keep counting.

#import lanes
#import lanes/loads/node
#import lanes/loads/piece
#import nodes/address.wgsl
#import nodes/extent.wgsl
#import nodes/index.wgsl
#import nodes/within.wgsl
#import shared/items.wgsl
#import shared/params.wgsl
#import shared/places.wgsl
#import software/drawn.wgsl
#import vertices/vertex

var<storage, read> tasks: array<u32>;
var<storage, read> triangle_groups: array<u32>;
var<storage, read_write> large: array<vec2<u32>>;

// Pixels of a box that one thread draws.
const SMALL: u32 = 512u;

@compute @workgroup_size(64)
fn small(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
    @builtin(subgroup_invocation_id) place: u32,
) {
    // take a triangle of a task; the lanes load it together
    let lane = take_lane(place);
    let index = item_index(group, groups, thread) / TRIANGLE_GROUP;
    var word = 0u;
    if lane == 0u {
        word = atomicLoad(&counters[COUNT_TASKS]);
    }
    if index >= min(subgroupShuffle(word, subgroup_lane(0u)), params.task_capacity) {
        return;
    }
    if lane < 2u {
        word = tasks[2u * index + lane];
    }
    let address = subgroupShuffle(word, subgroup_lane(1u));
    let triangle_group = subgroupShuffle(word, subgroup_lane(0u));
    if lane == 3u || lane == 7u {
        word = triangle_groups[8u * triangle_group + lane];
    }
    let first_slot = subgroupShuffle(word, subgroup_lane(3u));
    let count = subgroupShuffle(word, subgroup_lane(7u));
    let level = node_level(address);
    let node = item_node(address_node(address), lane);
    let piece = lanes_piece(select(node.piece, 0u, node.piece == NONE), lane);
    let slot = first_slot + lane;
    var triangle = vec4<u32>(0u);
    var hi = array<vec3<f32>, 3>(vec3<f32>(0.0), vec3<f32>(0.0), vec3<f32>(0.0));
    if lane < count {
        triangle = triangle_at(slot);
        hi = array<vec3<f32>, 3>(vertex(triangle.x), vertex(triangle.y), vertex(triangle.z));
    }

    // bound the pixels it may cover
    let seen = close_extent(node, hi[0], hi[1], hi[2]);
    let within = pixels_within(seen, TILE << (2u * level), 0.0);
    let corner = TILE * (vec2<u32>(node_x(address), node_y(address)) << vec2<u32>(2u * level));
    let size = vec2<u32>(params.width, params.height);
    let pixels = vec4<u32>(min(corner + within.xy, size), min(corner + within.zw, size));
    let box_size = pixels.zw - min(pixels.xy, pixels.zw);
    let is_bounded = lane < count && node.piece != NONE && level != LEVEL_CELL && seen.tight;
    if is_bounded && box_size.x * box_size.y == 0u {
        return;
    }

    // draw it, or list it
    let is_small = is_bounded && box_size.x * box_size.y <= SMALL;
    draw_small(slot, triangle, hi, piece, select(vec4<u32>(0u, 0u, 1u, 1u), pixels, is_small), is_small);
    if lane < count && !is_small {
        let at = take_places(COUNT_LARGE, 1u);
        if at < params.pair_capacity {
            large[at] = vec2<u32>(slot, address);
        }
    }
}

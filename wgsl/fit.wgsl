// fit: one thread per node of the step's level.
// Reads the rays of the pixels of a tile that is listed, or the nodes of the level below; writes the node's affine fit and how
// far its rays may lie from it, and of tiles which pixels have a ray. The host does the same for a camera's own rays.

#choose arithmetic f32
#import nodes/index.wgsl
#import optics/layout.wgsl
#import rays/field/table.wgsl
#import shared/bits.wgsl
#import shared/items.wgsl
#import shared/params.wgsl

var<storage, read> live: array<u32>;
var<storage, read_write> cells: array<Cell>;
var<storage, read_write> nodes: array<Node>;

// A ray, and its position in [-1, 1]^2 over the node.
struct TileRay {
    place: vec2<f32>,
    p: vec3<f32>,
    d: vec3<f32>,
    exists: bool,
}

// Rays of a node: pixels of a tile; corners of the fits of its children.
const SAMPLES: u32 = 64u;

// Rounding of what is summed up here and by the kernels that read the node, relative to the sizes: 2^-20. In units of
// 2^-24: a stored ray 1, or a child's fit at its corner 4, where it is up to twice as large as the node's; the node's fit
// at a place 3; a kernel's own use of the node 4. Of the radius: a difference 1, its length 4, and a sum 1.
const FIT_TOLERANCE: f32 = 1.0 / 1048576.0;

// Places are on a line where their spread's determinant is this share of its square.
const LINE_SHARE: f32 = 1e-4;

// Rays are loose if they lie farther from their fit than this share of its slopes, and of their own size; and it pays to go down
// where what lies below is narrower than this share. As plan/fit.rs and plan/nodes.rs have it.
const LOOSE: f32 = 0.25;
const LOOSE_SIZE: f32 = 1.0 / 4096.0;
const DISCONTINUOUS_WIDTH: f32 = 0.5;

// Finite: a ray bounced by a surface without a normal hits nothing, and must not widen the bounds of its neighbours.
fn is_finite(v: vec3<f32>) -> bool {
    return all((bitcast<vec3<u32>>(v) & vec3<u32>(0x7f800000u)) != vec3<u32>(0x7f800000u));
}

fn tile_ray(level: u32, x: u32, y: u32, k: u32) -> TileRay {
    var s: TileRay;
    if level == 0u {
        let in_tile = vec2<u32>(k % TILE, k / TILE);
        let px = TILE * vec2<u32>(x, y) + in_tile;
        if px.x < params.width && px.y < params.height {
            let at = field_at(px.x, px.y);
            s.place = (vec2<f32>(in_tile) - 3.5) / 4.0;
            s.p = field_origin(at);
            s.d = field_direction(at);
            s.exists = any(s.d != vec3<f32>(0.0)) && is_finite(s.p) && is_finite(s.d);
        }
        return s;
    }
    let child = vec2<u32>((k / 4u) % BRANCH, k / 4u / BRANCH);
    let at = BRANCH * vec2<u32>(x, y) + child;
    if at.x < level_width(level - 1u) && at.y < level_height(level - 1u) {
        let node = nodes[node_index(level - 1u, at.x, at.y)];
        let corner = vec2<f32>(f32(k % 2u), f32(k / 2u % 2u)) * 2.0 - 1.0;
        s.place = (2.0 * vec2<f32>(child) + 1.0) / f32(BRANCH) - 1.0 + corner / f32(BRANCH);
        s.p = node.p + corner.x * node.px + corner.y * node.py;
        s.d = node.d + corner.x * node.dx + corner.y * node.dy;
        s.exists = node.rays != RAYS_NONE;
    }
    return s;
}

// Whether the tile is listed, or some child has rays.
fn has_rays(level: u32, x: u32, y: u32, index: u32) -> bool {
    if level == 0u {
        return live[2u + 2u * index] != 0u;
    }
    let columns = min(BRANCH, level_width(level - 1u) - BRANCH * x);
    let rows = min(BRANCH, level_height(level - 1u) - BRANCH * y);
    var is_some = false;
    for (var k = 0u; k < columns * rows; k++) {
        is_some |= nodes[node_index(level - 1u, BRANCH * x + k % columns, BRANCH * y + k / columns)].rays != RAYS_NONE;
    }
    return is_some;
}

// Half-size of a bundle as far along its central ray as the scene is large.
fn width_of(node: Node) -> f32 {
    let t = min(optic.scene_size / length(node.d), params.t_max.x);
    return length(node.px) + length(node.py) + node.r_p + t * (length(node.dx) + length(node.dy) + node.r_d);
}

fn is_loose(r: f32, a: vec3<f32>, x: vec3<f32>, y: vec3<f32>) -> bool {
    let slopes = length(x) + length(y);
    return r > LOOSE * slopes && r > LOOSE_SIZE * (length(a) + slopes);
}

@compute @workgroup_size(64)
fn fit(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    // take a node
    let level = step.value;
    let index = item_index(group, groups, lane);
    let width = level_width(level);
    if index >= width * level_height(level) {
        return;
    }
    let x = index % width;
    let y = index / width;

    // find the centre of its rays, and how far those below may lie from what was handed up
    var count = 0.0;
    var place = vec2<f32>(0.0);
    var p = vec3<f32>(0.0);
    var d = vec3<f32>(0.0);
    var mask = vec2<u32>(0u);
    var below = vec3<f32>(0.0);
    let samples = select(0u, SAMPLES, has_rays(level, x, y, index));
    for (var k = 0u; k < samples; k++) {
        let s = tile_ray(level, x, y, k);
        if s.exists {
            count += 1.0;
            place += s.place;
            p += s.p;
            d += s.d;
            mask = with_bit(mask, k);
            if level > 0u && k % 4u == 0u {
                let child = BRANCH * vec2<u32>(x, y) + vec2<u32>((k / 4u) % BRANCH, k / 4u / BRANCH);
                let node = nodes[node_index(level - 1u, child.x, child.y)];
                below = vec3<f32>(max(below.x, node.r_p), max(below.y, node.r_d), below.z + node.width);
            }
        }
    }
    var node: Node;
    if level == 0u {
        cells[index].mask_lo = mask.x;
        cells[index].mask_hi = mask.y;
    }
    if count > 0.0 {
        place /= count;
        p /= count;
        d /= count;

        // fit slopes
        var spread = vec3<f32>(0.0);
        var p_x = vec3<f32>(0.0);
        var p_y = vec3<f32>(0.0);
        var d_x = vec3<f32>(0.0);
        var d_y = vec3<f32>(0.0);
        for (var k = 0u; k < samples; k++) {
            let s = tile_ray(level, x, y, k);
            if s.exists {
                let q = s.place - place;
                spread += vec3<f32>(q.x * q.x, q.x * q.y, q.y * q.y);
                p_x += q.x * (s.p - p);
                p_y += q.y * (s.p - p);
                d_x += q.x * (s.d - d);
                d_y += q.y * (s.d - d);
            }
        }
        let det = spread.x * spread.z - spread.y * spread.y;
        let size = spread.x + spread.z;
        if det > LINE_SHARE * size * size {
            let inverse = vec3<f32>(spread.z, -spread.y, spread.x) / det;
            node.px = inverse.x * p_x + inverse.y * p_y;
            node.py = inverse.y * p_x + inverse.z * p_y;
            node.dx = inverse.x * d_x + inverse.y * d_y;
            node.dy = inverse.y * d_x + inverse.z * d_y;
        }
        node.p = p - place.x * node.px - place.y * node.py;
        node.d = d - place.x * node.dx - place.y * node.dy;

        // measure how far the rays are from it
        for (var k = 0u; k < samples; k++) {
            let s = tile_ray(level, x, y, k);
            if s.exists {
                node.r_p = max(node.r_p, length(node.p + s.place.x * node.px + s.place.y * node.py - s.p));
                node.r_d = max(node.r_d, length(node.d + s.place.x * node.dx + s.place.y * node.dy - s.d));
            }
        }
        let size_p = length(node.p) + length(node.px) + length(node.py);
        let size_d = length(node.d) + length(node.dx) + length(node.dy);
        node.r_p += below.x + FIT_TOLERANCE * (size_p + node.r_p + below.x);
        node.r_d += below.y + FIT_TOLERANCE * (size_d + node.r_d + below.y);
        node.rays = RAYS_LOOSE;

        // discontinuous where what lies below is bounded much better
        node.width = width_of(node);
        let loose = is_loose(node.r_p, node.p, node.px, node.py) || is_loose(node.r_d, node.d, node.dx, node.dy);
        let width_below = 4.0 * below.z / count;
        if level > 0u && loose && width_below < DISCONTINUOUS_WIDTH * node.width {
            node.rays = RAYS_DISCONTINUOUS;
            node.width = width_below;
        }
    }
    nodes[node_index(level, x, y)] = node;
}

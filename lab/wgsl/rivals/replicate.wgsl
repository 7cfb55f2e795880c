// replicate: one thread per triangle of the chunk.
// Reads triangles and pieces; writes a (slot, piece) item for each piece that the triangle may be seen in, and the arguments
// of the draw of all. The list may overflow: the counter keeps counting.

#import rays/pieces/table.wgsl
#import rivals/layout.wgsl
#import rivals/outline.wgsl
#import rivals/perspective_image.wgsl
#import shared/items.wgsl
#import vertices/vertex

var<storage, read> cones: array<Cone>;
var<storage, read_write> draw_args: array<atomic<u32>>;
var<storage, read_write> replicas: array<vec2<u32>>;

// Arguments of an indirect draw: vertices, instances, first vertex, first instance.
const VERTICES: u32 = 0u;

// All three corners, as (s x, s y, s), lie outside the line from a to b, c being inside.
fn all_outside(a: vec2<f32>, b: vec2<f32>, c: vec2<f32>, seen: array<vec3<f32>, 3>) -> bool {
    let e = b - a;
    let line = vec3<f32>(-e.y, e.x, e.y * a.x - e.x * a.y) * select(-1.0, 1.0, winding(e, c - a) > 0.0);
    return dot(line, seen[0]) < 0.0 && dot(line, seen[1]) < 0.0 && dot(line, seen[2]) < 0.0;
}

// Roundings of an angle: of its cosine next to 1, whose arc is the root of twice that, and of the eye.
const ANGLE_TOLERANCE: f32 = 2e-3;
// A cap up to here holds the triangle of corners that it holds; radians.
const WIDEST: f32 = 1.5;

// The cone and one around the triangle meet.
fn may_see(some: Cone, v0: vec3<f32>, v1: vec3<f32>, v2: vec3<f32>) -> bool {
    let a = normalize(v0 - some.eye);
    let b = normalize(v1 - some.eye);
    let c = normalize(v2 - some.eye);
    let axis = normalize(a + b + c);
    let angle = arc(min(dot(axis, a), min(dot(axis, b), dot(axis, c))));
    // what is not a number, of a corner in the eye, is seen
    return !(angle < WIDEST && arc(dot(some.axis, axis)) > some.angle + angle + ANGLE_TOLERANCE);
}

fn arc(cosine: f32) -> f32 {
    return acos(clamp(cosine, -1.0, 1.0));
}

@compute @workgroup_size(64)
fn replicate(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let slot = item_index(group, groups, lane);
    let triangle = triangle_at(slot);
    if all(triangle == vec4<u32>(0u)) {
        // behind the last triangle
        return;
    }
    let v0 = vertex(triangle.x);
    let v1 = vertex(triangle.y);
    let v2 = vertex(triangle.z);
    for (var k = 0u; k < arrayLength(&cones); k++) {
        let some = cones[k];
        if CULLING && !may_see(some, v0, v1, v2) {
            continue;
        }
        for (var piece = some.first; piece < some.first + some.count; piece++) {
            let q = piece_at(piece);
            let o = outlines[q.number];
            let seen = array<vec3<f32>, 3>(perspective_image(q, v0), perspective_image(q, v1), perspective_image(q, v2));
            let around = outline_corners(o);
            let a = around[0] - piece_origin(q);
            let b = around[1] - piece_origin(q);
            let c = around[2] - piece_origin(q);
            let behind = seen[0].z <= 0.0 && seen[1].z <= 0.0 && seen[2].z <= 0.0;
            let outside = behind || all_outside(a, b, c, seen) || all_outside(b, c, a, seen) || all_outside(c, a, b, seen);
            if !CULLING || !outside {
                let at = atomicAdd(&draw_args[VERTICES], 3u) / 3u;
                if at < arrayLength(&replicas) {
                    replicas[at] = vec2<u32>(slot, piece);
                }
            }
        }
    }
}

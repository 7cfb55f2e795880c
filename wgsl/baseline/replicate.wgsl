// replicate: one thread per triangle of the chunk.
// Reads triangles and pieces; writes a (slot, piece) item for each piece that the triangle may be seen in, and the arguments
// of the draw of all. The list may overflow: the counter keeps counting.

// Rows of the arguments of an indirect draw: vertices, instances, first vertex, first instance.
const VERTICES: u32 = 0u;

// All three corners, as (s x, s y, s), lie outside the line from a to b, c being inside.
fn all_outside(a: vec2<f32>, b: vec2<f32>, c: vec2<f32>, seen: array<vec3<f32>, 3>) -> bool {
    let e = b - a;
    let line = vec3<f32>(-e.y, e.x, e.y * a.x - e.x * a.y) * select(-1.0, 1.0, winding(e, c - a) > 0.0);
    return dot(line, seen[0]) < 0.0 && dot(line, seen[1]) < 0.0 && dot(line, seen[2]) < 0.0;
}

@compute @workgroup_size(64)
fn replicate(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let slot = item_index(group, groups, lane);
    if slot >= arrayLength(&triangles) {
        return;
    }
    let row = triangles[slot];
    if all(row == vec4<u32>(0u)) {
        // room behind the last row
        return;
    }
    let v0 = vertex(row.x);
    let v1 = vertex(row.y);
    let v2 = vertex(row.z);
    for (var piece = 0u; piece < arrayLength(&pieces); piece++) {
        let q = pieces[piece];
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

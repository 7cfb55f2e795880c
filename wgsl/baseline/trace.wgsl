// trace: one thread per pixel of the band.
// Reads the pixel's rays, segment by segment, and triangles in a bounding volume hierarchy, or one after the other; writes the
// visibility key of the nearest triangle of the first segment that meets one.

override LAYERS: u32 = 1u;
override SEGMENTS: u32 = 1u;      // of a layer

// A part of a pixel's way: p + s d for s in [first, last].
struct Segment {
    p: vec3<f32>,
    d: vec3<f32>,
    first: f32,
    last: f32,
}

struct Found {
    s: f32,
    id: u32,
}

fn nothing() -> Found {
    // infinity
    return Found(bitcast<f32>(0x7f800000u), NONE);
}

// What is nearer of what was found and a triangle; of equals the smaller id.
fn nearer(segment: Segment, found: Found, triangle: LeafTriangle) -> Found {
    let m0 = triangle.v0 - segment.p;
    let m1 = triangle.v1 - segment.p;
    let m2 = triangle.v2 - segment.p;
    let normal = cross(triangle.v1 - triangle.v0, triangle.v2 - triangle.v0);
    let a = dot(segment.d, cross(m1, m0));
    let b = dot(segment.d, cross(m2, m1));
    let c = dot(segment.d, cross(m0, m2));
    let across = dot(normal, segment.d);
    let s = dot(normal, m0) / across;
    let inside = (a >= 0.0 && b >= 0.0 && c >= 0.0) || (a <= 0.0 && b <= 0.0 && c <= 0.0);
    let shown = across != 0.0 && (triangle.one_sided == 0u || across < 0.0);
    let in_range = s >= segment.first && s <= segment.last;
    if inside && shown && in_range && (s < found.s || (s == found.s && triangle.id < found.id)) {
        return Found(s, triangle.id);
    }
    return found;
}

@compute @workgroup_size(64)
fn trace(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    // take a pixel, those of a tile together
    let item = item_index(group, groups, lane);
    let tile = item / (TILE * TILE);
    let x = (tile % params.tiles_x) * TILE + item % TILE;
    let y = (tile / params.tiles_x) * TILE + (item / TILE) % TILE;
    if x >= params.width || y >= params.height {
        return;
    }

    // follow its way to the first triangle
    for (var layer = 0u; layer < LAYERS; layer++) {
        if has_ray(layer, x, y) {
            for (var k = 0u; k < SEGMENTS; k++) {
                let found = traced(way_segment(layer, x, y, k));
                if found.id != NONE {
                    visibility[y * params.width + x] = ~visibility_key(layer, real(way_t(found.s, k)), found.id);
                    return;
                }
            }
        }
    }
}

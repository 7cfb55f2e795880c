// Triangles of the hierarchies that trace follows, of which there is one for the way from each time step to the next: row k of `bvh` has the
// root of the k-th. `bvh_triangles`: six rows a triangle: at the first end of the way a corner and the slot; the edge from that corner to the
// next, and the last word of the packed triangle; the edge from the last corner to the first; and the same three vectors at the other end.

#import hierarchy/nodes.wgsl
#import shared/params.wgsl
#import shared/table.wgsl
#import vertices/timed/vertex.wgsl
#import vertices/vertex

var bvh_triangles: texture_2d<u32>;

// A corner of a triangle, and the edges from it and to it.
struct BvhTriangle {
    v: vec3<f32>,
    slot: u32,
    to_next: vec3<f32>,
    word: u32,              // the last of the packed triangle
    from_last: vec3<f32>,
    size: f32,              // of all edges: no error of one is larger than its units times this
}

// The moment of the last step lies at the end of the last way.
fn bvh_root() -> u32 {
    return bvh_row(min(moment_step, params.steps - 2u)).y;
}

fn step_between(a: vec4<u32>, b: vec4<u32>) -> vec3<f32> {
    let share = select(moment_share, 1.0, moment_step + 1u == params.steps);
    let from_step = bitcast<vec3<f32>>(a.xyz);
    return from_step + share * (bitcast<vec3<f32>>(b.xyz) - from_step);
}

fn edges_of(to_next: vec4<u32>, from_last: vec4<u32>) -> f32 {
    let edges = abs(bitcast<vec3<f32>>(to_next.xyz)) + abs(bitcast<vec3<f32>>(from_last.xyz));
    return max(edges.x, max(edges.y, edges.z));
}

fn bvh_triangle(index: u32) -> BvhTriangle {
    let row = 6u * index;
    let a = textureLoad(bvh_triangles, table_texel(row), 0);
    let b = textureLoad(bvh_triangles, table_texel(row + 1u), 0);
    let c = textureLoad(bvh_triangles, table_texel(row + 2u), 0);
    let b_end = textureLoad(bvh_triangles, table_texel(row + 4u), 0);
    let c_end = textureLoad(bvh_triangles, table_texel(row + 5u), 0);
    let v = step_between(a, textureLoad(bvh_triangles, table_texel(row + 3u), 0));
    let size = CORNER_UNITS * max(edges_of(b, c), edges_of(b_end, c_end));
    return BvhTriangle(v, a.w, step_between(b, b_end), b.w, step_between(c, c_end), size);
}

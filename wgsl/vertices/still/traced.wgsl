// Triangles of the hierarchy that trace follows. `bvh_triangles`: three rows a triangle: a corner and the slot; the edge from that corner to
// the next, and the last word of the packed triangle; the edge from the last corner to the first.

#import shared/table.wgsl
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

fn bvh_root() -> u32 {
    return 0u;
}

fn bvh_triangle(index: u32) -> BvhTriangle {
    let a = textureLoad(bvh_triangles, table_texel(3u * index), 0);
    let b = textureLoad(bvh_triangles, table_texel(3u * index + 1u), 0);
    let c = textureLoad(bvh_triangles, table_texel(3u * index + 2u), 0);
    let to_next = bitcast<vec3<f32>>(b.xyz);
    let from_last = bitcast<vec3<f32>>(c.xyz);
    let edges = abs(to_next) + abs(from_last);
    let size = max(edges.x, max(edges.y, edges.z));
    return BvhTriangle(bitcast<vec3<f32>>(a.xyz), a.w + slots_before(), to_next, b.w + ids_before(), from_last, size);
}

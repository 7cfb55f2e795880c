// perspective: pieces whose rays start in one point, each by its own perspective matrix; the rasterizer is exact then (Lorenz
// and Doellner 2009, section 2). A triangle is drawn once for each piece that it may be seen in, as `replicate` lists them, and what
// lies outside the piece is clipped off.

#import rays/pieces/table.wgsl
#import rivals/drawing.wgsl
#import rivals/drawn
#import rivals/layout.wgsl
#import rivals/outline.wgsl
#import rivals/perspective_image.wgsl
#import rivals/seen_through.wgsl
#import shared/params.wgsl
#import vertices/vertex

var<storage, read> replicas: array<vec2<u32>>;

@vertex
fn perspective_corner(@builtin(vertex_index) index: u32) -> Clipped {
    let replica = replicas[index / 3u];
    let q = piece_at(replica.y);
    let triangle = triangle_at(replica.x);
    let v0 = vertex(triangle.x);
    let v1 = vertex(triangle.y);
    let v2 = vertex(triangle.z);
    let seen = perspective_image(q, select(select(v2, v1, index % 3u == 1u), v0, index % 3u == 0u));
    // places are pixels from the piece's origin, times s
    let size = vec2<f32>(f32(params.width), f32(params.height));
    let at = seen.xy + piece_origin(q) * seen.z;
    let place = (at + 0.5 * seen.z) / size * vec2<f32>(2.0, -2.0) + vec2<f32>(-1.0, 1.0) * seen.z;
    let distances = outline_distances(outlines[q.number], vec3<f32>(at, seen.z));
    let t = q.h_hi * seen.z + q.hx_hi * seen.x + q.hy_hi * seen.y;
    let normal = file_normal(triangle, v0, v1, v2);
    return Clipped(vec4<f32>(place, clip_depth(seen.z), seen.z), distances, t, normal, triangle.w, replica.y);
}

@fragment
fn perspective_pixel(corner: Corner) -> Drawn {
    return seen_through(corner);
}

// cube: triangles onto the six faces of a cube around the eye, three beside each other in two rows.

#import rivals/drawing.wgsl
#import rivals/drawn
#import rivals/face
#import rivals/layout.wgsl
#import shared/params.wgsl
#import vertices/triangle.wgsl
#import vertices/vertex

// Of the scene's size: what is nearer to the plane through the eye that is parallel to a face is not drawn there. Clipped at that plane
// itself, triangles would have corners infinitely far away, and some adapters do not draw these.
const NEAR: f32 = 1.52587890625e-5;

struct Corner {
    @builtin(position) position: vec4<f32>,
    @location(0) @interpolate(perspective) m: vec3<f32>,
    @location(1) @interpolate(flat, either) normal: vec3<f32>,
    @location(2) @interpolate(flat, either) packed_id: u32,
    @location(3) @interpolate(flat, either) face: u32,
}

@vertex
fn cube_corner(@builtin(vertex_index) index: u32, @builtin(instance_index) face: u32) -> Corner {
    let triangle = triangle_at(index / 3u);
    let v0 = vertex(triangle.x);
    let v1 = vertex(triangle.y);
    let v2 = vertex(triangle.z);
    let m = select(select(v2, v1, index % 3u == 1u), v0, index % 3u == 0u) - cube.eye;
    let on = on_face(face, m);
    let before = on.z - NEAR * params.scene_size;
    return Corner(vec4<f32>(on.x, -on.y, 0.5 * before, on.z), m, file_normal(triangle, v0, v1, v2), triangle.w, face);
}

@fragment
fn cube_pixel(corner: Corner) -> Drawn {
    if is_back_face(corner.packed_id, corner.normal, corner.m) {
        discard;
    }
    return drawn(0u, corner.packed_id & ID_MASK, on_face(corner.face, corner.m).z);
}

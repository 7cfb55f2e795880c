// bound: a triangle around the image of each, and the ray of each pixel of it against the triangle's plane (Hou et al. 2006,
// sections 2.1 and 2.2). An instance is a piece, the camera triangle.

enable clip_distances;

#import rays/pieces/table.wgsl
#import rivals/drawing.wgsl
#import rivals/drawn
#import rivals/layout.wgsl
#import rivals/outline.wgsl
#import rivals/range.wgsl
#import shared/params.wgsl
#import vertices/triangle.wgsl
#import vertices/vertex

struct Corner {
    @builtin(position) position: vec4<f32>,
    @location(0) @interpolate(flat, either) slot: u32,
    @location(1) @interpolate(flat, either) piece: u32,
}

// What lies outside the camera triangle is clipped off.
struct Clipped {
    @builtin(position) position: vec4<f32>,
    @builtin(clip_distances) distances: array<f32, 3>,
    @location(0) @interpolate(flat, either) slot: u32,
    @location(1) @interpolate(flat, either) piece: u32,
}

// The camera plane in pixels from the piece's origin, X = p + x px + y py: where the rays are at the t of the scene's centre. The
// paper's is the mirror's facet; the nearer it is to the triangles, the tighter are their bounds.
struct Plane {
    p: vec3<f32>,
    px: vec3<f32>,
    py: vec3<f32>,
    normal: vec3<f32>,
}

override CENTRE_X: f32 = 0.0;
override CENTRE_Y: f32 = 0.0;
override CENTRE_Z: f32 = 0.0;

fn camera_plane(q: Piece) -> Plane {
    let ray = outline_ray(q, vec2<f32>(0.0));
    let t = dot(vec3<f32>(CENTRE_X, CENTRE_Y, CENTRE_Z) - ray.p, ray.d) / dot(ray.d, ray.d);
    let px = q.px_hi + t * q.dx_hi;
    let py = q.py_hi + t * q.dy_hi;
    return Plane(q.p_hi + t * q.d_hi, px, py, cross(px, py));
}

// Where the point, moved along d, is in the plane.
fn projected(plane: Plane, point: vec3<f32>, d: vec3<f32>) -> vec2<f32> {
    let m = point - plane.p;
    let moved = m - d * (dot(plane.normal, m) / dot(plane.normal, d));
    return in_plane(plane, moved);
}

// A vector in the plane, in pixels.
fn in_plane(plane: Plane, v: vec3<f32>) -> vec2<f32> {
    let size = dot(plane.normal, plane.normal);
    return vec2<f32>(dot(cross(v, plane.py), plane.normal), dot(cross(plane.px, v), plane.normal)) / size;
}

// The direction of L_k as an outward normal of the edge across from corner k, in pixels: it is at a right angle to d_k in the
// plane, on the side that points projected along d_k lie farthest to.
fn edge_normal(plane: Plane, d: vec3<f32>) -> vec2<f32> {
    let along = in_plane(plane, cross(plane.normal, d));
    let out = vec2<f32>(along.y, -along.x);
    let shift = in_plane(plane, d - plane.normal * (dot(d, plane.normal) / dot(plane.normal, plane.normal)));
    return out * select(1.0, -1.0, dot(out, shift) > 0.0);
}

// Where two lines n . x = c meet.
fn crossing(n: vec2<f32>, c: f32, m: vec2<f32>, e: f32) -> vec2<f32> {
    return vec2<f32>(c * m.y - e * n.y, e * n.x - c * m.x) / winding(n, m);
}

@vertex
fn bound_corner(@builtin(vertex_index) index: u32, @builtin(instance_index) piece: u32) -> Clipped {
    let q = piece_at(piece);
    let triangle = triangle_at(index / 3u);
    let v = array<vec3<f32>, 3>(vertex(triangle.x), vertex(triangle.y), vertex(triangle.z));
    let plane = camera_plane(q);
    let around = outline_corners(outlines[q.number]);
    var corner: array<vec2<f32>, 3>;
    var d: array<vec3<f32>, 3>;
    for (var k = 0u; k < 3u; k++) {
        corner[k] = around[k] - piece_origin(q);
        d[k] = outline_ray(q, corner[k]).d;
    }

    // edges: at right angles to the rays; where these do not diverge, those of the camera triangle
    var n: array<vec2<f32>, 3>;
    for (var k = 0u; k < 3u; k++) {
        n[k] = edge_normal(plane, d[k]);
    }
    let a = winding(normalize(n[0]), normalize(n[1]));
    let b = winding(normalize(n[1]), normalize(n[2]));
    let c = winding(normalize(n[2]), normalize(n[0]));
    let diverge = (a > DIVERGENT && b > DIVERGENT && c > DIVERGENT) || (a < -DIVERGENT && b < -DIVERGENT && c < -DIVERGENT);
    if !diverge {
        for (var k = 0u; k < 3u; k++) {
            let e = corner[(k + 2u) % 3u] - corner[(k + 1u) % 3u];
            let out = vec2<f32>(e.y, -e.x);
            n[k] = out * select(1.0, -1.0, dot(out, corner[k] - corner[(k + 1u) % 3u]) > 0.0);
        }
    }
    // as far out as a projected corner lies: of those before the plane that along the edge's own ray does not lie outmost
    var reach: array<f32, 3>;
    for (var k = 0u; k < 3u; k++) {
        reach[k] = dot(n[k], projected(plane, v[0], d[0]));
        for (var i = 0u; i < 9u; i++) {
            reach[k] = max(reach[k], dot(n[k], projected(plane, v[i / 3u], d[i % 3u])));
        }
        // half a pixel more, lest fragments are lost to rounding
        reach[k] += 0.5 * length(n[k]);
    }
    let one = (index + 1u) % 3u;
    let other = (index + 2u) % 3u;
    let place = crossing(n[one], reach[one], n[other], reach[other]);
    let at = piece_origin(q) + place;
    let distances = outline_distances(outlines[q.number], vec3<f32>(at, 1.0));
    return Clipped(vec4<f32>(clip_place(at), 0.5, 1.0), distances, index / 3u, piece);
}

// Sine of the angle between two edges from which they count as diverging.
const DIVERGENT: f32 = 1e-3;

@fragment
fn bound_pixel(corner: Corner) -> Drawn {
    let q = piece_at(corner.piece);
    let o = outlines[q.number];
    let at = floor(corner.position.xy);
    let ray = outline_ray(q, at - piece_origin(q));
    let triangle = triangle_at(corner.slot);
    let v0 = vertex(triangle.x);
    let v1 = vertex(triangle.y);
    let v2 = vertex(triangle.z);
    let normal = file_normal(triangle, v0, v1, v2);
    let m0 = v0 - ray.p;
    let t = dot(normal, m0) / dot(normal, ray.d);
    let g0 = cross(ray.d, m0);
    let ab = dot(v1 - v0, g0);
    let ca = dot(v0 - v2, g0);
    let bc = dot(v2 - v1, cross(ray.d, v1 - ray.p));
    let inside = (ab >= 0.0 && bc >= 0.0 && ca >= 0.0) || (ab <= 0.0 && bc <= 0.0 && ca <= 0.0);
    if !inside || !in_range(t) || !outline_contains(o, at) || is_back_face(triangle.w, normal, ray.d) {
        discard;
    }
    return drawn(o.layer, triangle.w & ID_MASK, t);
}

// shade: one thread per pixel of the band that may have a ray.
// Reads the visibility buffer, the triangle that won and the pixel's ray; writes the planes that were asked for.
// A pixel whose triangle lies in another chunk of the scene is left to that chunk's dispatch.

#import arithmetic
#import keys/key.wgsl
#import keys/pixel
#import masks/opacity
#import nodes/slabs.wgsl
#import optics/seen
#import pixels
#import primitives/flat
#import rays/affine_bundle.wgsl
#import rays/pixel
#import rays/ray.wgsl
#import shading/materials
#import shading/numbers.wgsl
#import shading/pictures
#import shading/sky
#import shading/styles
#import shading/styles/shaded_hit.wgsl
#import shading/surface.wgsl
#import shading/textures
#import shading/written
#import shared/params.wgsl
#import shared/planes.wgsl
#import vertices/real
#import vertices/slot
#import vertices/vertex

// Some plane shows more than the key says.
override FOLLOWS_RAYS: bool = true;

// A pixel's index, and the number of pixels in a plane.
struct Place {
    pixel: u32,
    count: u32,
}

// What the planes say of a pixel.
struct Seen {
    id: u32,
    t: f32,
    z: f32,
    alpha: f32,
    piece: u32,             // of the camera's own ray, where it has not bounced
    weights: vec2<f32>,     // of the triangle's second and third corner
    n: vec3<f32>,
    p: vec3<f32>,
    view: vec3<f32>,        // unit, towards the viewer
    albedo: vec3<f32>,
    uv: vec2<f32>,
    light: vec3<f32>,
}

@compute @workgroup_size(64)
fn shade(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    // take a pixel
    let place = pixel_at(group, groups, lane);
    if place.x >= params.width || place.y >= params.height {
        return;
    }
    let x = place.x;
    let y = place.y;
    let pixel = y * params.width + x;
    let at = Place(pixel, params.width * params.height);
    take_moment(pixel);
    take_place(place);
    let won = pixel_key(pixel);
    let id = key_id(~won);
    let is_hit = any(won != vec2<u32>(0u));
    let is_first_chunk = by_thread(params.id_first, pixel) == 0u;

    // find what it shows; one store a plane for all cases: software adapters run every case
    var seen: Seen;
    if !is_hit {
        if !is_first_chunk || !has_path(x, y) {
            return;
        }
        seen = miss(at, beyond(x, y));
    } else if goes_on(id) {
        return;
    } else if ends_on_smooth(id) {
        if !is_first_chunk {
            return;
        }
        seen = hit_of_smooth(at, id, key_t(~won));
    } else {
        if id - params.id_first >= params.id_count {
            return;
        }
        seen = hit_of_triangle(at, id, key_layer(~won), key_t(~won));
    }

    // store it
    store(PLANE_T, at, bitcast<u32>(seen.t));
    store(PLANE_Z, at, bitcast<u32>(seen.z));
    store(PLANE_TRIANGLE_ID, at, seen.id);
    store(PLANE_A, at, bitcast<u32>(seen.alpha));
    store(PLANE_BARY_U, at, bitcast<u32>(seen.weights.x));
    store(PLANE_BARY_V, at, bitcast<u32>(seen.weights.y));
    // the piece of the camera's own ray, or the surface of its first bounce
    let surface = first_surface(pixel);
    store(PLANE_PIECE_ID, at, select(first_piece(pixel), seen.piece, surface == NONE));
    store(PLANE_MIRROR_ID, at, surface);
    store(PLANE_N_X, at, bitcast<u32>(seen.n.x));
    store(PLANE_N_Y, at, bitcast<u32>(seen.n.y));
    store(PLANE_N_Z, at, bitcast<u32>(seen.n.z));
    store(PLANE_P_X, at, bitcast<u32>(seen.p.x));
    store(PLANE_P_Y, at, bitcast<u32>(seen.p.y));
    store(PLANE_P_Z, at, bitcast<u32>(seen.p.z));
    store(PLANE_VIEW_X, at, bitcast<u32>(seen.view.x));
    store(PLANE_VIEW_Y, at, bitcast<u32>(seen.view.y));
    store(PLANE_VIEW_Z, at, bitcast<u32>(seen.view.z));
    store(PLANE_ALBEDO_R, at, bitcast<u32>(seen.albedo.x));
    store(PLANE_ALBEDO_G, at, bitcast<u32>(seen.albedo.y));
    store(PLANE_ALBEDO_B, at, bitcast<u32>(seen.albedo.z));
    store(PLANE_UV_U, at, bitcast<u32>(seen.uv.x));
    store(PLANE_UV_V, at, bitcast<u32>(seen.uv.y));
    let left = light_left(pixel) * seen.light;
    add(PLANE_R, at, left.x);
    add(PLANE_G, at, left.y);
    add(PLANE_B, at, left.z);
    write_srgb(pixel, left);
}

fn store(plane: u32, at: Place, word: u32) {
    if plane != NONE && says_what_is_seen(at.pixel) {
        planes[plane * at.count + at.pixel] = word;
    }
}

fn add(plane: u32, at: Place, light: f32) {
    if plane != NONE {
        planes[plane * at.count + at.pixel] = bitcast<u32>(light_before(plane, at) + light);
    }
}

fn miss(at: Place, light: vec3<f32>) -> Seen {
    let none = vec3<f32>(0.0);
    let infinity = bitcast<f32>(0x7f800000u);
    let alpha = select(1.0, 0.0, first_surface(at.pixel) == NONE);
    return Seen(NONE, infinity, infinity, alpha, NONE, none.xy, none, none, none, none, none.xy, light);
}

// A hit at t of the last ray on a smooth surface where rays end.
fn hit_of_smooth(at: Place, id: u32, t: f32) -> Seen {
    var seen = miss(at, colour_of(id, vec3<f32>(0.0)));
    seen.id = id;
    seen.t = t;
    seen.alpha = 1.0;
    if !FOLLOWS_RAYS {
        return seen;
    }
    let x = at.pixel % params.width;
    let y = at.pixel / params.width;
    let ray = pixel_ray(0u, x, y, t);
    seen.z = path_length(at.pixel) + reached(ray, 0u, x, y, t);
    seen.piece = 0u;
    seen.p = point_at(ray, t) + shading.anchor;
    seen.view = -normalize(ray.d);
    seen.albedo = seen.light;
    return seen;
}

// A hit at t of the last ray, in a layer, on a triangle of this chunk.
fn hit_of_triangle(at: Place, id: u32, layer: u32, t: f32) -> Seen {
    var seen = miss(at, vec3<f32>(0.0));
    seen.id = id;
    seen.t = f32(layer) + t;
    seen.alpha = 1.0;
    if !FOLLOWS_RAYS {
        return seen;
    }

    // what the key does not say: the ray and the triangle
    let x = at.pixel % params.width;
    let y = at.pixel / params.width;
    let slot = slot_of(id);
    let triangle = triangle_at(slot);
    let ray = pixel_ray(layer, x, y, t);
    seen.z = 0.0;
    if PLANE_Z != NONE || STYLED {
        // all of the segments in lower layers, of the rays before, and a part of the last
        seen.z = path_length(at.pixel) + reached(ray, layer, x, y, t);
        for (var k = 0u; SLABBED && k < layer; k++) {
            seen.z += segment_length(k, x, y);
        }
    }
    if PLANE_PIECE_ID != NONE || PLANE_MIRROR_ID != NONE {
        seen.piece = piece_number(layer, x, y);
    }
    if (PLANE_BARY_U != NONE || PLANE_BARY_V != NONE) && has_corners(triangle) {
        seen.weights = weights_real(ray_bundle(layer, x, y, t), triangle).yz;
    }
    var differential: RayDifferential;
    if TEXTURED || STYLED {
        differential = ray_differential(layer, x, y, t);
    }
    take_surface(triangle, layer, x, y, t);
    let hit = ShadedHit(slot, point_at(ray, t), seen.z, ray.d, differential, shading.filter_width);
    var diffuse = surface_albedo(slot, triangle, ray, differential) * pattern_at(hit);
    seen.n = surface_normal(slot, triangle, ray);
    let place = Lit(slot, point_at(ray, t), reach_of(ray, t), seen.n, normalize(ray.d));
    var as_it_is = vec3<f32>(0.0);
    if PICTURES {
        let picture = painted(place, differential, diffuse);
        diffuse = picture.lit;
        as_it_is = picture.seen;
    }
    seen.p = point_at(ray, t) + shading.anchor;
    seen.view = -normalize(ray.d);
    seen.albedo = colour_of(id, diffuse);
    if PICTURES {
        seen.albedo = colour_of(id, diffuse + as_it_is);
    }
    if PLANE_UV_U != NONE || PLANE_UV_V != NONE {
        seen.uv = surface_uv(slot, triangle, ray);
    }
    if WRITES || PLANE_R != NONE || PLANE_G != NONE || PLANE_B != NONE {
        var lit = sent_back(place, diffuse);
        if PICTURES {
            lit += as_it_is;
        }
        seen.light = colour_of(id, drawn(hit, seen.n, lit));
    }
    return seen;
}

// Weights of the file's corners in recheck arithmetic: E12, E20 and E01 over their sum, which is h N . d.
fn weights_real(b: Bundle, triangle: vec4<u32>) -> vec3<f32> {
    let v0 = vertex_real(triangle.x);
    let v1 = vertex_real(triangle.y);
    let v2 = vertex_real(triangle.z);
    let g0 = cross(b.d, v0 * b.h - b.p);
    let w = real3(dot(v2 - v1, cross(b.d, v1 * b.h - b.p)), dot(v0 - v2, g0), dot(v1 - v0, g0));
    return in_file_order(vec3<f32>(w / (w.x + w.y + w.z)), triangle);
}

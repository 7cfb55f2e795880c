// shade: one thread per pixel of the band.
// Reads the visibility buffer, the triangle that won and the pixel's ray; writes the planes that were asked for.
// A pixel whose triangle lies in another chunk of the scene is left to that chunk's dispatch.
// Provides: Place
// Needs: Bundle, Lit, NONE, RayDifferential, SLABBED, STYLED, ShadedHit, TEXTURED, beyond, colour_of, drawn, ends_on_smooth, first_piece,
//   first_surface, goes_on, has_path, in_file_order, item_index, key_id, key_layer, key_t, light_before, light_left, path_length,
//   pattern_at, piece_number, pixel_ray, point_at, ray_bundle, ray_differential, reach_of, reached, real3, says_what_is_seen,
//   segment_length, sent_back, surface_albedo, surface_normal, surface_uv, triangle_at, vertex_real
// Binds: params, planes, shading, slot_of_id, visibility

fn store(plane: u32, at: Place, word: u32) {
    if plane != NONE && says_what_is_seen() {
        planes[plane * at.count + at.pixel] = word;
    }
}

fn add(plane: u32, at: Place, light: f32) {
    if plane != NONE {
        planes[plane * at.count + at.pixel] = bitcast<u32>(light_before(plane, at) + light);
    }
}

// A pixel's index, and the number of pixels in a plane.
struct Place {
    pixel: u32,
    count: u32,
}

@compute @workgroup_size(64)
fn shade(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    // take a pixel
    let pixel = item_index(group, groups, lane);
    let at = Place(pixel, params.width * params.height);
    if pixel >= at.count {
        return;
    }
    let won = vec2<u32>(visibility[2u * pixel], visibility[2u * pixel + 1u]);
    if all(won == vec2<u32>(0u)) {
        if params.id_first == 0u && has_path(pixel % params.width, pixel / params.width) {
            store_miss(at, beyond(pixel % params.width, pixel / params.width));
        }
        return;
    }
    let id = key_id(~won);
    if goes_on(id) {
        return;
    }
    let x = pixel % params.width;
    let y = pixel / params.width;
    if ends_on_smooth(id) {
        if params.id_first == 0u {
            let t = key_t(~won);
            let ray = pixel_ray(0u, x, y, t);
            store_place(at, id, t, path_length(pixel) + reached(ray, 0u, x, y, t));
            store(PLANE_A, at, bitcast<u32>(1.0));
            store_no_weights(at);
            store_piece(at, 0u);
            let own = colour_of(id, vec3<f32>(0.0));
            store_surface(at, vec3<f32>(0.0), point_at(ray, t) + shading.anchor, own);
            store_uv(at, vec2<f32>(0.0));
            store_light(at, own);
        }
        return;
    }
    if id - params.id_first >= params.id_count {
        return;
    }

    // what the key does not say: the ray and the triangle
    let slot = slot_of_id[id - params.id_first];
    let triangle = triangle_at(slot);
    let layer = key_layer(~won);
    let t = key_t(~won);
    let ray = pixel_ray(layer, x, y, t);
    var z = 0.0;
    if PLANE_Z != NONE || STYLED {
        // all of the segments in lower layers, of the rays before, and a part of the last
        z = path_length(pixel) + reached(ray, layer, x, y, t);
        for (var k = 0u; SLABBED && k < layer; k++) {
            z += segment_length(k, x, y);
        }
    }
    store(PLANE_A, at, bitcast<u32>(1.0));
    store_place(at, id, f32(layer) + t, z);
    if PLANE_PIECE_ID != NONE || PLANE_MIRROR_ID != NONE {
        store_piece(at, piece_number(layer, x, y));
    }
    if PLANE_BARY_U != NONE || PLANE_BARY_V != NONE {
        let weights = weights_real(ray_bundle(layer, x, y, t), triangle);
        store(PLANE_BARY_U, at, bitcast<u32>(weights.y));
        store(PLANE_BARY_V, at, bitcast<u32>(weights.z));
    }
    var differential: RayDifferential;
    if TEXTURED || STYLED {
        differential = ray_differential(layer, x, y, t);
    }
    let hit = ShadedHit(slot, point_at(ray, t), z, ray.d, differential, shading.filter_width);
    let diffuse = surface_albedo(slot, triangle, ray, differential) * pattern_at(hit);
    let n = surface_normal(slot, triangle, ray);
    store_surface(at, n, point_at(ray, t) + shading.anchor, colour_of(id, diffuse));
    if PLANE_UV_U != NONE || PLANE_UV_V != NONE {
        store_uv(at, surface_uv(slot, triangle, ray));
    }
    if PLANE_R != NONE || PLANE_G != NONE || PLANE_B != NONE {
        let lit = sent_back(Lit(slot, point_at(ray, t), reach_of(ray, t), n, normalize(ray.d), 1.0), diffuse);
        store_light(at, colour_of(id, drawn(hit, n, lit)));
    }
}

// A hit at t of the last ray, and its depth z along the whole path.
fn store_place(at: Place, id: u32, t: f32, z: f32) {
    store(PLANE_T, at, bitcast<u32>(t));
    store(PLANE_Z, at, bitcast<u32>(z));
    store(PLANE_TRIANGLE_ID, at, id);
}

fn store_no_weights(at: Place) {
    store(PLANE_BARY_U, at, 0u);
    store(PLANE_BARY_V, at, 0u);
}

// The piece of the camera's own ray, or the surface of its first bounce.
fn store_piece(at: Place, piece: u32) {
    let surface = first_surface(at.pixel);
    store(PLANE_PIECE_ID, at, select(first_piece(at.pixel), piece, surface == NONE));
    store(PLANE_MIRROR_ID, at, surface);
}

// The surface: its normal, the hit, and its unlit colour.
fn store_surface(at: Place, n: vec3<f32>, p: vec3<f32>, albedo: vec3<f32>) {
    store(PLANE_N_X, at, bitcast<u32>(n.x));
    store(PLANE_N_Y, at, bitcast<u32>(n.y));
    store(PLANE_N_Z, at, bitcast<u32>(n.z));
    store(PLANE_P_X, at, bitcast<u32>(p.x));
    store(PLANE_P_Y, at, bitcast<u32>(p.y));
    store(PLANE_P_Z, at, bitcast<u32>(p.z));
    store(PLANE_ALBEDO_R, at, bitcast<u32>(albedo.x));
    store(PLANE_ALBEDO_G, at, bitcast<u32>(albedo.y));
    store(PLANE_ALBEDO_B, at, bitcast<u32>(albedo.z));
}

fn store_uv(at: Place, uv: vec2<f32>) {
    store(PLANE_UV_U, at, bitcast<u32>(uv.x));
    store(PLANE_UV_V, at, bitcast<u32>(uv.y));
}

fn store_light(at: Place, colour: vec3<f32>) {
    let left = light_left(at.pixel) * colour;
    add(PLANE_R, at, left.x);
    add(PLANE_G, at, left.y);
    add(PLANE_B, at, left.z);
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

fn store_miss(at: Place, colour: vec3<f32>) {
    let infinity = 0x7f800000u;
    store_place(at, NONE, bitcast<f32>(infinity), bitcast<f32>(infinity));
    store(PLANE_A, at, select(bitcast<u32>(1.0), 0u, first_surface(at.pixel) == NONE));
    store_no_weights(at);
    store_piece(at, NONE);
    store_surface(at, vec3<f32>(0.0), vec3<f32>(0.0), vec3<f32>(0.0));
    store_uv(at, vec2<f32>(0.0));
    store_light(at, colour);
}

// shade: one thread per pixel of the band.
// Reads the visibility buffer, the triangle that won and the pixel's ray; writes the planes that were asked for.
// A pixel whose triangle lies in another chunk of the scene is left to that chunk's dispatch.

fn store(plane: u32, pixel: u32, word: u32) {
    if plane != NONE {
        planes[plane * params.width * params.height + pixel] = word;
    }
}

@compute @workgroup_size(64)
fn shade(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    // take a pixel
    let pixel = item_index(group, groups, lane);
    if pixel >= params.width * params.height {
        return;
    }
    let won = vec2<u32>(visibility[2u * pixel], visibility[2u * pixel + 1u]);
    if all(won == vec2<u32>(0u)) {
        if params.id_first == 0u {
            store_miss(pixel);
        }
        return;
    }
    let id = key_id(~won);
    if id - params.id_first >= params.id_count {
        return;
    }

    // find the hit again
    let x = pixel % params.width;
    let y = pixel / params.width;
    let b = ray_bundle(x, y);
    let slot = slot_of_id[id - params.id_first];
    let triangle = triangles[slot];
    let v0 = vertex_real(triangle.x);
    let v1 = vertex_real(triangle.y);
    let v2 = vertex_real(triangle.z);
    let normal = cross(v1 - v0, v2 - v0);
    let across = dot(normal, b.d);
    let t = dot(normal, v0 * b.h - b.p) / across;

    // weights of the row's vertices: E12, E20 and E01 over their sum, which is N . d
    let g0 = cross(b.d, v0 * b.h - b.p);
    let g1 = cross(b.d, v1 * b.h - b.p);
    let w0 = dot(v2 - v1, g1);
    let w1 = dot(v0 - v2, g0);
    let w2 = dot(v1 - v0, g0);
    let sum = w0 + w1 + w2;
    let row_weights = vec3<f32>(vec3<real>(w0, w1, w2) / sum);
    let order = corner_order(triangle_order(triangle));
    let weights = clamp(vec3<f32>(row_weights[order.x], row_weights[order.y], row_weights[order.z]), vec3<f32>(0.0), vec3<f32>(1.0));

    // write what was asked for
    store(shading.plane_a, pixel, bitcast<u32>(1.0));
    store(shading.plane_t, pixel, bitcast<u32>(f32(t)));
    store(shading.plane_z, pixel, bitcast<u32>(f32(t * (sqrt(dot(b.d, b.d)) / b.h))));
    store(shading.plane_triangle, pixel, id);
    store(shading.plane_piece, pixel, piece_number(x, y));
    store(shading.plane_u, pixel, bitcast<u32>(weights.y));
    store(shading.plane_v, pixel, bitcast<u32>(weights.z));
    if shading.plane_r != NONE || shading.plane_g != NONE || shading.plane_b != NONE {
        let facing = select(real(1.0), real(-1.0), triangle_reversed(triangle));
        let flat_normal = normalize(vec3<f32>(unit_real(normal) * facing));
        let colour = light(slot, weights, flat_normal, vec3<f32>(unit_real(b.d)));
        store(shading.plane_r, pixel, bitcast<u32>(colour.x));
        store(shading.plane_g, pixel, bitcast<u32>(colour.y));
        store(shading.plane_b, pixel, bitcast<u32>(colour.z));
    }
}

fn unit_real(v: real3) -> real3 {
    return v / sqrt(dot(v, v));
}

fn store_miss(pixel: u32) {
    let infinity = 0x7f800000u;
    store(shading.plane_r, pixel, bitcast<u32>(shading.background.x));
    store(shading.plane_g, pixel, bitcast<u32>(shading.background.y));
    store(shading.plane_b, pixel, bitcast<u32>(shading.background.z));
    store(shading.plane_a, pixel, 0u);
    store(shading.plane_z, pixel, infinity);
    store(shading.plane_t, pixel, infinity);
    store(shading.plane_triangle, pixel, NONE);
    store(shading.plane_piece, pixel, NONE);
    store(shading.plane_u, pixel, 0u);
    store(shading.plane_v, pixel, 0u);
}

// Lambert from every light and a small ambient term; the normal is the file's where it has them, turned to the viewer.
fn light(slot: u32, weights: vec3<f32>, flat_normal: vec3<f32>, view: vec3<f32>) -> vec3<f32> {
    let surface = surfaces[slot];
    var n = flat_normal;
    if shading.has_normals != 0u && surface.x != NONE && surface.y != NONE && surface.z != NONE {
        let smooth_normal = weights.x * stored_normal(surface.x) + weights.y * stored_normal(surface.y)
            + weights.z * stored_normal(surface.z);
        if dot(smooth_normal, smooth_normal) > 0.0 {
            n = normalize(smooth_normal);
        }
    }
    // the side that is seen is the flat side's
    let seen = flat_normal * select(1.0, -1.0, dot(flat_normal, view) > 0.0);
    if dot(n, seen) < 0.0 {
        n = -n;
    }
    let diffuse = materials[surface.w].xyz;
    var received = shading.ambient;
    if shading.light_count == 0u {
        received += (1.0 - shading.ambient) * max(0.0, -dot(n, view));
    }
    for (var k = 0u; k < shading.light_count; k++) {
        received += (1.0 - shading.ambient) * max(0.0, -dot(n, lights[k].xyz));
    }
    return diffuse * received;
}

fn stored_normal(index: u32) -> vec3<f32> {
    return vec3<f32>(normals[3u * index], normals[3u * index + 1u], normals[3u * index + 2u]);
}

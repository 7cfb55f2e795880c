// bounce: one thread per pixel of the band.
// Reads the visibility buffer, the pixel's ray and way and the surface that it meets first; writes the ray that goes on
// from there and its way, or neither.
// Needs: NONE, Way, camera_of, head_of, item_index, key_id, norm, ray_bundle, real, real3, turn_at
// Binds: optic, params, turned_hi, turned_lo, turned_ways, visibility, ways

// Squared length of a direction at most: corners' rays are scaled to 64 times unit length at most.
const SIZE_MAX: f32 = 65536.0;

fn store_number(at: u32, value: real) {
    // rounded by integer operations: a driver may optimize away a conversion to f32 and back
    let head = head_of(value);
    turned_hi[at] = f32(head);
    turned_lo[at] = f32(value - head);
}

fn store_vector(at: u32, v: real3) {
    store_number(at, v.x);
    store_number(at + 1u, v.y);
    store_number(at + 2u, v.z);
}

@compute @workgroup_size(64)
fn bounce(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    // take a pixel
    let pixel = item_index(group, groups, lane);
    if pixel >= params.width * params.height {
        return;
    }
    let x = pixel % params.width;
    let y = pixel / params.width;
    let at = 6u * (y * (params.width + 1u) + x);
    let won = vec2<u32>(visibility[2u * pixel], visibility[2u * pixel + 1u]);
    let id = key_id(~won);
    if all(won == vec2<u32>(0u)) || id < optic.first_id {
        store_vector(at, real3(real(0.0)));
        store_vector(at + 3u, real3(real(0.0)));
        turned_ways[pixel] = Way(vec3<f32>(0.0), 0.0, NONE, NONE, 0u, 0u);
        return;
    }

    // turn its ray
    let b = ray_bundle(0u, x, y, 0.0);
    let p = b.p / b.h;
    let way = ways[pixel];
    let surface = id - optic.first_id;
    var turned = turn_at(surface, p, b.d / b.h, way.last);
    // corners' rays that cancel leave no direction, and no number where they cannot be scaled
    let size = f32(dot(turned.d, turned.d));
    if !(size > 0.0 && size < SIZE_MAX) {
        turned.d = real3(real(0.0));
    }
    store_vector(at, select(turned.place, real3(optic.from_hi) + real3(optic.from_lo), optic.is_environment == 1u));
    store_vector(at + 3u, turned.d);
    let first = select(way.first, surface, way.first == NONE);
    let camera = select(way.camera, camera_of(surface), way.first == NONE);
    let length = way.length + f32(norm(turned.place - p));
    let light = way.light * optic.tint * optic.scale * f32(turned.share);
    turned_ways[pixel] = Way(light, length, first, id, camera, 0u);
}

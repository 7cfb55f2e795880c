// gather: one thread per pixel of the band.
// Reads the visibility buffer, the place of the pixel's hit on a receiver, and the flux of the four texels around it; adds
// its diffuse reflection to the colour planes.

#choose arithmetic f32
#import caustics
#import caustics/layout.wgsl
#import keys/key.wgsl
#import shared/items.wgsl
#import shared/params.wgsl
#import shared/planes.wgsl

var<storage, read> receiver_triangle_of: array<u32>;
var<storage, read> receiver_triangles: array<ReceiverTriangle>;
var<storage, read> receivers: array<Receiver>;
var<storage, read> sums: array<u32>;
var<storage, read> visibility: array<u32>;

fn received(receiver: Receiver, x: u32, y: u32) -> vec3<f32> {
    let at = 6u * (receiver.first + y * receiver.columns + x);
    let low = vec3<f32>(vec3<u32>(sums[at], sums[at + 2u], sums[at + 4u]));
    let high = vec3<f32>(vec3<u32>(sums[at + 1u], sums[at + 3u], sums[at + 5u]));
    return receiver.scale * (high * 4294967296.0 + low);
}

fn add(plane: u32, at: u32, light: f32) {
    if plane != NONE {
        let k = plane * params.width * params.height + at;
        planes[k] = bitcast<u32>(bitcast<f32>(planes[k]) + light);
    }
}

fn value(plane: u32, at: u32) -> f32 {
    return bitcast<f32>(planes[plane * params.width * params.height + at]);
}

// Diffuse colour of the triangle, from its texture if it has one.
fn diffuse_of(receiver_triangle: ReceiverTriangle, pixel: u32) -> vec3<f32> {
    if PLANE_ALBEDO_R == NONE || PLANE_ALBEDO_G == NONE || PLANE_ALBEDO_B == NONE {
        return receiver_triangle.diffuse;
    }
    return vec3<f32>(value(PLANE_ALBEDO_R, pixel), value(PLANE_ALBEDO_G, pixel), value(PLANE_ALBEDO_B, pixel));
}

@compute @workgroup_size(64)
fn gather(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    // take a pixel that shows a receiver at this bounce
    let pixel = item_index(group, groups, lane);
    if pixel >= params.width * params.height {
        return;
    }
    let won = vec2<u32>(visibility[2u * pixel], visibility[2u * pixel + 1u]);
    let id = key_id(~won);
    if all(won == vec2<u32>(0u)) || !ends_here(id) || id >= arrayLength(&receiver_triangle_of) || receiver_triangle_of[id] == NONE {
        return;
    }

    // find its place on the map
    let receiver_triangle = receiver_triangles[receiver_triangle_of[id]];
    let receiver = receivers[receiver_triangle.receiver];
    let size = vec2<f32>(f32(receiver.columns), f32(receiver.rows));
    let at = receiver_triangle.a + value(PLANE_BARY_U, pixel) * receiver_triangle.ab + value(PLANE_BARY_V, pixel) * receiver_triangle.ac;
    if any(at < vec2<f32>(0.0)) || any(at > size) {
        return;
    }

    // between the middles of texels light is bilinear, beyond the outermost constant
    let place = clamp(at - 0.5, vec2<f32>(0.0), size - 1.0);
    let x = u32(place.x);
    let y = u32(place.y);
    let x1 = min(x + 1u, receiver.columns - 1u);
    let y1 = min(y + 1u, receiver.rows - 1u);
    let s = fract(place);
    let above = mix(received(receiver, x, y), received(receiver, x1, y), s.x);
    let below = mix(received(receiver, x, y1), received(receiver, x1, y1), s.x);
    let light = light_kept(pixel) * diffuse_of(receiver_triangle, pixel) * mix(above, below, s.y);
    add(PLANE_R, pixel, light.x);
    add(PLANE_G, pixel, light.y);
    add(PLANE_B, pixel, light.z);
}

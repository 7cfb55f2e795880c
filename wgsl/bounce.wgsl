// bounce: one thread per pixel of the band that may have a ray.
// Reads the visibility buffer, the pixel's ray or curve, its path state and the first surface hit; writes the bounced ray and its path
// state, or zeros where the ray misses the optics; and lists the tiles that have a ray.

#import arithmetic
#import keys/key.wgsl
#import nodes/slabs.wgsl
#import optics/arrival
#import optics/bounce
#import optics/layout.wgsl
#import optics/refract.wgsl
#import pixels/live.wgsl
#import rays/pixel
#import shared/params.wgsl

var<storage, read> visibility: array<u32>;
var<storage, read_write> bounced_hi: array<f32>;
var<storage, read_write> bounced_live: array<atomic<u32>>;
var<storage, read_write> bounced_lo: array<f32>;
var<storage, read_write> bounced_paths: array<PathState>;

// Maximum squared length of a direction: corners' rays are scaled to 64 times unit length at most.
const SIZE_MAX: f32 = 65536.0;

fn store_number(at: u32, value: real) {
    // rounded by integer operations: a driver may optimize away a conversion to f32 and back
    let head = round_to_f32(value);
    bounced_hi[at] = f32(head);
    bounced_lo[at] = f32(value - head);
}

fn store_vector(at: u32, v: real3) {
    store_number(at, v.x);
    store_number(at + 1u, v.y);
    store_number(at + 2u, v.z);
}

// Lists a tile, once.
fn list_tile(tile: u32) {
    let mark = 2u + 2u * tile;
    if atomicLoad(&bounced_live[mark]) == 0u && atomicExchange(&bounced_live[mark], 1u) == 0u {
        atomicStore(&bounced_live[1u + 2u * atomicAdd(&bounced_live[0], 1u)], tile);
    }
}

@compute @workgroup_size(64)
fn bounce(
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
    let at = 6u * (y * (params.width + 1u) + x);
    let won = vec2<u32>(visibility[2u * pixel], visibility[2u * pixel + 1u]);
    let id = key_id(~won);
    if all(won == vec2<u32>(0u)) || id < optic.first_id {
        store_vector(at, real3(real(0.0)));
        store_vector(at + 3u, real3(real(0.0)));
        bounced_paths[pixel] = PathState(vec3<f32>(0.0), 0.0, NONE, NONE, 0u, 0u);
        return;
    }

    // reflect or refract its ray
    list_tile((y / TILE) * params.tiles_x + x / TILE);
    let path = paths[pixel];
    let surface = id - optic.first_id;
    let layer = key_layer(~won);
    let arrival = arrival_at(surface, layer, x, y, key_t(~won));
    var next = bounce_at(surface, arrival.p, arrival.d, path.last);
    // interpolated corners' rays may cancel, or be NaN where they cannot be scaled: no ray then
    let size = f32(dot(next.d, next.d));
    if !(size > 0.0 && size < SIZE_MAX) {
        next.d = real3(real(0.0));
    }
    store_vector(at, select(next.place, real3(optic.from_hi) + real3(optic.from_lo), optic.is_environment == 1u));
    store_vector(at + 3u, next.d);
    let first = select(path.first, surface, path.first == NONE);
    let piece = select(path.piece, piece_of(surface), path.first == NONE);
    var length = path.length + arrival.length + f32(norm(next.place - arrival.p));
    for (var k = 0u; SLABBED && k < layer; k++) {
        length += segment_length(k, x, y);
    }
    let light = path.light * optic.tint * optic.scale * f32(next.share);
    bounced_paths[pixel] = PathState(light, length, first, id, piece, 0u);
}

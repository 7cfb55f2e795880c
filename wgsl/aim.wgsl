// aim: one thread per ray of a field's table.
// Reads the rays of a lens, and the eye and axes of the viewer; writes the rays, turned and moved.

#import arithmetic
#import shared/items.wgsl
#import shared/params.wgsl

var<storage, read> lens_hi: array<f32>;
var<storage, read> lens_lo: array<f32>;
var<storage, read_write> rays_hi: array<f32>;
var<storage, read_write> rays_lo: array<f32>;

fn pose_vector(k: u32) -> real3 {
    let a = viewer.numbers[3u * k / 2u];
    let b = viewer.numbers[(3u * k + 2u) / 2u];
    let is_even = (k & 1u) == 0u;
    return real3(
        real_from_bits(select(a.zw, a.xy, is_even)),
        real_from_bits(select(b.xy, a.zw, is_even)),
        real_from_bits(select(b.zw, b.xy, is_even)),
    );
}

// A vector of the lens, turned.
fn turned(at: u32) -> real3 {
    let head = vec3<f32>(lens_hi[at], lens_hi[at + 1u], lens_hi[at + 2u]);
    let own = real3(head) + real3(vec3<f32>(lens_lo[at], lens_lo[at + 1u], lens_lo[at + 2u]));
    return own.x * pose_vector(1u) + own.y * pose_vector(2u) + own.z * pose_vector(3u);
}

fn store(at: u32, value: real) {
    // rounded by integer operations: a driver may optimize away a conversion to f32 and back
    let head = round_to_f32(value);
    rays_hi[at] = f32(head);
    rays_lo[at] = f32(value - head);
}

@compute @workgroup_size(64)
fn aim(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let item = item_index(group, groups, lane);
    if item >= viewer.ray_count {
        return;
    }
    // the direction comes last
    let end = viewer.numbers_a_ray * (item + 1u);
    let d = turned(end - 3u);
    var p = pose_vector(0u);
    if viewer.numbers_a_ray == 6u {
        p += turned(end - 6u);
    }
    let at = 6u * item;
    store(at, p.x);
    store(at + 1u, p.y);
    store(at + 2u, p.z);
    store(at + 3u, d.x);
    store(at + 4u, d.y);
    store(at + 5u, d.z);
}

// forget: one thread per pixel of a tile that had a ray after as many bounces before.
// Reads the list of these tiles; writes zeros for their rays and path states. They may be of a band with more rows.

#import optics/layout.wgsl
#import shared/items.wgsl
#import shared/params.wgsl

var<storage, read_write> bounced_hi: array<f32>;
var<storage, read_write> bounced_live: array<atomic<u32>>;
var<storage, read_write> bounced_lo: array<f32>;
var<storage, read_write> bounced_paths: array<PathState>;

@compute @workgroup_size(64)
fn forget(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    // take a pixel of a tile
    let index = group_index(group, groups);
    if index >= atomicLoad(&bounced_live[0]) {
        return;
    }
    let tile = atomicLoad(&bounced_live[1u + 2u * index]);
    let at = TILE * vec2<u32>(tile % params.tiles_x, tile / params.tiles_x) + vec2<u32>(lane % TILE, lane / TILE);
    let pixel = at.y * params.width + at.x;
    if at.x >= params.width || pixel >= arrayLength(&bounced_paths) {
        return;
    }

    // it has no ray
    for (var k = 0u; k < 6u; k++) {
        bounced_hi[6u * (at.y * (params.width + 1u) + at.x) + k] = 0.0;
        bounced_lo[6u * (at.y * (params.width + 1u) + at.x) + k] = 0.0;
    }
    bounced_paths[pixel] = PathState(vec3<f32>(0.0), 0.0, NONE, NONE, 0u, 0u);
}

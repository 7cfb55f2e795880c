// raytrace: one thread per pixel of the band.
// Reads the pixel's rays, segment by segment, and triangles in a bounding volume hierarchy, or one after the other; writes the
// visibility key of the nearest triangle of the first segment that meets one.

#import arithmetic
#import keys/key.wgsl
#import rays/pixel
#import rivals/path
#import rivals/search
#import shared/items.wgsl
#import shared/params.wgsl

var<storage, read_write> visibility: array<vec2<u32>>;

override LAYERS: u32 = 1u;
override SEGMENTS: u32 = 1u;      // of a layer

@compute @workgroup_size(64)
fn raytrace(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    // take a pixel, those of a tile together
    let item = item_index(group, groups, lane);
    let tile = item / (TILE * TILE);
    let x = (tile % params.tiles_x) * TILE + item % TILE;
    let y = (tile / params.tiles_x) * TILE + (item / TILE) % TILE;
    if x >= params.width || y >= params.height {
        return;
    }

    // follow its path to the first triangle
    for (var layer = 0u; layer < LAYERS; layer++) {
        if has_ray(layer, x, y) {
            for (var k = 0u; k < SEGMENTS; k++) {
                let found = traced(path_segment(layer, x, y, k));
                if found.id != NONE {
                    visibility[y * params.width + x] = ~visibility_key(layer, real(path_t(found.s, k)), found.id);
                    return;
                }
            }
        }
    }
}

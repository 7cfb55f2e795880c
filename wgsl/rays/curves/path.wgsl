// The curve of a pixel in a layer, as trace follows it.

#import optics/start
#import rays/curves/coverage.wgsl
#import rays/curves/curve.wgsl
#import rays/curves/stretch.wgsl
#import shared/params.wgsl

fn path_of(layer: u32, x: u32, y: u32) -> Path {
    var net = control_net(curve_place(layer, x, y));
    var reach = 0.0;
    for (var k = 0u; k < 4u; k++) {
        reach = max(reach, largest_of(net[k]));
        net[k] += params.bvh_offset;
    }
    let tile = (layer * params.spans * params.slab_rows + y / TILE) * params.tiles_x + x / TILE;
    return Path(net, reach, (tile << 6u) | ((y % TILE) * TILE + x % TILE), start_of(y * params.width + x));
}

// The ray of a pixel of a field, as trace follows it.

#import optics/start
#import rays/coverage
#import rays/field/table.wgsl
#import rays/straight/stretch.wgsl
#import rays/stretch
#import shared/params.wgsl

fn path_of(layer: u32, x: u32, y: u32) -> Path {
    let at = field_at(x, y);
    let p = field_origin(at);
    let d = field_direction(at);
    let tile = (y / TILE) * params.tiles_x + x / TILE;
    return Path(p, UNIT * largest_of(p), d, UNIT * largest_of(d), (tile << 6u) | ((y % TILE) * TILE + x % TILE), start_of(y * params.width + x));
}

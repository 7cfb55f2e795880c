// The ray of a pixel that a piece owns, as trace follows it.

#import nodes/cells.wgsl
#import nodes/tables.wgsl
#import optics/start
#import rays/coverage
#import rays/pieces/bundle.wgsl
#import rays/pieces/table.wgsl
#import rays/straight/stretch.wgsl
#import rays/stretch
#import shared/params.wgsl

// Errors: numbers as stored, a product and two sums lose 4 units of the sizes of what is summed up, and this bound 1. A quotient loses what
// its dividend and its divisor lost, over 1 - loss_h, and 5 units. Where loss_h is large nothing is known of the ray, so nothing is left out.
fn path_of(layer: u32, x: u32, y: u32) -> Path {
    let cell = cells[pixel_cell(layer, x, y)];
    let q = piece_at(cell.piece);
    let place = vec2<f32>(f32(x % TILE), f32(y % TILE)) - TILE_REACH;
    let h = cell.h + place.x * q.hx_hi + place.y * q.hy_hi;
    let reach_h = abs(cell.h) + TILE_REACH * (abs(q.hx_hi) + abs(q.hy_hi));
    let reach_p = largest_of(cell.p) + TILE_REACH * (largest_of(q.px_hi) + largest_of(q.py_hi));
    let reach_d = largest_of(cell.d) + TILE_REACH * (largest_of(q.dx_hi) + largest_of(q.dy_hi));
    let p = (cell.p + place.x * q.px_hi + place.y * q.py_hi) / h;
    let d = (cell.d + place.x * q.dx_hi + place.y * q.dy_hi) / h;
    let loss_h = 5.0 * UNIT * reach_h / abs(h);
    let is_sure = loss_h < 0.25;
    let more = 1.0 / max(1.0 - loss_h, 0.5);
    let error_p = more * (loss_h * largest_of(p) + 5.0 * UNIT * reach_p / abs(h)) + 5.0 * UNIT * largest_of(p);
    let error_d = more * (loss_h * largest_of(d) + 5.0 * UNIT * reach_d / abs(h)) + 5.0 * UNIT * largest_of(d);
    return Path(
        select(vec3<f32>(0.0), p, is_sure), select(ENDLESS, error_p, is_sure),
        select(vec3<f32>(1.0), d, is_sure), select(ENDLESS, error_d, is_sure),
        (cell.tile << 6u) | ((y % TILE) * TILE + x % TILE), start_of(y * params.width + x),
    );
}

// Rays of a camera made of pieces, pixel by pixel; the piece is looked up.

#import arithmetic
#import nodes/cells.wgsl
#import nodes/tables.wgsl
#import rays/affine_bundle.wgsl
#import rays/pieces/bundle.wgsl
#import rays/pieces/piece.wgsl
#import rays/pieces/table.wgsl
#import rays/ray.wgsl
#import shared/params.wgsl

// The bundle of a pixel of the band in a layer.
fn ray_bundle(layer: u32, x: u32, y: u32, t: f32) -> Bundle {
    let q = piece_at(cells[pixel_cell(layer, x, y)].piece);
    return bundle_at(piece_bundle(q), real(f32(x) - q.origin_x), real(f32(y) - q.origin_y));
}

fn has_ray(layer: u32, x: u32, y: u32) -> bool {
    return pixel_cell(layer, x, y) != NONE;
}

// The ray of a pixel that a piece owns, from its cell.
fn pixel_ray(layer: u32, x: u32, y: u32, t: f32) -> Ray {
    return cell_ray(cells[pixel_cell(layer, x, y)], x, y);
}

fn cell_ray(cell: Cell, x: u32, y: u32) -> Ray {
    return cell_ray_at(cell, vec2<f32>(f32(x % TILE), f32(y % TILE)) - TILE_REACH);
}

// The ray of a place of a cell, px from its tile's centre.
fn cell_ray_at(cell: Cell, place: vec2<f32>) -> Ray {
    let fx = place.x;
    let fy = place.y;
    let px = piece_at(cell.piece).px_hi;
    let py = piece_at(cell.piece).py_hi;
    let dx = piece_at(cell.piece).dx_hi;
    let dy = piece_at(cell.piece).dy_hi;
    let h = cell.h + fx * piece_at(cell.piece).hx_hi + fy * piece_at(cell.piece).hy_hi;
    return Ray((cell.p + fx * px + fy * py) / h, (cell.d + fx * dx + fy * dy) / h);
}

fn ray_differential(layer: u32, x: u32, y: u32, t: f32) -> RayDifferential {
    return cell_differential(cells[pixel_cell(layer, x, y)], vec2<f32>(f32(x % TILE), f32(y % TILE)) - TILE_REACH, t);
}

// P and D are ratios of affine functions, so their slopes follow from those of numerator and denominator.
fn cell_differential(cell: Cell, place: vec2<f32>, t: f32) -> RayDifferential {
    let ray = cell_ray_at(cell, place);
    let hx = piece_at(cell.piece).hx_hi;
    let hy = piece_at(cell.piece).hy_hi;
    let h = cell.h + place.x * hx + place.y * hy;
    let point = ray.p + t * ray.d;
    let right = piece_at(cell.piece).px_hi + t * piece_at(cell.piece).dx_hi - hx * point;
    let down = piece_at(cell.piece).py_hi + t * piece_at(cell.piece).dy_hi - hy * point;
    return RayDifferential(right / h, down / h);
}

// Point at t of a pixel's ray.
fn point_at(ray: Ray, t: f32) -> vec3<f32> {
    return ray.p + t * ray.d;
}

// The index of the piece that owns the pixel, through all layers.
fn piece_number(layer: u32, x: u32, y: u32) -> u32 {
    return piece_at(cells[pixel_cell(layer, x, y)].piece).number;
}

// Distance along its ray to a hit, in its layer.
fn reached(ray: Ray, layer: u32, x: u32, y: u32, t: f32) -> f32 {
    return t * length(ray.d);
}

// The length of a pixel's segment in a layer, 0 where it has none.
fn segment_length(layer: u32, x: u32, y: u32) -> f32 {
    let cell = pixel_cell(layer, x, y);
    if cell == NONE {
        return 0.0;
    }
    return length(cell_ray(cells[cell], x, y).d);
}

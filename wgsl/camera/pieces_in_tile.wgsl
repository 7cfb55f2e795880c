// Rays of a camera made of pieces, pixel by pixel of a tile: its cells' pieces are loaded by all lanes of a subgroup together, a row of
// pixels.

// The piece that owns the pixel.
var<private> own: Piece;
var<private> is_owned: bool;

fn look_at(x: u32, y: u32, thread: u32) {
    let tile = y / TILE * params.tiles_x + x / TILE;
    let bit = y % TILE * TILE + x % TILE;
    let end = tile_start[tile + 1u];
    var k = tile_start[tile];
    loop {
        let mask = select(cells[k].mask_lo, cells[k].mask_hi, bit >= 32u);
        let piece = lanes_piece(cells[k].piece, thread % LANES);
        // a tile of a hole has no cell
        if k < end && (mask >> (bit & 31u) & 1u) != 0u {
            own = piece;
            is_owned = true;
        }
        k++;
        if k >= end {
            break;
        }
    }
}

fn ray_bundle(layer: u32, x: u32, y: u32, t: f32) -> Bundle {
    return bundle_at(piece_bundle(own), real(f32(x) - own.origin_x), real(f32(y) - own.origin_y));
}

fn has_ray(layer: u32, x: u32, y: u32) -> bool {
    return is_owned;
}

fn pixel_ray(layer: u32, x: u32, y: u32, t: f32) -> Ray {
    let b = ray_bundle(layer, x, y, t);
    return Ray(vec3<f32>(b.p / b.h), vec3<f32>(b.d / b.h));
}

// Where on a pixel's ray t is.
fn point_at(ray: Ray, t: f32) -> vec3<f32> {
    return ray.p + t * ray.d;
}

// The number in the camera of the piece that owns the pixel.
fn piece_number(layer: u32, x: u32, y: u32) -> u32 {
    return own.number;
}

// How far along its ray a hit lies in its layer, the only one.
fn reached(ray: Ray, layer: u32, x: u32, y: u32, t: f32) -> f32 {
    return t * length(ray.d);
}

fn segment_length(layer: u32, x: u32, y: u32) -> f32 {
    return 0.0;
}

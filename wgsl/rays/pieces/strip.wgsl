// The rays of four samples of a pixel of a camera made of pieces.

#import arithmetic
#import depth/column
#import nodes/tables.wgsl
#import rays/affine_bundle.wgsl
#import rays/pieces/piece.wgsl
#import rays/pieces/table.wgsl
#import samples/cells.wgsl
#import samples/offsets.wgsl
#import shared/bits.wgsl
#import shared/params.wgsl

struct SampleStrip {
    strip: Strip,
    exists: vec4<bool>,
}

// Rays of four places of a piece, px from its origin; origins less a point.
fn places_strip(b: Bundle, x: real4, y: real4, less: real3) -> Strip {
    let share = 1.0 / (b.h + x * b.hx + y * b.hy);
    return Strip(
        (b.p.x + x * b.px.x + y * b.py.x) * share - less.x,
        (b.p.y + x * b.px.y + y * b.py.y) * share - less.y,
        (b.p.z + x * b.px.z + y * b.py.z) * share - less.z,
        (b.d.x + x * b.dx.x + y * b.dy.x) * share,
        (b.d.y + x * b.dx.y + y * b.dy.y) * share,
        (b.d.z + x * b.dx.z + y * b.dy.z) * share,
    );
}

fn sample_strip(tile: u32, x: u32, y: u32, first: u32, less: real3) -> SampleStrip {
    let lane = x % TILE;
    let bit = bit_mask((y % TILE) * TILE + x % TILE);
    let a = sample_offset(first);
    let b = sample_offset(min(first + 1u, SAMPLES - 1u));
    let c = sample_offset(min(first + 2u, SAMPLES - 1u));
    let d = sample_offset(min(first + 3u, SAMPLES - 1u));
    var strip = NO_STRIP;
    var exists = vec4<bool>(false);
    for (var k = tile_start[tile]; k < tile_start[tile + 1u]; k++) {
        var owns = vec4<bool>(false);
        for (var n = 0u; n < 4u; n++) {
            if first + n < SAMPLES {
                owns[n] = any((pixels_of_sample(k, first + n) & bit) != vec2<u32>(0u));
            }
        }
        let q = piece_at(cells[k].piece);
        let at = vec2<f32>(f32(x), f32(y)) - vec2<f32>(q.origin_x, q.origin_y);
        let xs = real4(vec4<f32>(a.x, b.x, c.x, d.x)) + real(at.x);
        let ys = real4(vec4<f32>(a.y, b.y, c.y, d.y)) + real(at.y);
        strip = either(strip, places_strip(piece_bundle(q), xs, ys, less), owns);
        exists = exists | owns;
    }
    return SampleStrip(strip, exists);
}

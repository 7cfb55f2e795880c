// The rays of four samples of a pixel of a ray field, from its table and by what they differ.

#import arithmetic
#import depth/column
#import depth/columns/field_exact.wgsl
#import nodes/tables.wgsl
#import samples/cells.wgsl
#import shared/bits.wgsl
#import shared/params.wgsl

var<storage, read> sample_ray_deltas: array<vec2<f32>>;

struct SampleStrip {
    strip: Strip,
    exists: vec4<bool>,
}

fn sample_field_ray(own: FieldRay, at: u32) -> FieldRay {
    let a = sample_ray_deltas[at];
    let b = sample_ray_deltas[at + 1u];
    let c = sample_ray_deltas[at + 2u];
    return FieldRay(own.p + real3(vec3<f32>(a, b.x)), own.d + real3(vec3<f32>(b.y, c)), true);
}

fn sample_strip(tile: u32, x: u32, y: u32, first: u32, less: real3) -> SampleStrip {
    let own = field_ray(x, y, less);
    let at = 3u * (y * params.width + x) * SAMPLES;
    let bit = bit_mask((y % TILE) * TILE + x % TILE);
    var exists = vec4<bool>(false);
    for (var k = tile_start[tile]; k < tile_start[tile + 1u]; k++) {
        for (var n = 0u; n < 4u; n++) {
            if first + n < SAMPLES {
                exists[n] = exists[n] || any((pixels_of_sample(k, first + n) & bit) != vec2<u32>(0u));
            }
        }
    }
    let last = SAMPLES - 1u;
    return SampleStrip(
        field_strip(
            sample_field_ray(own, at + 3u * min(first, last)),
            sample_field_ray(own, at + 3u * min(first + 1u, last)),
            sample_field_ray(own, at + 3u * min(first + 2u, last)),
            sample_field_ray(own, at + 3u * min(first + 3u, last)),
        ),
        exists,
    );
}

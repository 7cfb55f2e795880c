// Rays of the samples of a ray field: differences from the pixel's own ray, six numbers P and D, sample by sample.

#import arithmetic
#import nodes/slabs.wgsl
#import rays/affine_bundle.wgsl
#import rays/field/bundle.wgsl
#import samples/cells.wgsl
#import shared/params.wgsl

var<storage, read> sample_ray_deltas: array<f32>;

fn field_sample(x: u32, y: u32, sample: u32) -> u32 {
    return 6u * ((y * params.width + x) * SAMPLES + sample);
}

fn sample_delta_p(at: u32) -> vec3<f32> {
    return vec3<f32>(sample_ray_deltas[at], sample_ray_deltas[at + 1u], sample_ray_deltas[at + 2u]);
}

fn sample_delta_d(at: u32) -> vec3<f32> {
    return vec3<f32>(sample_ray_deltas[at + 3u], sample_ray_deltas[at + 4u], sample_ray_deltas[at + 5u]);
}

fn sample_bundle(whole: Bundle, cell: Cell, x: u32, y: u32, sample: u32) -> Bundle {
    let corner = tile_corner(cell.tile);
    let at = field_sample(corner.x + x, corner.y + y, sample);
    var b = field_bundle(corner.x + x, corner.y + y);
    b.p += real3(sample_delta_p(at));
    b.d += real3(sample_delta_d(at));
    return b;
}

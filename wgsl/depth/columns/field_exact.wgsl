// The rays of a column of a tile, from the field's table as pairs of numbers.

#import arithmetic
#import depth/column
#import nodes/slabs.wgsl
#import shared/params.wgsl

var<storage, read> rays_hi: array<vec2<f32>>;
var<storage, read> rays_lo: array<vec2<f32>>;

// The ray of a pixel of the band, with the origin less a point; the last number tells whether there is one.
struct FieldRay {
    p: real3,
    d: real3,
    exists: bool,
}

fn field_ray(x: u32, y: u32, less: real3) -> FieldRay {
    let inside = x < params.width && y < params.height;
    let at = 3u * (min(y, params.height) * (params.width + 1u) + min(x, params.width));
    let a = rays_hi[at];
    let b = rays_hi[at + 1u];
    let c = rays_hi[at + 2u];
    let a_lo = rays_lo[at];
    let b_lo = rays_lo[at + 1u];
    let c_lo = rays_lo[at + 2u];
    let p = real3(vec3<f32>(a, b.x)) + real3(vec3<f32>(a_lo, b_lo.x)) - less;
    let d = real3(vec3<f32>(b.y, c)) + real3(vec3<f32>(b_lo.y, c_lo));
    return FieldRay(p, d, inside && any(vec3<f32>(b.y, c) != vec3<f32>(0.0)));
}

fn field_strip(a: FieldRay, b: FieldRay, c: FieldRay, d: FieldRay) -> Strip {
    return Strip(
        real4(a.p.x, b.p.x, c.p.x, d.p.x), real4(a.p.y, b.p.y, c.p.y, d.p.y), real4(a.p.z, b.p.z, c.p.z, d.p.z),
        real4(a.d.x, b.d.x, c.d.x, d.d.x), real4(a.d.y, b.d.y, c.d.y, d.d.y), real4(a.d.z, b.d.z, c.d.z, d.d.z),
    );
}

fn tile_column(tile: u32, x: u32, centre: vec3<f32>) -> Column {
    let less = real3(centre);
    let corner = tile_corner(tile) + vec2<u32>(x, 0u);
    let a = field_ray(corner.x, corner.y, less);
    let b = field_ray(corner.x, corner.y + 1u, less);
    let c = field_ray(corner.x, corner.y + 2u, less);
    let d = field_ray(corner.x, corner.y + 3u, less);
    let e = field_ray(corner.x, corner.y + 4u, less);
    let f = field_ray(corner.x, corner.y + 5u, less);
    let g = field_ray(corner.x, corner.y + 6u, less);
    let h = field_ray(corner.x, corner.y + 7u, less);
    return Column(
        field_strip(a, b, c, d),
        field_strip(e, f, g, h),
        vec4<bool>(a.exists, b.exists, c.exists, d.exists),
        vec4<bool>(e.exists, f.exists, g.exists, h.exists),
    );
}

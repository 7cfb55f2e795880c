// The rays of a column of a tile in f32, from the field's table.

#import depth/bounded/column.wgsl
#import depth/column
#import depth/edges.wgsl
#import nodes/slabs.wgsl
#import shared/params.wgsl

var<storage, read> rays_hi: array<vec2<f32>>;
var<storage, read> rays_lo: array<vec2<f32>>;

// The ray of a pixel of the band, with the origin less a point.
struct FieldRay {
    p: vec3<f32>,
    d: vec3<f32>,
    exists: bool,
}

fn field_ray(x: u32, y: u32, less: vec3<f32>) -> FieldRay {
    let inside = x < params.width && y < params.height;
    let at = 3u * (min(y, params.height) * (params.width + 1u) + min(x, params.width));
    let a = rays_hi[at];
    let b = rays_hi[at + 1u];
    let d = vec3<f32>(b.y, rays_hi[at + 2u]);
    let p = (vec3<f32>(a, b.x) - less) + vec3<f32>(rays_lo[at], rays_lo[at + 1u].x);
    return FieldRay(p, d, inside && any(d != vec3<f32>(0.0)));
}

// Of an origin two sums are off by a unit each, and of a direction its second word, a unit at most, is left out.
fn field_strip(a: FieldRay, b: FieldRay, c: FieldRay, d: FieldRay) -> Strip {
    let p = array<vec4<f32>, 3>(
        vec4<f32>(a.p.x, b.p.x, c.p.x, d.p.x), vec4<f32>(a.p.y, b.p.y, c.p.y, d.p.y), vec4<f32>(a.p.z, b.p.z, c.p.z, d.p.z),
    );
    let along = array<vec4<f32>, 3>(
        vec4<f32>(a.d.x, b.d.x, c.d.x, d.d.x), vec4<f32>(a.d.y, b.d.y, c.d.y, d.d.y), vec4<f32>(a.d.z, b.d.z, c.d.z, d.d.z),
    );
    let error_p = 3.0 * UNIT * size4(p[0], p[1], p[2]);
    let error_d = UNIT * size4(along[0], along[1], along[2]);
    return strip_of(p, error_p, along, error_d, vec4<bool>(a.exists, b.exists, c.exists, d.exists));
}

fn tile_column(tile: u32, x: u32, less: vec3<f32>) -> Column {
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

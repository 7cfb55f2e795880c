// The rays of a field in recheck arithmetic, and as bundles.

#import arithmetic
#import nodes/slabs.wgsl
#import rays/affine_bundle.wgsl
#import rays/field/table.wgsl
#import rays/ray.wgsl
#import shared/params.wgsl

var<storage, read> rays_lo: array<f32>;

fn field_origin_real(at: u32) -> real3 {
    return real3(field_origin(at)) + real3(vec3<f32>(rays_lo[at], rays_lo[at + 1u], rays_lo[at + 2u]));
}

fn field_direction_real(at: u32) -> real3 {
    return real3(field_direction(at)) + real3(vec3<f32>(rays_lo[at + 3u], rays_lo[at + 4u], rays_lo[at + 5u]));
}

// The bundle of a cell: a field has one per pixel.
fn cell_bundle(cell: Cell) -> Bundle {
    let z = real3(0.0);
    return Bundle(z, z, z, z, z, z, real(1.0), real(0.0), real(0.0));
}

fn pixel_bundle(whole: Bundle, cell: Cell, x: u32, y: u32) -> Bundle {
    let corner = tile_corner(cell.tile);
    return field_bundle(corner.x + x, corner.y + y);
}

// The bundle of a pixel of the band: its ray, and slopes to the right and lower neighbours that have a ray.
fn field_bundle(x: u32, y: u32) -> Bundle {
    var b = cell_bundle_at(field_at(x, y));
    let right = cell_bundle_at(field_at(x + 1u, y));
    let below = cell_bundle_at(field_at(x, y + 1u));
    if size3(right.d) > 0.0 {
        b.px = right.p - b.p;
        b.dx = right.d - b.d;
    }
    if size3(below.d) > 0.0 {
        b.py = below.p - b.p;
        b.dy = below.d - b.d;
    }
    return b;
}

fn field_differential(x: u32, y: u32, t: f32) -> RayDifferential {
    let own = field_at(x, y);
    let row = 6u * (params.width + 1u);
    let right = field_step(own, own + 6u, t);
    let left = -field_step(own, select(own - 6u, own, x == 0u), t);
    let below = field_step(own, own + row, t);
    let above = -field_step(own, select(own - row, own, y == 0u), t);
    return RayDifferential(both_sides(right, left), both_sides(below, above));
}

// Vector from a point of one ray to that of another at the same t; 0 if there is no other ray.
fn field_step(own: u32, other: u32, t: f32) -> vec3<f32> {
    let d = field_direction(other);
    let step = field_origin(other) - field_origin(own) + t * (d - field_direction(own));
    return select(step, vec3<f32>(0.0), all(d == vec3<f32>(0.0)));
}

fn cell_bundle_at(at: u32) -> Bundle {
    let z = real3(0.0);
    return Bundle(field_origin_real(at), z, z, field_direction_real(at), z, z, real(1.0), real(0.0), real(0.0));
}

// The ray of a pixel of a field, as trace follows it.
// Provides: path_depth, path_of
// Needs: Path, TILE, UNIT, cell_bundle_at, field_at, field_direction, field_origin, largest_of, ray_meeting, real, real3, start_of,
//   tile_corner
// Binds: params

fn path_of(layer: u32, x: u32, y: u32) -> Path {
    let at = field_at(x, y);
    let p = field_origin(at);
    let d = field_direction(at);
    let tile = (y / TILE) * params.tiles_x + x / TILE;
    return Path(p, UNIT * largest_of(p), d, UNIT * largest_of(d), (tile << 6u) | ((y % TILE) * TILE + x % TILE), start_of(y * params.width + x));
}

// The t of a triangle's plane.
fn path_depth(path: Path, normal: real3, v: array<real3, 3>, slot: u32) -> real {
    let corner = tile_corner(path.item >> 6u);
    let bit = path.item & 63u;
    let own = cell_bundle_at(field_at(corner.x + bit % TILE, corner.y + bit / TILE));
    return ray_meeting(dot(normal, v[0] - own.p), dot(normal, own.d), 0.0, real(0.0)).t;
}

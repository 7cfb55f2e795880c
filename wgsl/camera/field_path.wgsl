// The ray of a pixel of a field, as trace follows it.
// Provides: path_of
// Needs: Path, TILE, UNIT, field_at, field_direction, field_origin, largest_of, start_of
// Binds: params

fn path_of(layer: u32, x: u32, y: u32) -> Path {
    let at = field_at(x, y);
    let p = field_origin(at);
    let d = field_direction(at);
    let tile = (y / TILE) * params.tiles_x + x / TILE;
    return Path(p, UNIT * largest_of(p), d, UNIT * largest_of(d), (tile << 6u) | ((y % TILE) * TILE + x % TILE), start_of(y * params.width + x));
}

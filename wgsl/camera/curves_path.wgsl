// The curve of a pixel in a layer, as trace follows it: a span of t after the other, each about its chord.
// Provides: Path, Seen, Stretch, is_seen, keep_seen, last_of, nothing_seen, path_of, stretch_of, stretches, with_triangle
// Needs: BvhTriangle, CORNER_UNITS, Cell, DEGREE, LEAST, ONE_SIDED, TILE, UNIT, bvh_scale, cell_bundle, cell_depth, control_net, curve_place,
//   is_excluded, merge, net_may_meet, over_span, pixel_depth, real, real3, start_of, tile_layer, triangle_at, triangle_id,
//   triangle_reversed, vertex_real, visibility_key
// Binds: params

struct Path {
    net: array<vec3<f32>, 4>,   // about the origin of the hierarchy
    reach: f32,             // the largest coordinate about the anchor, at which control points were rounded
    item: u32,              // the tile, and in the low 6 bits the pixel
    start: u32,             // the triangle that the ray starts on
}

// X = p + s d for s from `first` to `last`: no point of the path that counts is farther off than the slack, a coordinate.
// s = (t - t_first) t_share.
struct Stretch {
    p: vec3<f32>,
    d: vec3<f32>,
    slack: vec3<f32>,
    first: f32,
    last: f32,
    t_first: f32,
    t_share: f32,
    number: u32,
}

fn stretches() -> u32 {
    return params.spans;
}

fn path_of(layer: u32, x: u32, y: u32) -> Path {
    var net = control_net(curve_place(layer, x, y));
    var reach = 0.0;
    for (var k = 0u; k < 4u; k++) {
        reach = max(reach, largest_of(net[k]));
        net[k] += params.bvh_offset;
    }
    let tile = (layer * params.spans * params.slab_rows + y / TILE) * params.tiles_x + x / TILE;
    return Path(net, reach, (tile << 6u) | ((y % TILE) * TILE + x % TILE), start_of(y * params.width + x));
}

// Along one axis: where the chord begins, how far it goes, and how far the curve is off it at the same t: Bernstein weights are positive
// and add up to 1, and the chord is the curve of evenly spaced control points.
fn chord(net: vec4<f32>, span: vec2<f32>) -> vec3<f32> {
    let b = over_span(net, span);
    if DEGREE == 1u {
        return vec3<f32>(b.x, b.y - b.x, 0.0);
    }
    if DEGREE == 2u {
        return vec3<f32>(b.x, b.z - b.x, abs(b.y - 0.5 * (b.x + b.z)));
    }
    let one = abs(b.y - (2.0 * b.x + b.w) / 3.0);
    return vec3<f32>(b.x, b.w - b.x, max(one, abs(b.z - (b.x + 2.0 * b.w) / 3.0)));
}

fn largest_of(v: vec3<f32>) -> f32 {
    return max(abs(v.x), max(abs(v.y), abs(v.z)));
}

fn stretch_of(path: Path, k: u32, scale: f32) -> Stretch {
    let n = path.net;
    let span = vec2<f32>(f32(k), f32(k + 1u)) / f32(params.spans);
    let x = chord(vec4<f32>(n[0].x, n[1].x, n[2].x, n[3].x) * scale, span);
    let y = chord(vec4<f32>(n[0].y, n[1].y, n[2].y, n[3].y) * scale, span);
    let z = chord(vec4<f32>(n[0].z, n[1].z, n[2].z, n[3].z) * scale, span);
    let far = 1.0 + scale * (path.reach + max(max(largest_of(n[0]), largest_of(n[1])), max(largest_of(n[2]), largest_of(n[3]))));
    let slack = vec3<f32>(x.z, y.z, z.z) + (48.0 + CORNER_UNITS) * UNIT * far + LEAST;
    let more = 8.0 * UNIT * f32(params.spans);
    return Stretch(vec3<f32>(x.x, y.x, z.x), vec3<f32>(x.y, y.y, z.y), slack, -more, 1.0 + more, span.x, f32(params.spans), k);
}

// The complemented key of the nearest hit so far, and a t that is not below its.
struct Seen {
    key: vec2<u32>,
    t: f32,
}

fn nothing_seen() -> Seen {
    return Seen(vec2<u32>(0u), 2.0);
}

fn is_seen(seen: Seen) -> bool {
    return any(seen.key != vec2<u32>(0u));
}

// Says how many hits recheck will count: none.
fn keep_seen(path: Path, seen: Seen, pixel: u32) -> u32 {
    merge(pixel, seen.key);
    return 0u;
}

fn last_of(stretch: Stretch, seen: Seen) -> f32 {
    let s = (seen.t - stretch.t_first) * stretch.t_share;
    return min(stretch.last, s + 8.0 * UNIT * (abs(s) + stretch.t_first * stretch.t_share));
}

fn with_triangle(path: Path, stretch: Stretch, before: Seen, own: BvhTriangle) -> Seen {
    let span = vec2<f32>(f32(stretch.number), f32(stretch.number + 1u)) / f32(params.spans);
    let back = 1.0 / bvh_scale();
    var may = net_may_meet(path.net, path.reach, span, own.v * back, (own.v + own.to_next) * back, (own.v - own.from_last) * back);
    var seen = before;
    loop {
        if !may {
            break;
        }
        may = false;
        let here = hit(path, stretch, own.slot);
        let is_nearer = here.key.y > seen.key.y || (here.key.y == seen.key.y && here.key.x > seen.key.x);
        seen.key = select(seen.key, here.key, is_nearer);
        seen.t = select(seen.t, here.t, is_nearer);
    }
    return seen;
}

// The hit with a triangle over the stretch's span of t.
fn hit(path: Path, stretch: Stretch, slot: u32) -> Seen {
    let triangle = triangle_at(slot);
    let id = triangle_id(triangle);
    let v = array<real3, 3>(vertex_real(triangle.x), vertex_real(triangle.y), vertex_real(triangle.z));
    let normal = cross(v[1] - v[0], v[2] - v[0]);
    let facing = select(real(1.0), real(-1.0), triangle_reversed(triangle));
    let back_sign = select(real(0.0), facing, (triangle.w & ONE_SIDED) != 0u);
    let bit = path.item & 63u;
    var cell: Cell;
    cell.tile = (path.item >> 6u) + stretch.number * params.slab_rows * params.tiles_x;
    let meeting = pixel_depth(cell_depth(cell_bundle(cell), normal, v, back_sign, slot), cell, bit % TILE, bit / TILE);
    let is_met = meeting.visible && path.start != id && !is_excluded(id);
    let t = f32(meeting.t);
    let key = ~visibility_key(tile_layer(path.item >> 6u), meeting.t, id);
    return Seen(select(vec2<u32>(0u), key, is_met), t + 2.0 * UNIT * abs(t));
}

// What a curve meets.

#import arithmetic
#import hierarchy/nodes.wgsl
#import keys/key.wgsl
#import keys/merge
#import nodes/slabs.wgsl
#import optics/start
#import rays/curves/bundle.wgsl
#import rays/curves/coverage.wgsl
#import rays/curves/meeting.wgsl
#import rays/curves/stretch.wgsl
#import shared/params.wgsl
#import vertices/real
#import vertices/traced
#import vertices/triangle.wgsl
#import vertices/vertex

fn stretches() -> u32 {
    return params.spans;
}

fn is_seen(seen: Seen) -> bool {
    return any(seen.key != vec2<u32>(0u));
}

// Says how many hits recheck will count: none.
fn keep_seen(path: Path, seen: Seen, pixel: u32) -> u32 {
    merge(pixel, seen.key);
    return 0u;
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

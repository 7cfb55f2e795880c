// Four pixels of a column of a tile against a triangle: whether it may cover any of their samples, and its depth.

#import depth/column
#import keys/key.wgsl
#import lanes
#import nodes/conics.wgsl
#import nodes/slabs.wgsl
#import samples/depth_bounds.wgsl
#import shared/params.wgsl

var<storage, read> visibility: array<vec2<u32>>;

// No t at all, beyond that of bounds.
const NOWHERE: f32 = 3.3e38;

// An edge over the tile, in units of its error bound or go over a pixel's samples, in node units.
struct Side {
    c: vec3<f32>,       // at the centre, and slopes
    q: vec3<f32>,       // x x, x y and y y
}

fn side(k: Conic, sign: f32) -> Side {
    let s = SAMPLE_REACH * NODE_PX;
    let slopes = abs(k.x) + abs(k.y) + 2.0 * (abs(k.xx) + abs(k.xy) + abs(k.yy));
    let share = sign / (s * (slopes + s * (abs(k.xx) + abs(k.xy) + abs(k.yy))) + k.tolerance);
    // of what may overflow nothing is proven
    let fits = k.tolerance < MOST;
    return Side(
        select(vec3<f32>(0.0), share * vec3<f32>(k.c, k.x, k.y), fits),
        select(vec3<f32>(0.0), share * vec3<f32>(k.xx, k.xy, k.yy), fits),
    );
}

fn side_at(k: Side, x: f32, y: vec4<f32>) -> vec4<f32> {
    return (k.c.x + x * (k.c.y + x * k.q.x)) + y * ((k.c.z + x * k.q.y) + y * k.q.z);
}

// A triangle's values that all lanes share.
struct Bounds {
    a: Side,
    b: Side,
    c: Side,
    along: vec3<f32>,       // N . (v - P), as in Plane
    across: vec3<f32>,
    margin: vec2<f32>,        // how far each may be off, or go over a pixel's samples
    id: u32,
}

fn given_side(own: Side, place: u32) -> Side {
    return Side(subgroupShuffle(own.c, place), subgroupShuffle(own.q, place));
}

fn given_bounds(own: Bounds, k: u32) -> Bounds {
    let place = subgroup_lane(k);
    return Bounds(
        given_side(own.a, place), given_side(own.b, place), given_side(own.c, place),
        subgroupShuffle(own.along, place), subgroupShuffle(own.across, place), subgroupShuffle(own.margin, place),
        subgroupShuffle(own.id, place),
    );
}

// Of four pixels of a column: what is seen, and what is found of it.
struct Four {
    y: vec4<f32>,           // of the middles, node units
    id: vec4<u32>,
    sees: vec4<bool>,       // some triangle
    part: vec4<bool>,       // some sample has a ray
    whole: vec4<bool>,      // all samples' rays are one cell's
    far: vec4<f32>,         // all that is seen lies before, if its triangle covers all samples
    near: vec4<f32>,        // all else that may be seen lies behind
    touched: u32,           // those of which the last triangle may cover a sample, as bits
}

// Bounds a triangle over four pixels.
fn bound(q: Bounds, x: f32, before: Four) -> Four {
    var f = before;
    let a = side_at(q.a, x, f.y);
    let b = side_at(q.b, x, f.y);
    let c = side_at(q.c, x, f.y);
    let least = min(a, min(b, c));
    let most = max(a, max(b, c));
    let inside = (least > vec4<f32>(1.0)) | (most < vec4<f32>(-1.0));
    let outside = (least < vec4<f32>(-1.0)) & (most > vec4<f32>(1.0));

    // where its plane lies over the samples: as depths does
    let along = (q.along.x + x * q.along.y) + f.y * q.along.z;
    let across = (q.across.x + x * q.across.y) + f.y * q.across.z;
    let facing = select(vec4<f32>(-1.0), vec4<f32>(1.0), across > vec4<f32>(0.0));
    let steep = abs(across) - q.margin.y;
    let flat = abs(across) + q.margin.y;
    let lo = facing * along - q.margin.x;
    let hi = facing * along + q.margin.x;
    let t_near = lo / select(steep, flat, lo > vec4<f32>(0.0));
    let t_far = hi / select(flat, steep, hi > vec4<f32>(0.0));
    // NaN and infinities fail these comparisons
    let is_bounded = (steep > vec4<f32>(LEAST)) & (abs(t_near) < vec4<f32>(MOST)) & (abs(t_far) < vec4<f32>(MOST));
    let near = select(vec4<f32>(-ENDLESS), t_near - BOUND_TOLERANCE * abs(t_near), is_bounded);
    let far = select(vec4<f32>(ENDLESS), t_far + BOUND_TOLERANCE * abs(t_far), is_bounded);
    let is_out_of_range = (far < vec4<f32>(params.t_min.x)) | (near > vec4<f32>(params.t_max.x));
    let is_in_range = (near > vec4<f32>(params.t_min.x)) & (far < vec4<f32>(params.t_max.x));

    let is_seen = f.sees & (f.id == vec4<u32>(q.id));
    f.far = select(f.far, far, is_seen & inside & f.whole & is_bounded & is_in_range);
    let touched = f.part & !(outside | is_out_of_range);
    f.near = select(f.near, min(f.near, near), touched & !is_seen);
    f.touched = row_bits(touched);
    return f;
}

fn four(tile: u32, lane: u32, first: u32, part: vec2<u32>, whole: vec2<u32>) -> Four {
    let corner = tile_corner(tile);
    let rows = corner.y + first + vec4<u32>(0u, 1u, 2u, 3u);
    let at = min(rows * params.width + corner.x + lane, vec4<u32>(params.width * params.height - 1u));
    let a = visibility[at.x];
    let b = visibility[at.y];
    let c = visibility[at.z];
    let d = visibility[at.w];
    let sees = (vec4<u32>(a.x, b.x, c.x, d.x) | vec4<u32>(a.y, b.y, c.y, d.y)) != vec4<u32>(0u);
    let bits = vec4<u32>(1u, 1u << TILE, 1u << (2u * TILE), 1u << (3u * TILE)) << vec4<u32>(lane);
    let half_part = select(part.x, part.y, first != 0u);
    let half_whole = select(whole.x, whole.y, first != 0u);
    return Four(
        (vec4<f32>(0.5, 1.5, 2.5, 3.5) + f32(first)) * NODE_PX - 1.0,
        vec4<u32>(key_id(~a), key_id(~b), key_id(~c), key_id(~d)),
        sees,
        (vec4<u32>(half_part) & bits) != vec4<u32>(0u),
        (vec4<u32>(half_whole) & bits) != vec4<u32>(0u),
        select(vec4<f32>(ENDLESS), vec4<f32>(-NOWHERE), sees),
        vec4<f32>(NOWHERE),
        0u,
    );
}

// The edge pixels: what else may be seen there may lie before what is seen, or this does not cover all.
fn edge_pixels(f: Four) -> u32 {
    return row_bits(f.part & ((f.near <= f.far) | (f.far < vec4<f32>(-ENDLESS))));
}

// deposit: one thread per caustic triangle.
// Reads its corners on a receiver and its flux; adds to each texel flux in proportion to the triangle's area in the texel,
// and the flux beyond the map's border to the missed flux. Sums are whole units in two words each, so no order of
// threads changes them; the host's unit is so large that high words do not run over.

#import caustics/layout.wgsl
#import shared/items.wgsl

var<uniform> deposit_params: DepositParams;
var<storage, read> caustic_triangles: array<CausticTriangle>;
var<storage, read> receivers: array<Receiver>;
var<storage, read_write> sums: array<atomic<u32>>;

// A triangle narrower than this is a line, texels; as caustics/shares.rs has it.
const LINE_WIDTH: f32 = 1.0 / 256.0;
// And one shorter than this a point.
const POINT_SIZE: f32 = 1.0 / 1048576.0;

// Corners about `base`; of a line the first two are its ends, and `peak` is where between them the third lies.
struct Shape {
    a: vec2<f32>,
    b: vec2<f32>,
    c: vec2<f32>,
    area: f32,              // twice, signed
    is_line: bool,
    is_point: bool,
    peak: f32,
}

fn shape_of(a: vec2<f32>, b: vec2<f32>, c: vec2<f32>) -> Shape {
    // the longest side first
    let sides = vec3<f32>(distance(a, b), distance(b, c), distance(c, a));
    var s = Shape(a, b, c, 0.0, false, false, 0.0);
    if sides.y > sides.x && sides.y >= sides.z {
        s = Shape(b, c, a, 0.0, false, false, 0.0);
    } else if sides.z > sides.x {
        s = Shape(c, a, b, 0.0, false, false, 0.0);
    }
    let side = s.b - s.a;
    let third = s.c - s.a;
    s.area = side.x * third.y - side.y * third.x;
    let length = max(max(sides.x, sides.y), sides.z);
    s.is_line = abs(s.area) <= LINE_WIDTH * length;
    s.is_point = length <= POINT_SIZE;
    s.peak = clamp(dot(third, side) / max(length * length, POINT_SIZE * POINT_SIZE), 0.0, 1.0);
    return s;
}

// The mean of clamp(y, 0, 1) for y from a to b.
fn mean_within(a: f32, b: f32) -> f32 {
    let lo = min(a, b);
    let hi = max(a, b);
    if (lo >= 0.0 && hi <= 1.0) || hi - lo <= POINT_SIZE {
        return clamp(0.5 * (lo + hi), 0.0, 1.0);
    }
    let c0 = clamp(lo, 0.0, 1.0);
    let c1 = clamp(hi, 0.0, 1.0);
    return ((c1 - c0) * 0.5 * (c0 + c1) + max(0.0, hi - max(lo, 1.0))) / (hi - lo);
}

// The signed area under an edge within the unit square.
fn under(p: vec2<f32>, q: vec2<f32>) -> f32 {
    let x0 = clamp(p.x, 0.0, 1.0);
    let x1 = clamp(q.x, 0.0, 1.0);
    if x0 == x1 {
        return 0.0;
    }
    let slope = (q.y - p.y) / (q.x - p.x);
    let lo = min(p.y, q.y);
    let hi = max(p.y, q.y);
    let y0 = clamp(p.y + (x0 - p.x) * slope, lo, hi);
    let y1 = clamp(q.y + (x1 - q.x) * slope, lo, hi);
    return (x1 - x0) * mean_within(y0, y1);
}

// The flux of a flat triangle up to s of its longest side: as of one with an area, most where the third corner is.
fn up_to(s: f32, peak: f32) -> f32 {
    if s <= 0.0 {
        return 0.0;
    }
    if s >= 1.0 {
        return 1.0;
    }
    if s < peak {
        return s * s / peak;
    }
    return 1.0 - (1.0 - s) * (1.0 - s) / (1.0 - peak);
}

// The part of p + s d, s in [0, 1], whose coordinate lies in [at, at + 1).
fn within(p: f32, d: f32, at: f32) -> vec2<f32> {
    if abs(d) <= POINT_SIZE * POINT_SIZE {
        let inside = p >= at && p < at + 1.0;
        return select(vec2<f32>(1.0, 0.0), vec2<f32>(0.0, 1.0), inside);
    }
    let s = vec2<f32>(at - p, at + 1.0 - p) / d;
    return vec2<f32>(min(s.x, s.y), max(s.x, s.y));
}

// Of the shape's flux, what the texel whose corner is `at` receives.
fn share(s: Shape, at: vec2<f32>) -> f32 {
    if s.is_point {
        return select(0.0, 1.0, all(s.a >= at) && all(s.a < at + 1.0));
    }
    if s.is_line {
        let side = s.b - s.a;
        let in_x = within(s.a.x, side.x, at.x);
        let in_y = within(s.a.y, side.y, at.y);
        let from_s = max(max(in_x.x, in_y.x), 0.0);
        let to_s = min(min(in_x.y, in_y.y), 1.0);
        return select(0.0, up_to(to_s, s.peak) - up_to(from_s, s.peak), to_s > from_s);
    }
    let a = s.a - at;
    let b = s.b - at;
    let c = s.c - at;
    return clamp(2.0 * abs(under(a, b) + under(b, c) + under(c, a)) / abs(s.area), 0.0, 1.0);
}

// x of an edge's part between y and y + 1 joins the range.
fn joined(range: vec2<f32>, p: vec2<f32>, q: vec2<f32>, y: f32) -> vec2<f32> {
    if max(p.y, q.y) < y || min(p.y, q.y) > y + 1.0 {
        return range;
    }
    let d = q.y - p.y;
    var x = vec2<f32>(p.x, q.x);
    if abs(d) > POINT_SIZE {
        let s = clamp((vec2<f32>(y, y + 1.0) - p.y) / d, vec2<f32>(0.0), vec2<f32>(1.0));
        x = mix(vec2<f32>(p.x), vec2<f32>(q.x), s);
    }
    return vec2<f32>(min(range.x, min(x.x, x.y)), max(range.y, max(x.x, x.y)));
}

fn add_word(word: u32, units: u32) {
    let before = atomicAdd(&sums[word], units);
    if before + units < before {
        atomicAdd(&sums[word + 1u], 1u);
    }
}

fn add(texel: u32, units: vec3<u32>) {
    for (var k = 0u; k < 3u; k++) {
        if units[k] > 0u {
            add_word(6u * texel + 2u * k, units[k]);
        }
    }
}

@compute @workgroup_size(64)
fn deposit(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    // take a triangle
    let index = item_index(group, groups, lane);
    if index >= deposit_params.count {
        return;
    }
    let triangle = caustic_triangles[index];
    let receiver = receivers[triangle.receiver];
    let size = vec2<f32>(f32(receiver.columns), f32(receiver.rows));
    let lo = min(min(triangle.a, triangle.b), triangle.c);
    let hi = max(max(triangle.a, triangle.b), triangle.c);
    let base = floor(lo);
    let s = shape_of(triangle.a - base, triangle.b - base, triangle.c - base);
    if s.is_line {
        atomicAdd(&sums[6u * (deposit_params.texels + 1u)], 1u);
    }

    // give each texel its share
    let flux = vec3<f32>(triangle.flux);
    var left = triangle.flux;
    var most = 0.0;
    var most_texel = deposit_params.texels;
    let first = clamp(base, vec2<f32>(0.0), size);
    let end = clamp(floor(hi) + 1.0, vec2<f32>(0.0), size);
    for (var y = first.y; y < end.y; y += 1.0) {
        let row = y - base.y;
        var range = vec2<f32>(size.x - base.x, -1.0);
        range = joined(joined(joined(range, s.a, s.b, row), s.b, s.c, row), s.c, s.a, row);
        let last = min(floor(range.y) + base.x, end.x - 1.0);
        for (var x = max(floor(range.x) + base.x, first.x); x <= last; x += 1.0) {
            let part = share(s, vec2<f32>(x, y) - base);
            let texel = receiver.first + u32(y) * receiver.columns + u32(x);
            let units = min(vec3<u32>(part * flux + 0.5), left);
            left -= units;
            add(texel, units);
            if part > most {
                most = part;
                most_texel = texel;
            }
        }
    }

    // what is left is rounding, or beyond the border
    let inside = all(lo >= vec2<f32>(0.0)) && all(hi < size);
    add(select(deposit_params.texels, most_texel, inside), left);
}

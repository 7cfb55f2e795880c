// What a straight ray meets, to f32.

#import masks/holes
#import optics/start
#import rays/coverage
#import rays/straight/stretch.wgsl
#import rays/stretch
#import shared/params.wgsl
#import shared/places.wgsl
#import vertices/traced
#import vertices/triangle.wgsl
#import vertices/vertex

var<storage, read_write> recheck_items: array<vec2<u32>>;

// No hit is proven: all that may be one is left to recheck.
override ALL_UNCERTAIN: bool = false;

fn is_seen(seen: Seen) -> bool {
    return seen.slot != NONE;
}

fn stretches() -> u32 {
    return 1u;
}

// Sizes of vectors are their largest components here; |d| <= 1 and |v| <= 1. Edges are off by a unit as stored, the third by 3. m is off by
// what was lost of p, by the units of a corner, and by 2 of its size: two differences and an edge.
//
// The side on which the ray passes an edge is the sign of E = e . (d x m). A component of d x m is off by twice the sum of error_m and
// (|m| + error_m) error_d, and by 4 units of |m|. E is off by 3 |e| times that, and by 18 units of |e| |d x m|: three products, each with 3
// units of the edge and 3 of rounding.
// s = N . m / N . d. A component of N is off by 8 units of |e|^2. N . m is off by 3 |m| times that, by error_m times the sum of |N|, and by
// 3 units of |N| |m|; N . d alike. 8 units of s: a quotient, off by 2.5 ulp at most, and the sum below.
fn with_triangle(path: Path, stretch: Stretch, before: Seen, own: BvhTriangle) -> Seen {
    let m0 = own.v - stretch.p;
    let e01 = own.to_next;
    let e20 = own.from_last;
    let e12 = -(e01 + e20);
    let g0 = cross(stretch.d, m0);
    let g1 = cross(stretch.d, m0 + e01);
    let a = dot(e01, g0);
    let b = dot(e20, g0);
    let c = dot(e12, g1);
    let size_e = own.size;
    let size_m = largest_of(m0) + size_e;
    let error_m = UNIT * (CORNER_UNITS + 2.0 * size_m) + stretch.error_p;
    let error_g = 2.0 * (error_m + (size_m + error_m) * stretch.error_d)
        + UNIT * (4.0 * size_m + 6.0 * max(largest_of(g0), largest_of(g1)));
    let bound = 3.0 * size_e * error_g + LEAST;
    let low = min(a, min(b, c));
    let high = max(a, max(b, c));
    let is_inside = low > bound || high < -bound;
    let is_outside = low < -bound && high > bound;

    // where it meets the plane
    let normal = cross(e20, e01);
    let size_n = abs(normal.x) + abs(normal.y) + abs(normal.z);
    let error_n = 24.0 * UNIT * size_e * size_e + LEAST;
    let across = dot(normal, stretch.d);
    let error_across = error_n + size_n * (stretch.error_d + 3.0 * UNIT);
    let error_along = (error_n + 3.0 * UNIT * size_n) * (size_m + error_m) + size_n * error_m;
    let is_across = abs(across) > 2.0 * error_across;
    let s = dot(normal, m0) / across;
    let error_s = (error_along + abs(s) * error_across) / (abs(across) - error_across) + 8.0 * UNIT * abs(s);
    let first = select(-ENDLESS, s - error_s, is_across);
    let last = select(ENDLESS, s + error_s, is_across);

    // a face that does not show
    let is_back = is_across && (own.word & ONE_SIDED) != 0u
        && ((across < 0.0) != is_mirrored()) == triangle_reversed(vec4<u32>(own.word));
    // a triangle with an alpha mask may have a hole here
    let is_in_range = first >= stretch.inner_first && last <= stretch.inner_last;
    let is_sure = is_inside && is_across && is_in_range && is_solid(own.slot);
    return with_hit(path, stretch, before, own, first, last, is_outside || is_back, is_sure);
}

// The same with a primitive that is met between two s, if it is not missed, and that is surely met or not. What is neither the nearest nor
// out of range, nor behind what is seen, is left to recheck.
fn with_hit(
    path: Path, stretch: Stretch, before: Seen, own: BvhTriangle, first: f32, last: f32, is_missed: bool, is_sure: bool,
) -> Seen {
    let id = triangle_id(vec4<u32>(own.word));
    let may = !is_missed && last >= stretch.first && first <= last_of(stretch, before) && !is_excluded(id) && path.start != id;
    let is_met = may && is_sure && !ALL_UNCERTAIN;
    let is_nearest = is_met && last < before.first;
    var is_left = may && !is_nearest;
    // a loop: software adapters take every branch
    loop {
        if !is_left {
            break;
        }
        is_left = false;
        let at = take_places(COUNT_RECHECK_ITEMS, 1u);
        if at < params.recheck_capacity {
            recheck_items[at] = vec2<u32>(own.slot, path.item);
        }
    }
    var seen = before;
    seen.slot = select(seen.slot, own.slot, is_nearest);
    seen.first = select(seen.first, first, is_nearest);
    seen.last = select(seen.last, min(seen.last, last), is_met);
    return seen;
}

// Leaves what is seen to recheck, which finds its t, and says how many hits recheck will count.
fn keep_seen(path: Path, seen: Seen, pixel: u32) -> u32 {
    atomicAdd(&counters[COUNT_PROVEN], 1u);
    let at = take_places(COUNT_RECHECK_ITEMS, 1u);
    if at < params.recheck_capacity {
        recheck_items[at] = vec2<u32>(seen.slot | PROVEN, path.item);
    }
    return 1u;
}

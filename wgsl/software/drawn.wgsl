// A small triangle that lies in one piece, drawn pixel by pixel.

#import arithmetic
#import keys/key.wgsl
#import keys/merge
#import nodes/conics.wgsl
#import nodes/extent.wgsl
#import rays/affine_bundle.wgsl
#import rays/pieces/piece.wgsl
#import rays/straight/meeting.wgsl
#import shared/long_bits.wgsl
#import shared/params.wgsl
#import shared/recheck_items.wgsl
#import vertices/still/vertex.wgsl
#import vertices/triangle.wgsl

override COUNTING: bool = false;

// Moves no hit to an end of t_range.
const NO_TOLERANCE: real = -1.0;

// Rounding of one f32 operation, relative.
const UNIT: f32 = 1.0 / 16777216.0;

// Relative error of a stored position: 8 units of 2^-48.
const STORED_UNIT: f32 = 1.0 / 35184372088832.0;

// d x m of a corner as a quadratic in px about a centre, m = v h - p.
struct CornerMoment {
    c: vec3<f32>,
    x: vec3<f32>,
    y: vec3<f32>,
    xx: vec3<f32>,
    xy: vec3<f32>,
    yy: vec3<f32>,
    size: f32,
}

// Directions about the centre of a box.
struct BoxRays {
    d: vec3<f32>,
    dx: vec3<f32>,
    dy: vec3<f32>,
    size: f32,
}

fn corner_moment(v: real3, b: Bundle, r: BoxRays, half: vec2<f32>) -> CornerMoment {
    let m = vec3<f32>(v * b.h - b.p);
    let mx = vec3<f32>(v * b.hx - b.px);
    let my = vec3<f32>(v * b.hy - b.py);
    return CornerMoment(
        cross(r.d, m),
        cross(r.dx, m) + cross(r.d, mx),
        cross(r.dy, m) + cross(r.d, my),
        cross(r.dx, mx),
        cross(r.dx, my) + cross(r.dy, mx),
        cross(r.dy, my),
        size1(m) + half.x * size1(mx) + half.y * size1(my),
    );
}

// E = e . (d x m) over the box, in units of what rounding may be off.
struct BoxEdge {
    c: f32,
    x: f32,
    y: f32,
    xx: f32,
    xy: f32,
    yy: f32,
}

// d, m and e as rounded 1 unit each, a cross product 2, the sum of two 1, the product with e 3, Horner's scheme 8, and 1 for the scaling:
// 18 units of the sizes' product, which bounds all terms. A perturbation moves the ray by up to 2^-24 px to the right and less down: the
// sizes reach a pixel beyond the box, so d and m change by 1 unit of theirs each.
fn box_edge(e: vec3<f32>, q: CornerMoment, r: BoxRays, stored: f32) -> BoxEdge {
    let size_e = size1(e);
    let product = size_e * q.size * r.size;
    let bound = 20.0 * UNIT * product + stored * r.size * (size_e + q.size) + LEAST * (1.0 + product);
    // an edge of 0 proves nothing, and infinities times 0 would be NaN
    if product >= MOST {
        return BoxEdge(0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
    }
    let share = 1.0 / bound;
    return BoxEdge(
        share * dot(e, q.c), share * dot(e, q.x), share * dot(e, q.y),
        share * dot(e, q.xx), share * dot(e, q.xy), share * dot(e, q.yy),
    );
}

fn box_edge_at(k: BoxEdge, x: f32, y: f32) -> f32 {
    return k.c + y * (k.y + y * k.yy) + x * (k.x + y * k.xy + x * k.xx);
}

// Column and row of the n-th pixel of a box, row by row; share = 1 / width. Of up to 512 pixels: half a pixel is far more than what the
// product is off.
fn place_in_box(n: u32, width: f32, share: f32) -> vec2<f32> {
    let row = floor((f32(n) + 0.5) * share);
    return vec2<f32>(f32(n) - row * width, row);
}

// Draws the pixels of a box of the band, from its first column and row up to one past the last.
fn draw_small(slot: u32, triangle: vec4<u32>, hi: array<vec3<f32>, 3>, piece: Piece, pixels: vec4<u32>, is_small: bool) {
    let id = triangle_id(triangle);
    var lo = array<vec3<f32>, 3>(vec3<f32>(0.0), vec3<f32>(0.0), vec3<f32>(0.0));
    if is_small {
        lo = array<vec3<f32>, 3>(vertex_lo(triangle.x), vertex_lo(triangle.y), vertex_lo(triangle.z));
    }
    let v0 = real3(hi[0]) + real3(lo[0]);
    let v1 = real3(hi[1]) + real3(lo[1]);
    let v2 = real3(hi[2]) + real3(lo[2]);

    // about the centre of the box
    let half = 0.5 * vec2<f32>(pixels.zw - pixels.xy - 1u);
    let at = vec2<f32>(pixels.xy) + half - vec2<f32>(piece.origin_x, piece.origin_y);
    let b = bundle_at(piece_bundle(piece), real(at.x), real(at.y));
    let reach = half + 1.0;
    var r = BoxRays(vec3<f32>(b.d), vec3<f32>(b.dx), vec3<f32>(b.dy), 0.0);
    r.size = size1(r.d) + reach.x * size1(r.dx) + reach.y * size1(r.dy);
    let q0 = corner_moment(v0, b, r, reach);
    let q1 = corner_moment(v1, b, r, reach);
    let reach_h = abs(f32(b.h)) + reach.x * abs(f32(b.hx)) + reach.y * abs(f32(b.hy));
    let size_v = max(size1(hi[0]), max(size1(hi[1]), size1(hi[2])));
    let stored = STORED_UNIT * (size_v * (1.0 + reach_h) + q0.size);
    let e01 = box_edge(vec3<f32>(v1 - v0), q0, r, stored);
    let e20 = box_edge(vec3<f32>(v0 - v2), q0, r, stored);
    let e12 = box_edge(vec3<f32>(v2 - v1), q1, r, stored);

    // t is the ratio of two affine functions
    let normal = cross(v1 - v0, v2 - v0);
    let along = real3(dot(normal, v0 * b.h - b.p), dot(normal, v0 * b.hx - b.px), dot(normal, v0 * b.hy - b.py));
    let across = real3(dot(normal, b.d), dot(normal, b.dx), dot(normal, b.dy));
    // hits that may be moved to an end of t_range are left to recheck: twice the tolerance, for rounding
    let near_end = 2.0 * PERTURB * real(params.scene_size) * size3(normal) * real(reach_h);
    let facing = select(real(1.0), real(-1.0), triangle_reversed(triangle));
    let back_sign = select(real(0.0), facing, (triangle.w & ONE_SIDED) != 0u);

    // 64 pixels at a time, row by row
    let box_size = pixels.zw - pixels.xy;
    let count = select(1u, box_size.x * box_size.y, is_small);
    var place = -half;
    let width = f32(box_size.x);
    let share = 1.0 / width;
    let t_min = real_from_bits(params.t_words.xy);
    let t_max = real_from_bits(params.t_words.zw);
    let id_mask = (1u << params.id_bits) - 1u;
    let image_width = params.width;
    var n = 0u;
    var kept = 0u;
    loop {
        // find those that it covers
        var covered = vec2<u32>(0u);
        var uncertain = vec2<u32>(0u);
        let first = n;
        loop {
            let p = box_edge_at(e01, place.x, place.y);
            let q = box_edge_at(e20, place.x, place.y);
            let s = box_edge_at(e12, place.x, place.y);
            let least = min(p, min(q, s));
            let most = max(p, max(q, s));
            let inside = least > 1.0 || most < -1.0;
            let outside = least < -1.0 && most > 1.0;
            let bit = long_bit(n - first);
            covered |= select(vec2<u32>(0u), bit, inside);
            uncertain |= select(bit, vec2<u32>(0u), inside || outside);
            place.x += 1.0;
            if place.x > half.x {
                place = vec2<f32>(-half.x, place.y + 1.0);
            }
            n++;
            if n >= count || n >= first + 64u {
                break;
            }
        }
        if !is_small {
            covered = vec2<u32>(0u);
            uncertain = vec2<u32>(0u);
        }

        // merge the keys of these
        loop {
            let at = place_in_box(first + first_of(covered), width, share);
            let x = real(at.x - half.x);
            let y = real(at.y - half.y);
            let numerator = along.x + x * along.y + y * along.z;
            let denominator = across.x + x * across.y + y * across.z;
            let meeting = meeting_between(numerator, denominator, NO_TOLERANCE, back_sign, t_min, t_max);
            let is_at_end = min(abs(numerator - t_min * denominator), abs(numerator - t_max * denominator)) <= near_end;
            let pixel = pixels.xy + vec2<u32>(at);
            if any(covered != vec2<u32>(0u)) && meeting.visible && !is_at_end {
                merge(pixel.y * image_width + pixel.x, ~key_above(0u, meeting.t, id, id_mask));
                kept++;
            }
            let others = without_first(covered);
            uncertain |= select(vec2<u32>(0u), covered ^ others, is_at_end);
            covered = others;
            if all(covered == vec2<u32>(0u)) {
                break;
            }
        }

        // leave what is not proven
        loop {
            if all(uncertain == vec2<u32>(0u)) {
                break;
            }
            let pixel = pixels.xy + vec2<u32>(place_in_box(first + first_of(uncertain), width, share));
            uncertain = without_first(uncertain);
            let tile = (pixel.y / TILE) * params.tiles_x + pixel.x / TILE;
            leave_to_recheck(slot, tile, (pixel.y % TILE) * TILE + pixel.x % TILE, 1u);
        }
        if n >= count {
            break;
        }
    }
    if COUNTING && is_small {
        atomicAdd(&counters[COUNT_PAIRS_TESTED], 1u);
        atomicAdd(&counters[COUNT_PAIRS_KEPT], 1u);
        atomicAdd(&counters[COUNT_FRAGMENTS_TESTED], box_size.x * box_size.y);
        atomicAdd(&counters[COUNT_FRAGMENTS_KEPT], kept);
    }
}

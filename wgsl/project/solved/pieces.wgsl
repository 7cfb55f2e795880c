// The images of a point in one piece: roots of the cubic in t, each proven.

#import project/answer.wgsl
#import project/chart.wgsl
#import project/layout.wgsl
#import project/prove.wgsl
#import shared/params.wgsl

var<storage, read> pieces: array<SolvePiece>;

// Ends of t_range beyond it are none: 2^60.
const ENDLESS: f32 = 1.1529215e18;

// Flags of a piece: f32 holds its numbers; no other piece covers any of it.
const SOLVABLE: u32 = 1u;
const ALONE: u32 = 2u;

// Intervals of t that are looked at, and how often one is halved.
const INTERVALS_MOST: u32 = 96u;
const HALVINGS_MOST: u32 = 14u;

// Steps of the bracketed search for a root of the cubic.
const ROOT_STEPS: u32 = 10u;

// The root of the determinant in a bracket at whose ends its signs differ; the end with the sign of `rising` is s1's.
fn root_between(k: Chart, s0: f32, s1: f32, rising: f32) -> f32 {
    var lo = s0;
    var hi = s1;
    var s = 0.5 * (s0 + s1);
    for (var step = 0u; step < ROOT_STEPS; step++) {
        let value = rising * (k.c.x + s * (k.c.y + s * (k.c.z + s * k.c.w)));
        let slope = rising * (k.c.y + s * (2.0 * k.c.z + s * 3.0 * k.c.w));
        if value < 0.0 {
            lo = s;
        } else {
            hi = s;
        }
        let next = s - value / slope;
        s = select(0.5 * (lo + hi), next, next > lo && next < hi);
    }
    return s;
}

// Where a proven root lies: 1 in the piece, the image and the range of t; -1 outside of one of them; 0: near a border. The image, for 1.
fn placed(piece: SolvePiece, proof: Proof, unit: f32, is_far: bool, image: ptr<function, SolveImage>) -> i32 {
    let place = proof.at.xy;
    let error = max(proof.radius.x, proof.radius.y);
    var is_inside = true;
    var is_outside = false;
    for (var i = 0u; i < 4u; i++) {
        let e = piece.edges[i];
        let along = e.x * place.x + e.y * place.y + e.z;
        let margin = 1.5 * error + 8.0 * UNIT_ROUNDING * (abs(place.x) + abs(place.y) + abs(e.z));
        is_inside = is_inside && along > margin + 0.01 * piece.beyond;
        is_outside = is_outside || along < -(margin + piece.beyond);
    }

    // pixels, about the base
    let px = piece.half_px * place;
    let error_px = 1.01 * piece.half_px * error + 4.0 * UNIT_ROUNDING * max(abs(px.x), abs(px.y)) + UNDERFLOW;
    let lo = -vec2<f32>(f32(piece.base_x), f32(piece.base_y));
    let hi = vec2<f32>(f32(i32(solving.width) - piece.base_x), f32(i32(solving.height) - piece.base_y));
    let beyond_px = piece.half_px * piece.beyond;
    is_inside = is_inside && all(px - error_px > lo + 0.01 * beyond_px) && all(px + error_px < hi - 0.01 * beyond_px);
    is_outside = is_outside || any(px + error_px < lo - beyond_px) || any(px - error_px > hi + beyond_px);

    // t
    let s = proof.at.z;
    let t = select(unit * s, unit / s, is_far);
    let relative = select(proof.radius.z / abs(s), proof.radius.z / (abs(s) - proof.radius.z), is_far);
    let error_t = select(1.01 * unit * proof.radius.z, 1.01 * abs(t) * relative, is_far) + 12.0 * UNIT_ROUNDING * abs(t) + UNDERFLOW;
    let tolerance = error_t + END_TOLERANCE * max(1.0, abs(t));
    let has_start = solving.t_min > -ENDLESS;
    let has_end = solving.t_max < ENDLESS;
    let is_sane = relative >= 0.0 && abs(t) < ENDLESS;
    is_inside = is_inside && is_sane && (!has_start || t - tolerance > solving.t_min) && (!has_end || t + tolerance < solving.t_max);
    let is_late = has_end && t - tolerance > solving.t_max;
    let is_early = has_start && t + tolerance < solving.t_min;
    is_outside = is_outside || (is_sane && (is_late || is_early));

    (*image).x_px = px.x;
    (*image).y_px = px.y;
    (*image).t = t;
    (*image).error_px = error_px;
    (*image).error_t = error_t;
    (*image).pixel = select(NONE, pixel_of(px, error_px, vec2<i32>(piece.base_x, piece.base_y)), is_inside);
    return select(select(0, -1, is_outside), 1, is_inside && !is_outside);
}

// Looks at s in [start, end] of a chart, by halves.
fn search(
    piece: SolvePiece, k: Chart, start: f32, end: f32, unit: f32, is_far: bool, answer: ptr<function, Answer>,
) {
    let corners = array<vec2<f32>, 4>(
        piece.corners_01.xy, piece.corners_01.zw, piece.corners_23.xy, piece.corners_23.zw,
    );
    var level = 0u;
    var index = 0u;
    for (var looked = 0u; looked < INTERVALS_MOST; looked++) {
        let width = (end - start) / f32(1u << level);
        let s0 = start + f32(index) * width;
        let s1 = select(start + f32(index + 1u) * width, end, index + 1u == 1u << level);

        // decide the interval
        var is_done = separated(k, corners, piece.reach, s0, s1);
        if !is_done {
            let b = bernstein(k, s0, s1);
            let zero = vec4<f32>(2.0 * k.zero);
            is_done = all(b > zero) || all(b < -zero);
            let rises = b.yzw - b.xyz;
            let steep = vec3<f32>(4.0 * k.zero);
            let is_monotone = all(rises > steep) || all(rises < -steep);
            let is_crossed = min(b.x, b.w) < -zero.x && max(b.x, b.w) > zero.x;
            if !is_done && is_monotone && is_crossed {
                let root = root_between(k, s0, s1, sign(b.w));
                let proof = prove(k, root);
                let is_within = proof.at.z - proof.radius.z > s0 && proof.at.z + proof.radius.z < s1;
                if proof.is_proven && is_within {
                    var image: SolveImage;
                    let side = placed(piece, proof, unit, is_far, &image);
                    if side == 0 || (side == 1 && (*answer).count == 3u) {
                        (*answer).is_proven = false;
                        return;
                    }
                    if side == 1 {
                        (*answer).images[(*answer).count] = image;
                        (*answer).count++;
                    }
                    is_done = true;
                }
            }
        }

        // on to its first half, or past it
        if !is_done {
            if level == HALVINGS_MOST {
                break;
            }
            level++;
            index *= 2u;
            continue;
        }
        index++;
        while level > 0u && (index & 1u) == 0u {
            index /= 2u;
            level--;
        }
        if level == 0u {
            return;
        }
    }
    (*answer).is_proven = false;
}

fn solved_in(piece: SolvePiece, at: SolvePoint) -> Answer {
    var answer: Answer;
    answer.is_proven = false;
    if (piece.flags & SOLVABLE) == 0u || at.is_near == 0u {
        return answer;
    }
    let own = about(at, piece.anchor_hi, piece.anchor_lo);
    let x = own.x;
    let x_size = max_abs(x);
    let x_error = own.error;
    if !(x_size < FARTHEST) {
        return answer;
    }

    // columns, their sizes and errors; t in a unit in which both parts of the matrix are of like size
    let h = vec3<f32>(1.0, piece.h1, piece.h2);
    let q = mat3x3<f32>(piece.p0 - x, piece.p1 - x * h.y, piece.p2 - x * h.z);
    let q_size = vec3<f32>(max_abs(piece.p0), max_abs(piece.p1), max_abs(piece.p2)) + x_size * abs(h);
    let d_size = vec3<f32>(max_abs(piece.d0), max_abs(piece.d1), max_abs(piece.d2));
    let unit = (max_abs(q[0]) + max_abs(q[1]) + max_abs(q[2]) + UNIT_ROUNDING * q_size.x) / (d_size.x + d_size.y + d_size.z);
    if !(unit > 1e-6 && unit < 1e12) {
        return answer;
    }
    let d = mat3x3<f32>(unit * piece.d0, unit * piece.d1, unit * piece.d2);
    let size = 1.001 * (q_size + unit * d_size);
    let error = 5.0 * UNIT_ROUNDING * size + x_error * abs(h) + vec3<f32>(UNDERFLOW);

    // t within the unit of 0, and by 1/t what is beyond
    answer.is_proven = true;
    let t0 = solving.t_min - END_TOLERANCE * max(1.0, abs(solving.t_min));
    let t1 = solving.t_max + END_TOLERANCE * max(1.0, abs(solving.t_max));
    let near = vec2<f32>(max(t0 / unit * (1.0 - sign(t0) * END_TOLERANCE), -1.0), min(t1 / unit * (1.0 + sign(t1) * END_TOLERANCE), 1.0));
    if near.x <= near.y {
        search(piece, chart_of(q, d, error, size), near.x, near.y, unit, false, &answer);
    }
    let inverse = chart_of(d, q, error, size);
    if t1 > unit && answer.is_proven {
        let end = select((1.0 - END_TOLERANCE) * unit / t1, 0.0, solving.t_max >= ENDLESS);
        search(piece, inverse, end, select(1.0, (1.0 + END_TOLERANCE) * unit / t0, t0 > unit), unit, true, &answer);
    }
    if t0 < -unit && answer.is_proven {
        let end = select((1.0 - END_TOLERANCE) * unit / t0, 0.0, solving.t_min <= -ENDLESS);
        search(piece, inverse, select(-1.0, (1.0 + END_TOLERANCE) * unit / t1, t1 < -unit), end, unit, true, &answer);
    }
    return answer;
}

// Another piece may own the place.
fn solved_at(leaf: u32, at: SolvePoint) -> Answer {
    var answer = solved_in(pieces[leaf], at);
    answer.is_proven = answer.is_proven && (answer.count == 0u || (pieces[leaf].flags & ALONE) != 0u);
    return answer;
}

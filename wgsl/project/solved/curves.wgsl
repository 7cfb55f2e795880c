// The images of a point in one cell of a layer of curves: roots (u, v, s) of three equations, each the only one within half a pixel.
// Boxes are narrowed to where Krawczyk's operator (1969) leaves roots, and halved where it leaves them wide.

#import project/answer.wgsl
#import project/layout.wgsl

var<storage, read> cells: array<SolveCell>;

// Flags of a cell: f32 holds its numbers; a face is the image's border or an end of t.
const SOLVABLE: u32 = 1u;
const OUTER: u32 = 2u;

// How far beyond its faces a cell's terms and errors hold: 9/16 px, and 1/16 of the span.
const MARGIN: vec3<f32> = vec3<f32>(0.140625, 0.140625, 0.125);

// How far beyond an outer face the host may take a place for one in the image: 1/64 px, and as t of pieces.
const BEYOND: vec3<f32> = vec3<f32>(0.00390625, 0.00390625, 16.0 * END_TOLERANCE);

// A proven image is alone within half a pixel: the host may find two within a quarter of one as one.
const ALONE_PX: f32 = 0.5;
const CELL_PX: f32 = 4.0;

// Half a span of t.
const HALF_SPAN: f32 = 0.0625;

// Boxes that are looked at, and that wait.
const BOXES_MOST: u32 = 72u;
const WAITING_MOST: u32 = 14u;

// A box that is not this much narrower along any axis is no longer narrowed; what it is halved into overlaps by 6 %.
const NARROWER: f32 = 0.7;
const HALF: f32 = 0.53;

// Slopes whose volume is below this share of the product of their lengths are not inverted.
const FLATTEST: f32 = 1e-4;

struct Region {
    centre: vec3<f32>,
    half: vec3<f32>,
}

// All roots of a region lie within `within` of `centre + to`.
struct Look {
    to: vec3<f32>,
    within: vec3<f32>,
    // the operator's slopes over the region, times its half: it has no two roots where they are all less than its half
    slopes: vec3<f32>,
    // by which axes the slopes change, as shares of the region
    bends: vec3<f32>,
    // half a pixel, and as far along the curve
    alone: vec3<f32>,
}

fn look(leaf: u32, x: vec3<f32>, x_error: f32, region: Region) -> Look {
    // the terms about the region's centre
    let c = region.centre;
    let h = region.half;
    var p: array<vec3<f32>, 24>;
    for (var i = 0u; i < 24u; i += 4u) {
        let t1 = cells[leaf].terms[i + 1u].xyz;
        let t2 = cells[leaf].terms[i + 2u].xyz;
        let t3 = cells[leaf].terms[i + 3u].xyz;
        p[i] = cells[leaf].terms[i].xyz + c.z * (t1 + c.z * (t2 + c.z * t3));
        p[i + 1u] = t1 + c.z * (2.0 * t2 + 3.0 * c.z * t3);
        p[i + 2u] = t2 + 3.0 * c.z * t3;
        p[i + 3u] = t3;
    }
    for (var k = 0u; k < 4u; k++) {
        p[k] += c.x * (p[4u + k] + c.x * p[16u + k]) + c.y * (p[8u + k] + c.x * p[12u + k] + c.y * p[20u + k]);
        p[4u + k] += c.y * p[12u + k] + 2.0 * c.x * p[16u + k];
        p[8u + k] += c.x * p[12u + k] + 2.0 * c.y * p[20u + k];
    }

    // the slopes, and about their inverse
    let j = mat3x3<f32>(p[4], p[8], p[1]);
    let minor = mat3x3<f32>(cross(j[1], j[2]), cross(j[2], j[0]), cross(j[0], j[1]));
    let whole = dot(j[0], minor[0]);
    let lengths = vec3<f32>(length(j[0]), length(j[1]), length(j[2]));
    let is_regular = abs(whole) > FLATTEST * lengths.x * lengths.y * lengths.z;
    var r = mat3x3<f32>();
    if is_regular {
        r = mat3x3<f32>(minor[0] / whole, minor[1] / whole, minor[2] / whole);
    }
    let rows = vec3<f32>(length(r[0]), length(r[1]), length(r[2]));

    // what r times the slopes is off 1, and r times all other terms over the region
    var linear = vec3<f32>(0.0);
    for (var i = 0u; i < 3u; i++) {
        var unit = vec3<f32>(0.0);
        unit[i] = 1.0;
        linear[i] = dot(abs(unit - vec3<f32>(dot(r[i], j[0]), dot(r[i], j[1]), dot(r[i], j[2]))), h);
    }
    var found: Look;
    found.within = linear;
    found.slopes = linear;
    let powers = array<vec2<f32>, 6>(
        vec2<f32>(0.0), vec2<f32>(1.0, 0.0), vec2<f32>(0.0, 1.0), vec2<f32>(1.0), vec2<f32>(2.0, 0.0), vec2<f32>(0.0, 2.0),
    );
    let places = array<f32, 6>(1.0, h.x, h.y, h.x * h.y, h.x * h.x, h.y * h.y);
    var degrees = h.x + h.y + h.z;
    for (var i = 0u; i < 6u; i++) {
        var share = places[i];
        for (var k = 0u; k < 4u; k++) {
            let power = vec3<f32>(powers[i], f32(k));
            let degree = power.x + power.y + power.z;
            if degree > 1.0 {
                let term = p[4u * i + k];
                let bent = share * abs(vec3<f32>(dot(r[0], term), dot(r[1], term), dot(r[2], term)));
                found.within += bent;
                found.slopes += degree * bent;
                degrees += degree * share;
                let most = max(bent.x / h.x, max(bent.y / h.y, bent.z / h.z));
                found.bends += most * power;
            }
            share *= h.z;
        }
    }

    // Each term is within 32 roundings of all together, and its product with r within 8 more. The value is 24 roundings of them and of the
    // point off.
    let size = cells[leaf].size;
    let errors = cells[leaf].errors;
    let blur = 64.0 * UNIT_ROUNDING * size * degrees;
    let error = 32.0 * UNIT_ROUNDING * (size + length(x)) + 1.8 * x_error + errors.x;
    let f = p[0] - x;
    found.to = -vec3<f32>(dot(r[0], f), dot(r[1], f), dot(r[2], f));
    found.within = 1.01 * (found.within + rows * (blur + error)) + vec3<f32>(8.0 * UNIT_ROUNDING);
    found.slopes = 1.01 * (found.slopes + rows * (blur + dot(errors.yzw, h)));
    let px = ALONE_PX / CELL_PX;
    found.alone = vec3<f32>(px, px, px * max(lengths.x, lengths.y) / max(lengths.z, 1e-30));
    if !is_regular {
        found.bends = h;
    }
    return found;
}

// What of a region the operator leaves; nothing where a half is negative.
fn narrowed(region: Region, seen: Look) -> Region {
    let lo = max(region.centre - region.half, region.centre + seen.to - seen.within);
    let hi = min(region.centre + region.half, region.centre + seen.to + seen.within);
    let slack = select(vec3<f32>(0.0), vec3<f32>(4.0 * UNIT_ROUNDING), hi >= lo);
    return Region(0.5 * (lo + hi), 0.5 * (hi - lo) * (1.0 + 4.0 * UNIT_ROUNDING) + slack);
}

// No place of the region is one of the cell, nor taken for one by the host.
fn is_outside(leaf: u32, region: Region) -> bool {
    let flags = cells[leaf].flags;
    let low = (vec3<u32>(flags) & (vec3<u32>(OUTER) << vec3<u32>(0u, 1u, 2u))) != vec3<u32>(0u);
    let high = (vec3<u32>(flags) & (vec3<u32>(OUTER) << vec3<u32>(3u, 4u, 5u))) != vec3<u32>(0u);
    let lo = vec3<f32>(-1.0) - select(vec3<f32>(0.0), BEYOND, low);
    let hi = vec3<f32>(cells[leaf].end, 1.0) + select(vec3<f32>(0.0), BEYOND, high);
    return any(region.centre + region.half < lo) || any(region.centre - region.half > hi);
}

// The image of a proven root that the region holds.
fn image_at(leaf: u32, region: Region) -> SolveImage {
    var image: SolveImage;
    let px = CELL_PX * region.centre.xy;
    image.x_px = px.x;
    image.y_px = px.y;
    image.error_px = 1.01 * CELL_PX * max(region.half.x, region.half.y) + 4.0 * UNIT_ROUNDING * CELL_PX;
    image.t = cells[leaf].middle + HALF_SPAN * region.centre.z;
    image.error_t = 1.01 * HALF_SPAN * region.half.z + 2.0 * UNIT_ROUNDING;
    image.pixel = pixel_of(px, image.error_px, vec2<i32>(cells[leaf].base_x, cells[leaf].base_y));
    return image;
}

fn solved_at(leaf: u32, at: SolvePoint) -> Answer {
    var answer: Answer;
    answer.is_proven = false;
    let flags = cells[leaf].flags;
    if (flags & SOLVABLE) == 0u || at.is_near == 0u {
        return answer;
    }
    // the point about the cell's anchor; all curves are within the size of it
    let own = about(at, cells[leaf].anchor_hi, cells[leaf].anchor_lo);
    let far = length(own.x);
    if far > 1.01 * cells[leaf].size + cells[leaf].errors.x + 2.0 * own.error {
        answer.is_proven = true;
        return answer;
    }
    if !(far <= 4.0 * cells[leaf].size) {
        return answer;
    }

    let lo = vec3<f32>(-1.0) - MARGIN;
    let hi = vec3<f32>(cells[leaf].end, 1.0) + MARGIN;
    var waiting: array<Region, WAITING_MOST>;
    waiting[0] = Region(0.5 * (lo + hi), 0.5 * (hi - lo));
    var count = 1u;
    var known: array<Region, 3>;
    for (var looked = 0u; looked < BOXES_MOST; looked++) {
        if count == 0u {
            answer.is_proven = true;
            return answer;
        }

        // narrow a region
        let region = waiting[count - 1u];
        let seen = look(leaf, own.x, own.error, region);
        let rest = narrowed(region, seen);
        if any(rest.half < vec3<f32>(0.0)) || is_outside(leaf, rest) {
            count--;
            continue;
        }
        if any(rest.half < NARROWER * region.half) {
            waiting[count - 1u] = rest;
            continue;
        }

        // halve it where the slopes change most
        if any(rest.half > 0.5 * seen.alone) {
            if count == WAITING_MOST {
                return answer;
            }
            let b = seen.bends;
            var by = vec3<f32>(0.0);
            let axis = select(select(2u, 1u, b.y > b.z), 0u, b.x > max(b.y, b.z));
            by[axis] = 1.0;
            let half = select(rest.half, HALF * rest.half, by > vec3<f32>(0.0));
            let apart = (1.0 - HALF) * by * rest.half;
            waiting[count - 1u] = Region(rest.centre + apart, half);
            waiting[count] = Region(rest.centre - apart, half);
            count++;
            continue;
        }

        // prove that there is one root in all that is near
        let near = Region(rest.centre, seen.alone);
        let all_of_it = look(leaf, own.x, own.error, near);
        let is_within = all(near.centre - near.half > lo) && all(near.centre + near.half < hi);
        let is_there = all(abs(all_of_it.to) + all_of_it.within < 0.99 * near.half);
        let is_one = all(all_of_it.slopes < 0.99 * near.half);
        if !(is_within && is_there && is_one) {
            return answer;
        }
        var root = narrowed(near, all_of_it);
        for (var step = 0u; step < 3u; step++) {
            root = narrowed(root, look(leaf, own.x, own.error, root));
        }

        // it may have been found before, or be another cell's
        var is_new = true;
        for (var k = 0u; k < answer.count; k++) {
            let off = abs(root.centre - known[k].centre);
            let is_same = all(off + root.half < known[k].half);
            if !is_same && !any(off - root.half > known[k].half) {
                return answer;
            }
            is_new = is_new && !is_same;
        }
        if is_new && !is_outside(leaf, root) {
            let is_inside = all(root.centre - root.half > vec3<f32>(-1.0))
                && all(root.centre + root.half < vec3<f32>(cells[leaf].end, 1.0));
            if !is_inside || answer.count == 3u {
                return answer;
            }
            answer.images[answer.count] = image_at(leaf, root);
            known[answer.count] = near;
            answer.count++;
        }
        count--;
    }
    return answer;
}

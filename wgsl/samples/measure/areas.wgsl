// Visible area, in the pixel, of each triangle that a sample sees. Edges are taken as lines at the signed distance b / |grad b| from the
// centre, b the hit's weight that is 0 there: exact for two surfaces with straight edges, one behind the other, that rays meet at a constant
// N . D. With three, the area that two of them hide is subtracted
// twice. Where samples contradict the lines (a curved edge, an intersection), or more triangles are seen than are kept, samples are
// counted instead.

#import keys/key.wgsl
#import rays/pixel
#import rays/sample_ray
#import resolve.wgsl
#import samples/cells.wgsl
#import samples/offsets.wgsl
#import samples/shaded_part
#import shared/params.wgsl
#import vertices/vertex
#import vertices/weights.wgsl

var<storage, read> slot_of_id: array<u32>;

// Most triangles kept per pixel, the background among them.
const KEPT_MAX: u32 = 6u;

// Of those seen in a pixel, in the order of their first samples: the samples that see each.
var<private> groups: array<u32, KEPT_MAX>;
var<private> count: u32;

// And the area of each; none where samples are counted.
var<private> shares: array<f32, KEPT_MAX>;
var<private> measured: bool;

// Per edge: the unit inward normal, px right and down, and the signed distance of the pixel's centre inside it.
var<private> edge_lines: array<vec3<f32>, 18>;

fn share_of(k: u32, some: u32) -> f32 {
    return select(f32(countOneBits(some)), shares[min(k, KEPT_MAX - 1u)], measured);
}

// The samples that see what the first of those left does, the k-th of all that is seen.
fn seen_next(k: u32, record: u32, left: u32) -> u32 {
    if k < count {
        return groups[k];
    }
    return seen_alike(record, left);
}

// The sum of all shares.
fn whole() -> f32 {
    return select(f32(SAMPLES), 1.0, measured);
}

fn measure(pixel: u32, record: u32) {
    measured = false;
    count = 0u;
    var nothing = KEPT_MAX;
    var left = all_samples();
    while left != 0u {
        if count == KEPT_MAX {
            return;
        }
        let some = seen_alike(record, left);
        groups[count] = some;
        left &= ~some;
        count += 1u;
    }

    for (var k = 0u; k < count; k++) {
        let n = nearest_to(part_of(groups[k]).middle, groups[k]);
        if all(key_of(record, n) == vec2<u32>(0u)) {
            nothing = k;
        } else if !find_lines(k, pixel, record, n) {
            return;
        }
    }

    // test the samples against all of them
    var covered: array<u32, KEPT_MAX>;
    for (var k = 0u; k < count; k++) {
        covered[k] = select(inside(k), 0u, k == nothing);
        let uncovered = select(groups[k] & ~covered[k], 0u, k == nothing);
        if uncovered != 0u || (nothing != KEPT_MAX && (covered[k] & groups[nothing]) != 0u) {
            return;
        }
    }

    // take what lies before others off them: a sample that sees one where the other is too says which does
    for (var k = 0u; k < count; k++) {
        shares[k] = select(common_area(k, k), 0.0, k == nothing);
    }
    for (var a = 1u; a < count; a++) {
        for (var b = 0u; b < a; b++) {
            let a_before = (covered[b] & groups[a]) != 0u;
            let b_before = (covered[a] & groups[b]) != 0u;
            if a_before && b_before {
                return;
            }
            if a_before || b_before {
                shares[select(a, b, a_before)] -= common_area(a, b);
            }
        }
    }

    // give the rest to the background, or else to the triangles whose share of the samples exceeds their area
    var sum = 0.0;
    for (var k = 0u; k < count; k++) {
        shares[k] = max(shares[k], 0.0);
        sum += shares[k];
    }
    if nothing != KEPT_MAX {
        shares[nothing] = max(1.0 - sum, 0.0);
        sum += shares[nothing];
    }
    let missing = 1.0 - sum;
    var short = 0.0;
    for (var k = 0u; k < count; k++) {
        short += max(sign(missing) * off_count(k, groups[k]), 0.0);
    }
    if short > 0.0 {
        for (var k = 0u; k < count; k++) {
            shares[k] += missing * max(sign(missing) * off_count(k, groups[k]), 0.0) / short;
        }
    }
    measured = true;
}

// Excess of the samples that see a triangle over its area.
fn off_count(k: u32, some: u32) -> f32 {
    return f32(countOneBits(some)) / f32(SAMPLES) - shares[k];
}

// The edge lines of a triangle about the pixel's centre; false if it is seen edge-on.
fn find_lines(k: u32, pixel: u32, record: u32, sample: u32) -> bool {
    let key = ~key_of(record, sample);
    let x = pixel % params.width;
    let y = pixel / params.width;
    let ray = sample_ray(key_layer(key), x, y, sample);
    let differential = sample_differential(key_layer(key), x, y, sample, key_t(key));
    let w = weights_at(triangle_at(slot_of_id[key_id(key) - params.id_first]), point_at(ray, key_t(key)), ray.d, differential);
    let steep = sqrt(w.right * w.right + w.down * w.down);
    let own = sample_offset(sample);
    let centre = w.at - own.x * w.right - own.y * w.down;
    for (var e = 0u; e < 3u; e++) {
        edge_lines[3u * k + e] = vec3<f32>(w.right[e], w.down[e], centre[e]) / steep[e];
    }
    return all(steep > vec3<f32>(0.0)) && all(steep < vec3<f32>(1e30));
}

// The samples inside a triangle.
fn inside(k: u32) -> u32 {
    let first = edge_lines[3u * k];
    let second = edge_lines[3u * k + 1u];
    let third = edge_lines[3u * k + 2u];
    var found = 0u;
    for (var n = 0u; n < SAMPLES; n++) {
        let place = vec3<f32>(sample_offset(n), 1.0);
        let least = min(dot(first, place), min(dot(second, place), dot(third, place)));
        found |= select(0u, 1u << n, least >= 0.0);
    }
    return found;
}

// Sides of the pixel, and of one triangle or two.
fn side_of(i: u32, a: u32, b: u32) -> vec3<f32> {
    if i < 4u {
        let sense = select(1.0, -1.0, (i & 1u) == 1u);
        return vec3<f32>(select(vec2<f32>(sense, 0.0), vec2<f32>(0.0, sense), i >= 2u), 0.5);
    }
    return edge_lines[select(3u * a + i - 4u, 3u * b + i - 7u, i >= 7u)];
}

// Lines at a smaller angle are treated as parallel, which moves an area by less.
const PARALLEL: f32 = 1e-4;

// The area that two triangles both have of the pixel, or that one has: half the sum over all sides of how long each is, inside of all
// others, times how far inside of it the centre is.
fn common_area(a: u32, b: u32) -> f32 {
    let count = select(10u, 7u, a == b);
    var sum = 0.0;
    for (var i = 0u; i < count; i++) {
        let own = side_of(i, a, b);
        // along it, px from where it is nearest to the centre
        var first = -1.0;
        var last = 1.0;
        for (var j = 0u; j < count; j++) {
            let other = side_of(j, a, b);
            let alike = dot(own.xy, other.xy);
            let slope = own.x * other.y - own.y * other.x;
            if abs(slope) > PARALLEL {
                let crossing = (own.z * alike - other.z) / slope;
                first = select(first, max(first, crossing), slope > 0.0);
                last = select(last, min(last, crossing), slope < 0.0);
            } else if i != j {
                // of two that are one the first counts
                let gap = other.z - own.z * sign(alike);
                let is_inside = gap > 0.0 || (gap == 0.0 && (alike < 0.0 || i < j));
                last = select(-1.0, last, is_inside);
            }
        }
        sum += own.z * max(last - first, 0.0);
    }
    return 0.5 * sum;
}

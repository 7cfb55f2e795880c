// What a curve meets where there are spheres too: the first root of |X(t) - c|^2 - r^2 over a span of t, a polynomial of twice the curve's
// degree, in recheck arithmetic.
// Provides: with_primitive
// Needs: BvhTriangle, Curve, DEGREE, LEAST, ONE_SIDED, Path, REAL_UNIT, Seen, Sphere, Stretch, TILE, UNIT, curve_place, curve_stored,
//   is_excluded, is_sphere, real, real3, size3, sphere_of, tile_corner, tile_layer, triangle_at, triangle_id, visibility_key, with_triangle
// Binds: params

fn with_primitive(path: Path, stretch: Stretch, before: Seen, own: BvhTriangle) -> Seen {
    if is_sphere(vec4<u32>(own.word)) {
        return with_sphere(path, stretch, before, own);
    }
    return with_triangle(path, stretch, before, own);
}

// The stretch is within its slack of a chord: a sphere farther away from that is not met. A component of m is off by a unit for each
// coordinate and 2 of itself, one of d x m by twice that and 6 units of |m|, as |d| is no larger than the way from end to end.
fn with_sphere(path: Path, stretch: Stretch, before: Seen, own: BvhTriangle) -> Seen {
    let m = own.v - stretch.p;
    let size_d = length(stretch.d);
    let reach = own.to_next.x + length(stretch.slack) + 24.0 * UNIT * (2.0 + length(m)) + LEAST;
    var may = length(cross(stretch.d, m)) <= 1.0001 * reach * size_d + LEAST;
    var seen = before;
    // a loop: software adapters take every branch
    loop {
        if !may {
            break;
        }
        may = false;
        let here = sphere_hit(path, stretch, triangle_at(own.slot));
        let is_nearer = here.key.y > seen.key.y || (here.key.y == seen.key.y && here.key.x > seen.key.x);
        seen.key = select(seen.key, here.key, is_nearer);
        seen.t = select(seen.t, here.t, is_nearer);
    }
    return seen;
}

fn sphere_hit(path: Path, stretch: Stretch, triangle: vec4<u32>) -> Seen {
    let id = triangle_id(triangle);
    let tile = path.item >> 6u;
    let bit = path.item & 63u;
    let corner = tile_corner(tile);
    let c = curve_stored(curve_place(tile_layer(tile), corner.x + bit % TILE, corner.y + bit / TILE));
    let spans = real(f32(params.spans));
    let from_t = real(f32(stretch.number)) / spans;
    let to_t = real(f32(stretch.number + 1u)) / spans;
    let root = first_root(height_of(c, sphere_of(triangle)), from_t, to_t, (triangle.w & ONE_SIDED) == 0u);
    let is_met = root.is_there && path.start != id && !is_excluded(id);
    let t = f32(root.t);
    let key = ~visibility_key(tile_layer(tile), root.t, id);
    return Seen(select(vec2<u32>(0u), key, is_met), t + 2.0 * UNIT * abs(t));
}

// |X(t) - c|^2 - r^2 in Bernstein form, and how far from 0 its values may be where it is 0.
struct Height {
    b: array<real, 7>,
    zero: real,
}

// Bernstein polynomials of degree m times each other are those of degree 2m times a ratio of binomials.
fn height_of(c: Curve, s: Sphere) -> Height {
    let o = array<real3, 4>(c.c0 - s.centre, c.c1 - s.centre, c.c2 - s.centre, c.c3 - s.centre);
    var h: Height;
    for (var j = 0u; j <= 2u * DEGREE; j++) {
        var sum = real(0.0);
        for (var i = 0u; i <= DEGREE; i++) {
            if i <= j && j - i <= DEGREE {
                sum += real(choose(DEGREE, i) * choose(DEGREE, j - i)) * dot(o[i], o[j - i]);
            }
        }
        h.b[j] = sum / real(choose(2u * DEGREE, j)) - s.radius * s.radius;
    }
    // an offset is off by 2 units of what was subtracted, its square by 4 of that, and a sum of squares and r^2 by as many
    let sizes = size3(s.centre) + s.radius + max(max(size3(c.c0), size3(c.c1)), max(size3(c.c2), size3(c.c3)));
    h.zero = 16.0 * REAL_UNIT * sizes * sizes;
    return h;
}

fn choose(n: u32, k: u32) -> f32 {
    var c = 1.0;
    for (var j = 0u; j < k; j++) {
        c = c * f32(n - j) / f32(j + 1u);
    }
    return c;
}

// The coefficients over a part of [0, 1]: blossoms, each with the one end as often as the other is not.
fn over_part(b: array<real, 7>, from_t: real, to_t: real) -> array<real, 7> {
    var part: array<real, 7>;
    for (var k = 0u; k <= 2u * DEGREE; k++) {
        var row = b;
        for (var n = 2u * DEGREE; n > 0u; n--) {
            let t = select(from_t, to_t, n <= k);
            for (var j = 0u; j < n; j++) {
                row[j] += t * (row[j + 1u] - row[j]);
            }
        }
        part[k] = row[0];
    }
    return part;
}

struct Root {
    t: real,
    is_there: bool,
}

// Halvings of a span at most. A pair of roots nearer to each other than this is none: the curve touches the sphere at most.
const HALVINGS: u32 = 24u;

// Parts looked at, at most: of a polynomial of degree 6 no more than seven can be neither without a root nor monotone at each level.
const PARTS: u32 = 400u;

// The first root where the sphere is entered, or left and its back seen. A root within rounding of an end counts as on it, as the next span
// or layer begins there. Parts are halved until the coefficients keep off 0, or are all in order: then there is one root or none.
fn first_root(h: Height, from_t: real, to_t: real, two_sided: bool) -> Root {
    var depth = 0u;
    var number = 0u;
    var is_over = false;
    for (var k = 0u; k < PARTS; k++) {
        let width = (to_t - from_t) / real(f32(1u << depth));
        let lo = from_t + real(f32(number)) * width;
        let part = over_part(h.b, lo, lo + width);
        var least = part[0];
        var most = part[0];
        var falls = true;
        var rises = true;
        for (var j = 1u; j <= 2u * DEGREE; j++) {
            least = min(least, part[j]);
            most = max(most, part[j]);
            falls = falls && part[j] <= part[j - 1u];
            rises = rises && part[j] >= part[j - 1u];
        }
        let first = part[0];
        let last = part[2u * DEGREE];
        if number == 0u && abs(first) <= h.zero && (two_sided || last < first) {
            return Root(from_t, true);
        }
        let keeps_off = least > 0.0 || most < 0.0;
        if !keeps_off && !falls && !rises && depth < HALVINGS {
            depth++;
            number *= 2u;
            continue;
        }
        let enters = first > 0.0 && last <= 0.0;
        let leaves = first < 0.0 && last >= 0.0;
        if !keeps_off && (enters || (leaves && two_sided)) {
            return Root(root_of(h.b, lo, lo + width, leaves), true);
        }
        // the next part that does not begin one of those before it
        number++;
        while depth > 0u && (number & 1u) == 0u {
            number >>= 1u;
            depth--;
        }
        if depth == 0u && number > 0u {
            return Root(to_t, abs(last) <= h.zero && (two_sided || last < first));
        }
    }
    return Root(to_t, false);
}

// Halving takes a part of [0, 1] to the last bit.
const ROOT_HALVINGS: u32 = 56u;

fn root_of(b: array<real, 7>, from_t: real, to_t: real, rises: bool) -> real {
    var lo = from_t;
    var hi = to_t;
    for (var k = 0u; k < ROOT_HALVINGS; k++) {
        let t = 0.5 * (lo + hi);
        var row = b;
        for (var n = 2u * DEGREE; n > 0u; n--) {
            for (var j = 0u; j < n; j++) {
                row[j] += t * (row[j + 1u] - row[j]);
            }
        }
        let is_before = (row[0] < 0.0) == rises;
        lo = select(lo, t, is_before);
        hi = select(t, hi, is_before);
    }
    return 0.5 * (lo + hi);
}

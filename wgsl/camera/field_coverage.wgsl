// What a triangle covers of a cell, ray by ray, and how deep.

// What is covered is proven to be; else it may be covered.
const COVERAGE_PROVES: bool = true;

// Rounding of one f32 operation, relative.
const UNIT: f32 = 1.0 / 16777216.0;

// Coverage of the owned pixels of the cell: two words of proven pixels, then two of pixels whose signs are not proven.
fn coverage(
    cell: Cell,
    owned: vec2<u32>,
    from_px: vec2<u32>,
    to_px: vec2<u32>,
    v0: vec3<f32>,
    v1: vec3<f32>,
    v2: vec3<f32>,
) -> vec4<u32> {
    var covered = vec2<u32>(0u);
    var doubtful = vec2<u32>(0u);
    let corner = tile_corner(cell.tile);
    var left = owned;
    loop {
        let bit = first_bit(left);
        if bit == NONE {
            break;
        }
        left = without_bit(left, bit);
        let at = field_at(corner.x + bit % TILE, corner.y + bit / TILE);
        let p = field_origin(at);
        let d = field_direction(at);
        // m: stored v and p and a difference, 3 units of what was subtracted; d: 1 unit; cross product: 3 units;
        // e: 4 units of reach and 1 of |e|; dot product: 3 units
        let m0 = v0 - p;
        let m1 = v1 - p;
        let g0 = cross(d, m0);
        let g1 = cross(d, m1);
        let lost = 4.0 * (params.vertex_reach + length(p));
        let round0 = UNIT * length(d) * (6.0 * length(m0) + lost);
        let round1 = UNIT * length(d) * (6.0 * length(m1) + lost);
        let b01 = field_bound(v1 - v0, g0, round0);
        let b20 = field_bound(v0 - v2, g0, round0);
        let b12 = field_bound(v2 - v1, g1, round1);
        let a = dot(v1 - v0, g0);
        let b = dot(v0 - v2, g0);
        let c = dot(v2 - v1, g1);
        let all_in = (a > b01 && b > b20 && c > b12) || (a < -b01 && b < -b20 && c < -b12);
        let some_up = a > b01 || b > b20 || c > b12;
        let some_down = a < -b01 || b < -b20 || c < -b12;
        if all_in {
            covered = with_bit(covered, bit);
        } else if !(some_up && some_down) {
            doubtful = with_bit(doubtful, bit);
        }
    }
    return vec4<u32>(covered, doubtful);
}

fn field_bound(e: vec3<f32>, g: vec3<f32>, rounding: f32) -> f32 {
    return length(e) * rounding + UNIT * (4.0 * params.vertex_reach + 5.0 * length(e)) * length(g);
}

// What N . (v - P) and N . D need: their ratio is t.
struct CellDepth {
    normal: real3,
    v: real3,
    hidden: real,
}

fn cell_depth(whole: Bundle, normal: real3, v: array<real3, 3>, hidden: real) -> CellDepth {
    return CellDepth(normal, v[0], hidden);
}

fn pixel_depth(q: CellDepth, cell: Cell, x: u32, y: u32) -> Meeting {
    let corner = tile_corner(cell.tile);
    let at = field_at(corner.x + x, corner.y + y);
    let across = dot(q.normal, field_direction_real(at));
    return ray_meeting(dot(q.normal, q.v - field_origin_real(at)), across, 0.0, q.hidden);
}

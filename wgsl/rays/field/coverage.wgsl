// What a triangle covers of a cell, ray by ray, and how deep.

#import arithmetic
#import masks/there
#import nodes/slabs.wgsl
#import rays/affine_bundle.wgsl
#import rays/field/bundle.wgsl
#import rays/field/table.wgsl
#import rays/meeting.wgsl
#import rays/straight/meeting.wgsl
#import rays/straight/plane_tolerance.wgsl
#import shared/bits.wgsl
#import shared/params.wgsl

// Coverage is proven if true; else it is possible.
const COVERAGE_PROVES: bool = true;

// Rounding of one f32 operation, relative.
const UNIT: f32 = 1.0 / 16777216.0;

// Error of results below the least normal number, which an adapter may flush to 0: 2^-126 an operation, of hundreds of them.
const LEAST: f32 = 1.0e-35;

// Sums of products of sizes beyond this may overflow: a bound on them becomes infinite, and nothing is proven.
const MOST: f32 = 1.0e36;

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
    var uncertain = vec2<u32>(0u);
    let corner = tile_corner(cell.tile);
    let r0 = length(v0);
    let r1 = length(v1);
    let r2 = length(v2);
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
        // e: 2 units of both vertices and 1 of |e|; dot product: 3 units; and the perturbation of the ray
        let m0 = v0 - p;
        let m1 = v1 - p;
        let g0 = cross(d, m0);
        let g1 = cross(d, m1);
        let perturb0 = PERTURB_BOUND * length(d) * (length(m0) + params.scene_size);
        let perturb1 = PERTURB_BOUND * length(d) * (length(m1) + params.scene_size);
        let round0 = UNIT * length(d) * (6.0 * length(m0) + 4.0 * (r0 + length(p))) + perturb0 + LEAST * (1.0 + length(d));
        let round1 = UNIT * length(d) * (6.0 * length(m1) + 4.0 * (r1 + length(p))) + perturb1 + LEAST * (1.0 + length(d));
        let b01 = field_bound(v1 - v0, r0 + r1, g0, round0);
        let b20 = field_bound(v0 - v2, r0 + r2, g0, round0);
        let b12 = field_bound(v2 - v1, r1 + r2, g1, round1);
        let a = dot(v1 - v0, g0);
        let b = dot(v0 - v2, g0);
        let c = dot(v2 - v1, g1);
        let all_in = (a > b01 && b > b20 && c > b12) || (a < -b01 && b < -b20 && c < -b12);
        let some_up = a > b01 || b > b20 || c > b12;
        let some_down = a < -b01 || b < -b20 || c < -b12;
        if all_in {
            covered = with_bit(covered, bit);
        } else if !(some_up && some_down) {
            uncertain = with_bit(uncertain, bit);
        }
    }
    return vec4<u32>(covered, uncertain);
}

fn field_bound(e: vec3<f32>, sizes: f32, g: vec3<f32>, rounding: f32) -> f32 {
    let bound = length(e) * rounding + UNIT * (2.0 * sizes + 5.0 * length(e)) * length(g) + LEAST * (1.0 + length(g));
    return bound * select(MOST, 1.0, length(e) * length(g) < MOST);
}

// What N . (v - P) and N . D need: their ratio is t.
struct CellDepth {
    normal: real3,
    v: array<real3, 3>,
    back_sign: real,
    slot: u32,
}

fn cell_depth(whole: Bundle, normal: real3, v: array<real3, 3>, back_sign: real, slot: u32) -> CellDepth {
    return CellDepth(normal, v, back_sign, slot);
}

fn pixel_depth(q: CellDepth, cell: Cell, x: u32, y: u32) -> Meeting {
    let corner = tile_corner(cell.tile);
    let at = field_at(corner.x + x, corner.y + y);
    let b = cell_bundle_at(at);
    let across = dot(q.normal, b.d);
    let along = dot(q.normal, q.v[0] - b.p);
    var meeting = ray_meeting(b, q.v, q.normal, along, across, plane_tolerance(q.normal, b.d, across), q.back_sign);
    meeting.visible = meeting.visible && is_there(q.slot, b);
    return meeting;
}

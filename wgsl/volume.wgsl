// volume: one thread per pixel of the band, once its surface and the lines on it are drawn.
// Reads the pixel's path up to the surface that the visibility buffer names, and the cells of the grid that it passes, front to back;
// puts the light of the volume over the colour planes, and adds what it hides to the coverage.

#import arithmetic
#import keys/key.wgsl
#import keys/pixel
#import rays/legs
#import rays/pixel
#import shared/items.wgsl
#import shared/params.wgsl
#import shared/planes.wgsl
#import volume/layout.wgsl
#import volume/light
#import volume/passed

// Below and above all t.
const FAR: f32 = 3.0e38;

// Least part of the way through a cell, 2^-20.
const LEAST_WIDTH: f32 = 1.0 / 1048576.0;

// Rounds over a leg's cells and their parts at most: software drivers end all loops of a thread after 65535.
const ROUNDS: u32 = 60000u;

fn grid_direction(d: real3) -> real3 {
    return real3(
        dot(real3(medium.x_hi) + real3(medium.x_lo), d),
        dot(real3(medium.y_hi) + real3(medium.y_lo), d),
        dot(real3(medium.z_hi) + real3(medium.z_lo), d),
    );
}

fn grid_place(p: real3) -> real3 {
    let hi = vec3<f32>(medium.x0_hi, medium.y0_hi, medium.z0_hi);
    let lo = vec3<f32>(medium.x0_lo, medium.y0_lo, medium.z0_lo);
    return grid_direction(p) + (real3(hi) + real3(lo));
}

// 1 over each component; 1 where it is 0.
fn inverse_of(d: vec3<f32>) -> vec3<f32> {
    return 1.0 / select(d, vec3<f32>(1.0), d == vec3<f32>(0.0));
}

// The t in a range between which a line p + t d is in the grid; the first is the larger one where there are none.
fn within_grid(p: vec3<f32>, d: vec3<f32>, first: f32, last: f32) -> vec2<f32> {
    let to_first = -p * inverse_of(d);
    let to_last = (medium.last - p) * inverse_of(d);
    let is_across = d == vec3<f32>(0.0);
    let is_inside = (p >= vec3<f32>(0.0)) & (p <= medium.last);
    let enters = select(min(to_first, to_last), select(vec3<f32>(FAR), vec3<f32>(-FAR), is_inside), is_across);
    let leaves = select(max(to_first, to_last), select(vec3<f32>(-FAR), vec3<f32>(FAR), is_inside), is_across);
    return vec2<f32>(
        max(max(enters.x, first), max(enters.y, enters.z)),
        min(min(leaves.x, last), min(leaves.y, leaves.z)),
    );
}

// The place at t of a leg, one coordinate after the other: f64 in 32-bit words takes vectors in loops, whose rounds count too.
fn leg_place(leg: Leg, t: real) -> vec3<f32> {
    return vec3<f32>(
        f32(leg.start.x + t * leg.along.x),
        f32(leg.start.y + t * leg.along.y),
        f32(leg.start.z + t * leg.along.z),
    );
}

// What has passed after a leg too. Each cell's way is cut into parts by halving, until `take` takes them.
fn through(leg: Leg, before: Passed) -> Passed {
    // from about where it enters
    let d = vec3<f32>(leg.along);
    let about = within_grid(vec3<f32>(leg.start), d, leg.first, leg.last);
    if !(about.x <= about.y) {
        return before;
    }
    let p = leg_place(leg, real(about.x));
    let ends = within_grid(p, d, leg.first - about.x, leg.last - about.x);
    if !(ends.x < ends.y) {
        return before;
    }
    let cells = vec3<i32>(medium.last);
    let inverse = inverse_of(d);
    let towards = select(vec3<i32>(1), vec3<i32>(-1), d < vec3<f32>(0.0));

    var passed = before;
    var cell = clamp(vec3<i32>(floor(p + ends.x * d)), vec3<i32>(0), cells - 1);
    var enters = ends.x;
    var leaves = ends.x;
    var planes_at = vec3<f32>(0.0);
    var stretch: Stretch;
    var is_new = true;
    var start_at = 0.0;
    var width = 1.0;
    for (var round = 0u; round < ROUNDS; round++) {
        if is_new {
            // where the way through the cell ends
            let plane = vec3<f32>(cell + max(towards, vec3<i32>(0)));
            planes_at = select((plane - p) * inverse, vec3<f32>(FAR), d == vec3<f32>(0.0));
            leaves = max(enters, min(min(planes_at.x, ends.y), min(planes_at.y, planes_at.z)));
            let a = clamp(p + enters * d - vec3<f32>(cell), vec3<f32>(0.0), vec3<f32>(1.0));
            let b = clamp(p + leaves * d - vec3<f32>(cell), vec3<f32>(0.0), vec3<f32>(1.0));
            stretch = stretch_in(cell, a, b, leg.direction);
            is_new = false;
            start_at = 0.0;
            width = 1.0;
        }
        let way = width * (leaves - enters) * leg.speed;
        let taken = take(stretch_part(stretch, start_at, start_at + width), way, width <= LEAST_WIDTH, passed);
        if !taken.is_taken {
            width *= 0.5;
            continue;
        }
        passed = taken.passed;
        if is_dark(passed) {
            break;
        }
        start_at += width;
        if start_at < 1.0 {
            // parts begin at multiples of their width
            width *= select(1.0, 2.0, fract(start_at / (2.0 * width)) == 0.0);
            continue;
        }
        if leaves >= ends.y {
            break;
        }
        cell += select(vec3<i32>(0), towards, planes_at <= vec3<f32>(leaves));
        if any(cell < vec3<i32>(0)) || any(cell >= cells) {
            break;
        }
        enters = leaves;
        is_new = true;
    }
    return passed;
}

@compute @workgroup_size(64)
fn volume(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    // take a pixel
    let pixel = item_index(group, groups, lane);
    if pixel >= params.width * params.height {
        return;
    }
    let x = pixel % params.width;
    let y = pixel / params.width;
    let won = pixel_key(pixel);
    let is_hit = any(won != vec2<u32>(0u));
    let last = select(medium.layers - 1u, key_layer(~won), is_hit);

    // follow its path
    var passed = UNCHANGED;
    for (var layer = 0u; layer <= last; layer++) {
        if !has_ray(layer, x, y) {
            continue;
        }
        let t_end = select(params.t_max.x, key_t(~won), is_hit && layer == last);
        let legs = legs_of(layer, x, y, t_end);
        for (var k = 0u; k < legs.count; k++) {
            if is_dark(passed) {
                break;
            }
            passed = through(leg_at(legs, k), passed);
        }
    }

    // put it over what is there
    let light = passed_light(passed);
    put(PLANE_R, pixel, light.x, light.w);
    put(PLANE_G, pixel, light.y, light.w);
    put(PLANE_B, pixel, light.z, light.w);
    put(PLANE_A, pixel, 1.0 - light.w, light.w);
}

fn put(plane: u32, pixel: u32, light: f32, left: f32) {
    if plane != NONE {
        let at = plane * params.width * params.height + pixel;
        planes[at] = bitcast<u32>(light + left * bitcast<f32>(planes[at]));
    }
}

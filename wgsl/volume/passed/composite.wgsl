// What a stretch of a ray within a cell adds to the light that comes through to the viewer, where the volume sends out and absorbs light.

#import volume/cubic.wgsl
#import volume/layout.wgsl
#import volume/light
#import volume/transfer.wgsl

// The light that the volume sent out so far, and the share of that from behind that comes through.
struct Passed {
    light: vec3<f32>,
    left: f32,
}

// Whether the stretch counts, or is to be halved.
struct Taken {
    passed: Passed,
    is_taken: bool,
}

const UNCHANGED: Passed = Passed(vec3<f32>(0.0), 1.0);

// Once less light than this comes through, what lies behind is left out.
const DARK: f32 = 1.0 / 4096.0;

// Limit of four times the error that the colours in a stretch make, as a share of the light that it absorbs.
const COLOUR_ERROR: f32 = 1.0 / 512.0;

fn is_dark(passed: Passed) -> bool {
    return passed.left < DARK;
}

// Adds a stretch of so many world units, whose values lie in one piece of the transfer function: its extinction is a cubic polynomial too,
// and the optical depth exact.
fn emitted(stretch: Stretch, j: u32, way: f32, before: Passed) -> Passed {
    let value = stretch.value - medium.value[j].x;
    let extinctions = max(medium.point[j].w + medium.slope[j].w * value, vec4<f32>(0.0));
    let extinction = mean(extinctions);
    if extinction <= 0.0 {
        return before;
    }
    let left = before.left * exp(-way * extinction);
    // the means over what is absorbed
    let weighted = inner(value, extinctions) / extinction;
    let colour = medium.point[j].xyz + weighted * medium.slope[j].xyz;
    return Passed(before.light + (before.left - left) * colour_of(stretch, extinctions, extinction, colour), left);
}

// A stretch of so many world units. `is_least`: it cannot be halved.
fn take(stretch: Stretch, way: f32, is_least: bool, before: Passed) -> Taken {
    let lo = least(stretch.value);
    let hi = most(stretch.value);
    let j = piece_of(lo);
    if hi <= medium.value[j].y {
        let extinction = max(look(j, lo).w, look(j, hi).w);
        let range = (hi - lo) * medium.value[j].z;
        if is_least || colour_error(stretch, range, way * extinction) <= COLOUR_ERROR {
            return Taken(emitted(stretch, j, way, before), true);
        }
        return Taken(before, false);
    }
    // one control point among the values: they count as linear along the stretch
    let next = min(j + 1u, 63u);
    let corner = medium.value[j].y;
    let v = stretch.value;
    let off = max(abs(v.y - mix(v.x, v.w, 1.0 / 3.0)), abs(v.z - mix(v.x, v.w, 2.0 / 3.0)));
    let extinction = max(look(j, lo).w, max(medium.point[next].w, look(next, hi).w));
    let steepest = max(medium.value[j], medium.value[next]);
    let rate = off * (steepest.w + extinction * steepest.z);
    let is_fine = rate <= medium.corner_rate && colour_error(stretch, (hi - lo) * steepest.z, way * extinction) <= COLOUR_ERROR;
    if !is_least && !(hi <= medium.value[next].y && is_fine) {
        return Taken(before, false);
    }
    let share = clamp((corner - v.x) / (v.w - v.x), 0.0, 1.0);
    let is_crossed = (v.x < corner) != (v.w < corner);
    let cut = select(1.0, share, is_crossed);
    let middle = select(v.w, corner, is_crossed);
    var first = stretch_part(stretch, 0.0, cut);
    first.value = linear(v.x, middle);
    var second = stretch_part(stretch, cut, 1.0);
    second.value = linear(middle, v.w);
    let passed = emitted(first, select(next, j, min(v.x, middle) < corner), cut * way, before);
    return Taken(emitted(second, select(next, j, min(middle, v.w) < corner), (1.0 - cut) * way, passed), true);
}

fn linear(a: f32, b: f32) -> vec4<f32> {
    return vec4<f32>(a, mix(a, b, 1.0 / 3.0), mix(a, b, 2.0 / 3.0), b);
}

// What comes out at the viewer's end.
fn passed_light(passed: Passed) -> vec4<f32> {
    return vec4<f32>(passed.light, passed.left);
}

// The largest value along a ray.

#import volume/cubic.wgsl
#import volume/layout.wgsl
#import volume/light
#import volume/transfer.wgsl

struct Passed {
    largest: f32,
}

// Whether the stretch counts, or is to be halved.
struct Taken {
    passed: Passed,
    is_taken: bool,
}

// Below all values of volumes.
const NOTHING: f32 = -2.0e9;

const UNCHANGED: Passed = Passed(NOTHING);

fn is_dark(passed: Passed) -> bool {
    return false;
}

// The values of a stretch lie below the largest coefficient, and hold its ends.
fn take(stretch: Stretch, way: f32, is_least: bool, before: Passed) -> Taken {
    let largest = max(before.largest, max(stretch.value.x, stretch.value.w));
    if is_least || most(stretch.value) <= largest + medium.value_error {
        return Taken(Passed(largest), true);
    }
    return Taken(before, false);
}

// Light and what is left of that from behind: as one world unit of the largest value.
fn passed_light(passed: Passed) -> vec4<f32> {
    if passed.largest == NOTHING {
        return vec4<f32>(0.0, 0.0, 0.0, 1.0);
    }
    let seen = look(piece_of(passed.largest), passed.largest);
    let left = exp(-seen.w);
    return vec4<f32>((1.0 - left) * seen.xyz, left);
}

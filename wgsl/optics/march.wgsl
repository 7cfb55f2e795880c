// The first root of a function along a ray, in steps proven free of roots. A file per surface provides the
// function, `along`, bounds of its second derivative, and how many steps it takes at most.

#import arithmetic
#import optics/root
#import optics/smooth/bounce.wgsl

// Fraction of the proven root-free interval that is stepped over; the rest covers the rounding errors of slope and curvature. A step can
// pass two roots only where the function is 0 within its own rounding error.
const STEP: real = 0.99609375;

// From `from`, where the function is not 0, to `to`. While its second derivative is within `bends`, a function of value v that
// falls at the rate g is above 0 for v - g h - bend h^2 / 2 > 0. Near a root these steps converge as Newton's do, from one side.
// After `most` steps, several times what any ray was measured to take, the rest is assumed to have no root.
fn first_crossing(a: Along, from_s: real, to_s: real, bends: vec2<real>, most: u32) -> Root {
    let zero = real(0.0);
    var s = from_s;
    var now = along(a, s);
    let above = now.x > zero;
    let bend = max(select(bends.y, -bends.x, above), zero);
    for (var k = 0u; k < most; k++) {
        let v = select(-now.x, now.x, above);
        let g = select(now.y, -now.y, above);
        if v <= zero {
            return Root(s, true);
        }
        if g <= zero && bend == zero {
            break;
        }
        let root = sqrt(g * g + (bend + bend) * v);
        var h = (v + v) / (root + g);
        if g < zero {
            h = (root - g) / bend;
        }
        let next = s + STEP * h;
        // no number between the two: this is the root
        if !(next > s) {
            return Root(s, true);
        }
        if next > to_s {
            break;
        }
        s = next;
        now = along(a, s);
    }
    return Root(s, false);
}

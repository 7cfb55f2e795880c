// The first root of a function along a ray, in steps proven free of roots. A snippet per surface provides the
// function, `along`, bounds of its second derivative, and how many steps it takes at most.
// Provides: first_crossing
// Needs: Along, Root, along, real

// A step is that much of what is proved: the rest outweighs what rounding of slope and bend may add to it. Only where the
// function is 0 within its own rounding may a step pass two roots.
const STEP: real = 0.99609375;

// From `from`, where the function is not 0, to `to`. As long as its second derivative keeps within `bends`, a function that is
// v and falls at the rate g is above 0 for v - g h - bend h^2 / 2 > 0. At a root these steps come nearer as Newton's do, and from
// one side. After `most` of them, several times what any ray was seen to take, the rest is assumed to have none.
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

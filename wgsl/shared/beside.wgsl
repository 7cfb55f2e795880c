// Where the sides of edges are decided: beside a pixel's centre, so that a ray that meets an edge exactly, or should but for rounding,
// passes on one side. The same place for all triangles, in the reference and the twins too (src/camera/beside.rs).

// How far at most, px.
const BESIDE_PX: real = 1.0 / 16777216.0;

// How far down for a step to the right: no simple fraction, along which edges of grids run.
const BESIDE_DOWN: real = 47.0 / 83.0;

// The bundle of a pixel about that place, in a scene of this size. A ray without a neighbour on the right or below goes
// across the other slope instead, and without both anywhere. Without a size rays stay where they are.
fn beside(own: Bundle, reach: real) -> Bundle {
    if reach == 0.0 {
        return own;
    }
    var b = own;
    let along = b.d / size3(b.d);
    let no_right = size3(b.px) + size3(b.dx) + abs(b.hx) == 0.0;
    let no_down = size3(b.py) + size3(b.dy) + abs(b.hy) == 0.0;
    if no_right && no_down {
        b.dx = b.d.yzx;
    } else if no_right {
        b.px = cross(along, b.py);
        b.dx = cross(along, b.dy);
    }
    if no_down {
        b.py = cross(along, b.px);
        b.dy = cross(along, b.dx);
    }
    let place = b.p / b.h;
    let origins = (size3(b.px - b.hx * place) + size3(b.py - b.hy * place)) / abs(b.h);
    let directions = (size3(b.dx) + size3(b.dy)) / size3(b.d);
    let step = min(BESIDE * reach / (origins + reach * directions), BESIDE_PX);
    return bundle_at(b, step, BESIDE_DOWN * step);
}

// The perturbed ray of a pixel, on which coverage is decided: an exact edge hit is decided the same way for all triangles, in
// the reference and the twins too (src/camera/perturb.rs).

#import arithmetic
#import rays/affine_bundle.wgsl

// Largest perturbation to the right, px.
const PERTURB_PX: real = 1.0 / 16777216.0;

// Step down for a step to the right of 1. Edges of grids run along simple fractions; this is none.
const PERTURB_DOWN: real = 47.0 / 83.0;

// A pixel's bundle centred on its perturbed ray, in a scene of this size. A ray without a neighbour on the right or below gets a slope
// across its other one; without both, a slope across its direction. A scene of size 0 perturbs nothing.
fn perturbed(own: Bundle, scene_size: real) -> Bundle {
    // with the ray in the test, as lavapipe compiles a kernel anew, every frame, for a uniform number that decides alone
    if scene_size * size3(own.d) == 0.0 {
        return own;
    }
    var b = own;
    let along = b.d / size3(b.d);
    let no_right = size3(b.px) + size3(b.dx) + abs(b.hx) == 0.0;
    let no_down = size3(b.py) + size3(b.dy) + abs(b.hy) == 0.0;
    if no_right && no_down {
        if abs(b.d.x) > abs(b.d.y) {
            b.dx = real3(-b.d.z, real(0.0), b.d.x);
        } else {
            b.dx = real3(real(0.0), b.d.z, -b.d.y);
        }
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
    let step = min(PERTURB * scene_size / (origins + scene_size * directions), PERTURB_PX);
    return bundle_at(b, step, PERTURB_DOWN * step);
}

//! Reflection and refraction with bounds on the values that a kernel computes: facets here, smooth surfaces in [`super::smooth`].

use super::bounded::{Bounded, Bounded3, Judged};
use super::{KernelInputs, Real};
use anamorph::internals::camera::optics::FLAT_LEAST;
use anamorph::internals::gpu::kernels::RaysKind;
use anamorph::internals::gpu::layout::{Corner, LAW_NORMALS, Optic};

/// A pixel's ray, relative to the anchor.
#[derive(Debug, Clone, Copy)]
pub struct BoundedRay {
    pub p: Bounded3,
    pub d: Bounded3,
}

/// A reflected or refracted ray: origin, direction and its share of the light.
#[derive(Debug, Clone, Copy)]
pub struct BouncedRay {
    pub place: Bounded3,
    pub d: Bounded3,
    pub share: Bounded,
}

impl KernelInputs<'_> {
    /// The ray of a pixel of a band of one layer, where it has one.
    pub fn bounded_ray(&self, x: u32, y: u32, real: Real) -> Option<BoundedRay> {
        if let (RaysKind::Field { .. }, Some(table)) = (self.kind, self.rays) {
            let at = 6 * (y as usize * (self.params.width as usize + 1) + x as usize);
            let three = |v: &[f32], k: usize| [v[at + k], v[at + k + 1], v[at + k + 2]];
            let v = |k: usize| Bounded3::pair(three(&table.hi, k), three(&table.lo, k), real);
            return (three(&table.hi, 3) != [0.0; 3]).then(|| BoundedRay { p: v(0), d: v(3) });
        }
        let q = self.pieces[self.cells[self.pixel_cell(0, x, y)? as usize].piece as usize];
        let exact = |v: f64| Bounded::exact(v, real);
        let x = exact(f64::from(x) - f64::from(q.origin_x));
        let y = exact(f64::from(y) - f64::from(q.origin_y));
        let v = |hi, lo| Bounded3::pair(hi, lo, real);
        let p = v(q.p_hi, q.p_lo) + v(q.px_hi, q.px_lo) * x + v(q.py_hi, q.py_lo) * y;
        let d = v(q.d_hi, q.d_lo) + v(q.dx_hi, q.dx_lo) * x + v(q.dy_hi, q.dy_lo) * y;
        let h = Bounded::pair(q.h_hi, q.h_lo, real)
            + Bounded::pair(q.hx_hi, q.hx_lo, real) * x
            + Bounded::pair(q.hy_hi, q.hy_lo, real) * y;
        Some(BoundedRay { p: p / h, d: d / h })
    }
}

/// A direction after a bounce, and its share of the light.
#[derive(Debug, Clone, Copy)]
pub struct Bent {
    pub d: Bounded3,
    pub share: Bounded,
    /// It was refracted to the other side of the surface.
    transmitted: bool,
}

/// A unit normal tilted in its tangent plane, in the frame of Duff et al. 2017.
fn tilted(optic: &Optic, n: Bounded3, real: Real) -> Bounded3 {
    let x = Bounded::pair(optic.tilt_x_hi, optic.tilt_x_lo, real);
    let y = Bounded::pair(optic.tilt_y_hi, optic.tilt_y_lo, real);
    if x.v == 0.0 && y.v == 0.0 {
        return n;
    }
    let [nx, ny, nz] = n.0;
    let below = nz.is_negative();
    let side = Bounded::exact(if below.yes { -1.0 } else { 1.0 }, real);
    let one = Bounded::exact(1.0, real);
    let a = -one / (side + nz);
    let b = nx * ny * a;
    let e1 = Bounded3([one + side * nx * nx * a, side * b, -side * nx]);
    let e2 = Bounded3([b, side + ny * ny * a, -ny]);
    let v = (n + e1 * x + e2 * y).unit();
    if below.sure { v } else { v.lost() }
}

/// The unit direction `d` after a surface with this normal, of any length; `outside` says which side is met: Snell's law,
/// and total reflection where that has no answer. Lost where rounding decides which of them.
pub fn bent(optic: &Optic, d: Bounded3, normal: Bounded3, outside: Bounded3, real: Real) -> Bent {
    let one = Bounded::exact(1.0, real);
    let n = tilted(optic, normal.unit(), real);
    let along = d.dot(n);
    let reflected = d - n * (along + along);
    if optic.ior_hi == 0.0 {
        return Bent { d: reflected, share: one, transmitted: false };
    }
    let ior = Bounded::pair(optic.ior_hi, optic.ior_lo, real);
    let enters = d.dot(outside).is_negative();
    let faces = along.is_negative();
    let eta = if enters.yes { one / ior } else { ior };
    let against = if faces.yes { n } else { -n };
    let cosine = along.abs();
    let square = one - eta * eta * (one - cosine * cosine);
    let total = square.is_negative();
    let is_main = optic.branch == 0;
    let nothing = Bounded::exact(0.0, real);
    let bent = if total.yes {
        let (d, share) = if is_main { (reflected, one) } else { (Bounded3([nothing; 3]), nothing) };
        Bent { d, share, transmitted: false }
    } else {
        let inner = square.sqrt();
        let refracted = d * eta + against * (eta * cosine - inner);
        let across = (eta * cosine - inner) / (eta * cosine + inner);
        let within = (cosine - eta * inner) / (cosine + eta * inner);
        let back = (across * across + within * within) / (one + one);
        match (optic.fresnel == 1, is_main) {
            (false, _) => Bent { d: refracted, share: one, transmitted: true },
            (true, true) => Bent { d: refracted, share: one - back, transmitted: true },
            (true, false) => Bent { d: reflected, share: back, transmitted: false },
        }
    };
    let sure = enters.sure && total.sure && (total.yes || faces.sure);
    if sure { bent } else { Bent { d: bent.d.lost(), share: bent.share.lost(), ..bent } }
}

/// The same, but never to the wrong side of the surface: its plane then reflects the direction.
pub fn bent_at(optic: &Optic, d: Bounded3, normal: Bounded3, outside: Bounded3, real: Real) -> Bent {
    let after = bent(optic, d, normal, outside, real);
    let up = outside.unit();
    let height = after.d.dot(up);
    let crosses = (height * d.dot(up)).is_negative();
    let is_wrong = height.v != 0.0 && crosses.yes == after.transmitted;
    let back = after.d - up * (height + height);
    let bent = if is_wrong { back } else { after.d };
    // where the side is uncertain, the direction is off by at most twice its height over the plane
    let off = 2.0 * (height.v.abs() + height.e);
    let widened = Bounded3(bent.0.map(|c| c.off_by(c.e + off)));
    Bent { d: if crosses.sure { bent } else { widened }, ..after }
}

/// The ray that leaves the facet of these corners, which `ray` meets.
pub fn at_facet(optic: &Optic, corners: &[Corner], ray: &BoundedRay, real: Real) -> BouncedRay {
    let v = [0, 1, 2].map(|k| Bounded3::pair(corners[k].p_hi, corners[k].p_lo, real));
    let n = [0, 1, 2].map(|k| Bounded3::pair(corners[k].n_hi, corners[k].n_lo, real));
    let outside = (v[1] - v[0]).cross(v[2] - v[0]);

    // each corner's weight: the opposite edge's moment about the ray, over their sum
    let edge = |from: usize, to: usize| (v[to] - v[from]).dot(ray.d.cross(v[from] - ray.p));
    let e = [edge(1, 2), (v[0] - v[2]).dot(ray.d.cross(v[0] - ray.p)), edge(0, 1)];
    let w = e.map(|own| own / (e[0] + e[1] + e[2]));
    let place = Bounded3::mixed(w, v);
    if optic.law == LAW_NORMALS {
        let Bent { d, share, .. } = bent_at(optic, ray.d.unit(), Bounded3::mixed(w, n), outside, real);
        return BouncedRay { place, d, share };
    }

    // flat: interpolate the corners' own bounced rays, scaled to one height over the facet
    let eye = Bounded3::pair(optic.eye_hi, optic.eye_lo, real);
    let bent = [0, 1, 2].map(|k| bent(optic, (v[k] - eye).unit(), n[k], outside, real));
    let d = bent.map(|b| b.d);
    let share = bent[0].share * w[0] + bent[1].share * w[1] + bent[2].share * w[2];
    let heights = d.map(|d| d.dot(outside.unit()));
    let least = Bounded::exact(FLAT_LEAST, real);
    let all = |leaves: &dyn Fn(Bounded) -> Judged| leaves(heights[0]).and(leaves(heights[1])).and(leaves(heights[2]));
    let (up, down) = (all(&|h| least.at_most(h)), all(&|h| h.at_most(-least)));
    let one = Bounded::exact(1.0, real);
    let scaled = if up.yes || down.yes { [0, 1, 2].map(|k| d[k] * (one / heights[k].abs())) } else { d };
    let mixed = Bounded3::mixed(w, scaled);
    BouncedRay { place, d: if up.sure && down.sure { mixed } else { mixed.lost() }, share }
}

//! What a surface makes of a ray, with bounds on what a kernel may make of it: facets here, quadrics in
//! [`super::quadric`].

use super::near::{Judged, Near, Near3};
use super::{Input, Real};
use crate::gpu::kernels::RaysKind;
use crate::gpu::rows::{Corner, LAW_NORMALS, Optic};
use crate::optics::FLAT_LEAST;

/// A pixel's ray, relative to the anchor.
#[derive(Debug, Clone, Copy)]
pub struct NearRay {
    pub p: Near3,
    pub d: Near3,
}

/// Where a ray is turned, and where to.
#[derive(Debug, Clone, Copy)]
pub struct Turned {
    pub place: Near3,
    pub d: Near3,
}

impl Input<'_> {
    /// The ray of a pixel of a band of one layer, where it has one.
    pub fn near_ray(&self, x: u32, y: u32, real: Real) -> Option<NearRay> {
        if let (RaysKind::Field, Some(table)) = (self.kind, self.rays) {
            let at = 6 * (y as usize * (self.params.width as usize + 1) + x as usize);
            let three = |v: &[f32], k: usize| [v[at + k], v[at + k + 1], v[at + k + 2]];
            let v = |k: usize| Near3::pair(three(&table.hi, k), three(&table.lo, k), real);
            return (three(&table.hi, 3) != [0.0; 3]).then(|| NearRay { p: v(0), d: v(3) });
        }
        let q = self.pieces[self.cells[self.pixel_cell(0, x, y)? as usize].piece as usize];
        let exact = |v: f64| Near::exact(v, real);
        let x = exact(f64::from(x) - f64::from(q.origin_x));
        let y = exact(f64::from(y) - f64::from(q.origin_y));
        let v = |hi, lo| Near3::pair(hi, lo, real);
        let p = v(q.p_hi, q.p_lo) + v(q.px_hi, q.px_lo) * x + v(q.py_hi, q.py_lo) * y;
        let d = v(q.d_hi, q.d_lo) + v(q.dx_hi, q.dx_lo) * x + v(q.dy_hi, q.dy_lo) * y;
        let h = Near::pair(q.h_hi, q.h_lo, real)
            + Near::pair(q.hx_hi, q.hx_lo, real) * x
            + Near::pair(q.hy_hi, q.hy_lo, real) * y;
        Some(NearRay { p: p / h, d: d / h })
    }
}

/// The unit direction `d` after a surface with this normal, of any length; `outside` says which side is met: Snell's law,
/// and total reflection where that has no answer. Lost where rounding decides which of them.
pub fn bent(optic: &Optic, d: Near3, normal: Near3, outside: Near3, real: Real) -> Near3 {
    let one = Near::exact(1.0, real);
    let n = normal.unit();
    let along = d.dot(n);
    let reflected = d - n * (along + along);
    if optic.ior_hi == 0.0 {
        return reflected;
    }
    let ior = Near::pair(optic.ior_hi, optic.ior_lo, real);
    let enters = d.dot(outside).is_negative();
    let faces = along.is_negative();
    let eta = if enters.yes { one / ior } else { ior };
    let against = if faces.yes { n } else { -n };
    let cosine = along.abs();
    let square = one - eta * eta * (one - cosine * cosine);
    let total = square.is_negative();
    let bent = if total.yes { reflected } else { d * eta + against * (eta * cosine - square.sqrt()) };
    let sure = enters.sure && total.sure && (total.yes || faces.sure);
    if sure { bent } else { bent.lost() }
}

/// The turn of a ray at the facet of these corners, which it meets.
pub fn at_facet(optic: &Optic, corners: &[Corner], ray: &NearRay, real: Real) -> Turned {
    let v = [0, 1, 2].map(|k| Near3::pair(corners[k].p_hi, corners[k].p_lo, real));
    let n = [0, 1, 2].map(|k| Near3::pair(corners[k].n_hi, corners[k].n_lo, real));
    let outside = (v[1] - v[0]).cross(v[2] - v[0]);

    // each corner's weight: the opposite edge's moment about the ray, over their sum
    let edge = |from: usize, to: usize| (v[to] - v[from]).dot(ray.d.cross(v[from] - ray.p));
    let e = [edge(1, 2), (v[0] - v[2]).dot(ray.d.cross(v[0] - ray.p)), edge(0, 1)];
    let w = e.map(|own| own / (e[0] + e[1] + e[2]));
    let place = Near3::mixed(w, v);
    if optic.law == LAW_NORMALS {
        return Turned { place, d: bent(optic, ray.d.unit(), Near3::mixed(w, n), outside, real) };
    }

    // flat: the corners' own turned rays, of one height over the facet, between them
    let eye = Near3::pair(optic.eye_hi, optic.eye_lo, real);
    let d = [0, 1, 2].map(|k| bent(optic, (v[k] - eye).unit(), n[k], outside, real));
    let heights = d.map(|d| d.dot(outside.unit()));
    let least = Near::exact(FLAT_LEAST, real);
    let all = |leaves: &dyn Fn(Near) -> Judged| leaves(heights[0]).and(leaves(heights[1])).and(leaves(heights[2]));
    let (up, down) = (all(&|h| least.at_most(h)), all(&|h| h.at_most(-least)));
    let one = Near::exact(1.0, real);
    let scaled = if up.yes || down.yes { [0, 1, 2].map(|k| d[k] * (one / heights[k].abs())) } else { d };
    let mixed = Near3::mixed(w, scaled);
    Turned { place, d: if up.sure && down.sure { mixed } else { mixed.lost() } }
}

//! The cubic in t whose roots are the rays of a piece through a point.
//!
//! With the bundle's `p + t d = X h`, all affine in the image place (x, y), a ray meets X where the columns
//! `m_k(t) = p_k + t d_k - X h_k` have `m_0 + x m_1 + y m_2 = 0`. So `det M(t) = 0`, a cubic in t (Hou et al. 2006,
//! appendix; Popescu et al. 2009, section 4.2; for parallel planes most of its coefficients vanish: Yu and McMillan
//! 2004). Its roots are found without missing one, over t in [-T, T] and, by 1/t, beyond; a degree that drops is a root
//! at infinity, which is none. Then (x, y) follows from the columns.
//!
//! On a slit or an eye M(t) has rank 1 or 0: a line of places, or all, see the point.

use crate::arrays::MapEach;
use crate::camera::bundle::Bundle;
use crate::geometry::bernstein::{Bernstein, VALUE_ROUNDING};
use glam::{DMat3, DVec2, DVec3};

/// Columns are parallel, or nothing, within this of the terms they are sums of: some 2^12 roundings. It is also how
/// near to a slit, relative to the scene, a point counts as on it.
const RANK_ROUNDING: f64 = 1.0 / (1u64 << 40) as f64;

/// Rounding of the determinant's coefficients against the product of the columns' terms: three differences, two
/// products, up to eighteen sums, half an epsilon each.
const DET_ROUNDING: f64 = 12.0 * f64::EPSILON;

/// Steps that bring a t to where the rank drops; each doubles the digits.
const RANK_STEPS: usize = 6;

/// `M(t) = q + t d`, its second and third columns for places in units of `half_px`.
pub struct Columns {
    q: [DVec3; 3],
    d: [DVec3; 3],
    /// Magnitudes of the terms of each column of `q`.
    terms: [f64; 3],
    half_px: f64,
    /// The t at which both parts of M are of like size.
    pub unit: f64,
}

impl Columns {
    /// `None` where the bundle has no rays.
    pub fn of(b: &Bundle, x: DVec3, half_px: f64) -> Option<Columns> {
        let scale = [1.0, half_px, half_px];
        let q = [0, 1, 2].map_each(|k| scale[k] * (b.p[k] - x * b.h[k]));
        let d = [0, 1, 2].map_each(|k| scale[k] * b.d[k]);
        let terms = [0, 1, 2].map_each(|k| scale[k] * (b.p[k].length() + x.length() * b.h[k].abs()));
        let size = |v: &[DVec3; 3]| v.iter().map(|v| v.length()).sum::<f64>();
        if size(&d) == 0.0 {
            return None;
        }
        let unit = size(&q).max(RANK_ROUNDING * terms.iter().sum::<f64>()) / size(&d);
        Some(Columns { q, d, terms, half_px, unit: if unit > 0.0 { unit } else { 1.0 } })
    }

    fn at(&self, t: f64) -> [DVec3; 3] {
        [0, 1, 2].map_each(|k| self.q[k] + t * self.d[k])
    }

    /// What counts as nothing at `t`.
    fn nothing(&self, t: f64) -> f64 {
        let terms: f64 = self.terms.iter().sum();
        RANK_ROUNDING * (terms + t.abs() * self.d.iter().map(|d| d.length()).sum::<f64>())
    }

    /// The t at which all of M is 0: all rays meet in the point.
    pub fn vanish(&self) -> Option<f64> {
        let dot = |a: &[DVec3; 3], b: &[DVec3; 3]| (0..3).map(|k| a[k].dot(b[k])).sum::<f64>();
        let t = -dot(&self.q, &self.d) / dot(&self.d, &self.d);
        self.at(t).iter().all(|m| m.length() <= self.nothing(t)).then_some(t)
    }

    /// The real roots of det M, `None` where it is 0 for every t.
    pub fn roots(&self) -> Option<Vec<f64>> {
        let det = |a: DVec3, b: DVec3, c: DVec3| DMat3::from_cols(a, b, c).determinant();
        let ([q0, q1, q2], [d0, d1, d2]) = (self.q, self.d.map_each(|d| self.unit * d));
        let c = [
            det(q0, q1, q2),
            det(d0, q1, q2) + det(q0, d1, q2) + det(q0, q1, d2),
            det(q0, d1, d2) + det(d0, q1, d2) + det(d0, d1, q2),
            det(d0, d1, d2),
        ];
        let column = |k: usize| self.terms[k] + self.unit * self.d[k].length();
        let zero = DET_ROUNDING * column(0) * column(1) * column(2);
        if c.iter().all(|c| c.abs() <= zero) {
            return None;
        }
        let near = roots_about_0(c, zero).into_iter().map(|u| self.unit * u);
        let far = roots_about_0([c[3], c[2], c[1], c[0]], zero).into_iter().map(|u| self.unit / u);
        Some(near.chain(far.filter(|t| t.is_finite())).collect())
    }

    /// The place about the piece's centre (px) whose ray is nearest to the point at `t`; `None` where all places are.
    pub fn place(&self, t: f64) -> Option<DVec2> {
        let [m0, m1, m2] = self.at(t);
        let n = m1.cross(m2);
        let place = self.half_px / n.length_squared() * DVec2::new(m2.cross(m0).dot(n), m0.cross(m1).dot(n));
        place.is_finite().then_some(place)
    }

    /// Where near `t` the columns become parallel: that t, and the line `a x + b y + c = 0` (px) of places that see the
    /// point.
    pub fn line(&self, t: f64) -> Option<(f64, [f64; 3])> {
        let t = self.parallel_near(t);
        let m = self.at(t);
        let longer = if m[1].length() >= m[2].length() { m[1] } else { m[2] };
        let nothing = self.nothing(t);
        let e = longer.normalize_or_zero();
        let parallel = longer.length() > nothing && m.iter().all(|m| m.cross(e).length() <= nothing);
        parallel.then(|| (t, [m[1].dot(e) / self.half_px, m[2].dot(e) / self.half_px, m[0].dot(e)]))
    }

    /// Least squares steps on the three cross products of the columns, which are quadratic in t.
    fn parallel_near(&self, mut t: f64) -> f64 {
        for _ in 0..RANK_STEPS {
            let (m, d) = (self.at(t), self.d);
            let (mut down, mut up) = (0.0, 0.0);
            for (a, b) in [(0, 1), (0, 2), (1, 2)] {
                let (value, slope) = (m[a].cross(m[b]), d[a].cross(m[b]) + m[a].cross(d[b]));
                down += slope.dot(slope);
                up += value.dot(slope);
            }
            let next = t - up / down;
            if !next.is_finite() || (next - t).abs() > self.unit.max(t.abs()) {
                return t;
            }
            t = next;
        }
        t
    }
}

/// The roots of `c0 + c1 u + c2 u^2 + c3 u^3` in [-1, 1].
fn roots_about_0(c: [f64; 4], zero: f64) -> Vec<f64> {
    // the polynomial's blossom at the ends of the interval (Ramshaw)
    let blossom = |u: [f64; 3]| {
        let pairs = u[0] * u[1] + u[1] * u[2] + u[2] * u[0];
        c[0] + c[1] * (u[0] + u[1] + u[2]) / 3.0 + c[2] * pairs / 3.0 + c[3] * u[0] * u[1] * u[2]
    };
    let (a, b) = (-1.0, 1.0);
    let p = Bernstein::new(&[[a, a, a], [a, a, b], [a, b, b], [b, b, b]].map_each(blossom));
    p.roots(4.0 * zero + VALUE_ROUNDING * p.size()).iter().map(|r| 2.0 * r.t - 1.0).collect()
}

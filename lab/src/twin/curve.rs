//! A curve against a triangle in f64: the Bernstein form of its plane's polynomial, halved until it has one root or none.

use super::Real;
use super::raster::{Corners, Fragment, Tested};
use super::rays::PixelCurve;
use glam::DVec3;

/// Units that a control point less a vertex, along a normal, may lose: two stored points, a difference, two products.
const PLANE_UNITS: f64 = 16.0;

/// Most halvings: beyond this no f64 lies between two ts.
const DEPTH_MAX: u32 = 52;

/// A polynomial over a span of t, at most cubic.
struct Poly {
    b: Vec<f64>,
    span: [f64; 2],
}

impl Poly {
    fn halves(&self) -> [Poly; 2] {
        let (n, middle) = (self.b.len(), 0.5 * (self.span[0] + self.span[1]));
        let (mut level, mut low, mut high) = (self.b.clone(), Vec::new(), vec![0.0; n]);
        for k in 0..n {
            low.push(level[0]);
            high[n - 1 - k] = level[n - 1 - k];
            for j in 0..n - 1 - k {
                level[j] = 0.5 * (level[j] + level[j + 1]);
            }
        }
        [Poly { b: low, span: [self.span[0], middle] }, Poly { b: high, span: [middle, self.span[1]] }]
    }

    /// The roots, ascending, each with whether it is certain that there is one.
    fn roots(&self, bound: f64, depth: u32, found: &mut Vec<(f64, bool)>) {
        if self.b.iter().all(|&b| b > bound) || self.b.iter().all(|&b| b < -bound) {
            return;
        }
        let within = self.b.iter().all(|b| b.abs() <= bound);
        if within || depth == DEPTH_MAX {
            let (first, last) = (self.b[0], self.b[self.b.len() - 1]);
            let crosses = (first > bound && last < -bound) || (first < -bound && last > bound);
            found.push((0.5 * (self.span[0] + self.span[1]), crosses));
            return;
        }
        let rises = |w: &[f64]| w[1] - w[0];
        let monotone = self.b.windows(2).all(|w| rises(w) > 0.0) || self.b.windows(2).all(|w| rises(w) < 0.0);
        let (first, last) = (self.b[0], self.b[self.b.len() - 1]);
        if monotone && first.abs() > bound && last.abs() > bound {
            found.push((self.bisected(), true));
            return;
        }
        self.halves().iter().for_each(|half| half.roots(bound, depth + 1, found));
    }

    /// The root of a monotone polynomial with different signs at its ends.
    fn bisected(&self) -> f64 {
        let at = |t: f64| {
            let mut level = self.b.clone();
            for n in (1..level.len()).rev() {
                (0..n).for_each(|j| level[j] += t * (level[j + 1] - level[j]));
            }
            level[0]
        };
        let (mut lo, mut hi) = (0.0, 1.0);
        for _ in 0..64 {
            let t = 0.5 * (lo + hi);
            if (at(t) < 0.0) == (self.b[0] < 0.0) { lo = t } else { hi = t }
        }
        let [from, to] = self.span;
        from + (to - from) * 0.5 * (lo + hi)
    }
}

/// The position of a root relative to its triangle.
struct Met {
    inside: bool,
    uncertain: bool,
    is_back_face: bool,
    fragment: Fragment,
}

/// A curve against a triangle over the curve's span, at whatever face: all meetings in order of t, with whether each is
/// inside for certain.
fn meetings(c: &PixelCurve, corners: &Corners, real: Real) -> Vec<Met> {
    let [v0, v1, v2] = corners.v;
    let n = (v1 - v0).cross(v2 - v0);
    // edges of vertices read as f32 change the normal itself
    let plane_error = PLANE_UNITS * real.unit() * (corners.reach() + c.size);
    let size_n = 3.0 * ((v1 - v0).length() * (v2 - v0).length()).max(n.length());
    let bound = size_n * plane_error;
    let part = c.curve.span(c.span);
    let poly = Poly { b: part.points().iter().map(|p| n.dot(*p - v0)).collect(), span: c.span };
    let mut roots = Vec::new();
    poly.roots(bound, 0, &mut roots);
    let meet = |(t, certain): (f64, bool)| {
        let (at, tangent) = (c.curve.at(t), c.curve.tangent(t));
        let across = n.dot(tangent);
        let off = (bound / across.abs().max(bound)).min(real.unit().sqrt());
        let error = 4.0 * size_n * (plane_error + off * tangent.length());
        let sides: Vec<(f64, f64)> = [(v0, v1), (v1, v2), (v2, v0)]
            .map(|(v, w): (DVec3, DVec3)| ((w - v).cross(at - v).dot(n), (w - v).length() * error))
            .to_vec();
        let inside = sides.iter().all(|s| s.0 >= 0.0);
        let uncertain = !certain || sides.iter().any(|s| s.0.abs() <= s.1);
        let outside = sides.iter().any(|s| s.0 < -s.1);
        let edge_on = across.abs() <= size_n * real.rounding() * PLANE_UNITS * tangent.length();
        let is_back_face = corners.one_sided && (across > 0.0) != corners.reversed;
        let t_error = if across == 0.0 { f64::INFINITY } else { bound / across.abs() };
        let uncertain = (uncertain && !outside) || (inside && corners.one_sided && edge_on);
        Met { inside, uncertain, is_back_face, fragment: Fragment { t, t_error, id: corners.id } }
    };
    roots.into_iter().map(meet).collect()
}

/// The first visible meeting.
pub fn test(c: &PixelCurve, corners: &Corners, real: Real) -> Tested {
    let met = meetings(c, corners, real);
    let hit = met.iter().find(|m| m.inside && !m.is_back_face).map(|m| m.fragment);
    Tested { hit, uncertain: met.iter().any(|m| m.uncertain) }
}

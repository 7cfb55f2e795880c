//! One curve against one triangle: every place where it passes or touches the triangle.
//!
//! With `N` the triangle's normal, `f(t) = N . (X(t) - v_0)` is a polynomial of the curve's degree, so at most 3; all its
//! roots in [0, 1] are found ([`crate::geometry::bernstein`]), and at each the weights of the three vertices say whether the
//! place is inside. Both are decided with a bound on their rounding, and a place that may be on an edge as far as the
//! bound tells counts as inside: where triangles join, a curve that truly passes one of them is never lost between
//! them. It may be found in both; their `t` then tie within rounding, and the lower id is as right as the other.
//!
//! A curve within the triangle's plane never meets it, as a ray does not.

use super::bvh::Probe;
use super::intersect::{Corners, Meeting, OPPOSITE, TERM_ROUNDING, cross_size};
use super::margin::GAP;
use crate::camera::curve::Curve;
use crate::geometry::bernstein::{Bernstein, Root, VALUE_ROUNDING};
use glam::DVec3;

/// How exactly a camera gives a control point, against the largest coordinate of all: a Bezier patch of degree 5 in
/// each of two parameters is two nested sums of six terms, each term four roundings (three of its Bernstein factor and
/// one of the product), and the sums of positive weights add five: 9 a level, half an epsilon each. Where two layers
/// are meant to meet, their points differ by no more than twice this.
pub const POINT_ROUNDING: f64 = 9.0 * f64::EPSILON;

/// Every meeting of the curve with the triangle, ascending in t.
pub fn meetings(curve: &Curve, c: &Corners) -> Vec<Meeting> {
    let plane = Plane::of(curve, c);
    let roots = plane.height.roots(plane.zero);
    roots.into_iter().filter_map(|root| plane.meeting(curve, c, root)).collect()
}

/// The curve passes the triangle's plane so flat at `t` that the place is not sure to [`GAP`], or not at all.
pub fn is_flat(curve: &Curve, c: &Corners, t: f64) -> bool {
    let plane = Plane::of(curve, c);
    2.0 * blur(&plane.height, plane.zero, t) > GAP * t.max(GAP)
}

/// A triangle's plane as a curve sees it.
struct Plane {
    normal: DVec3,
    /// The sum of the magnitudes of the terms of `normal`.
    normal_size: DVec3,
    /// `N . (X(t) - v_0)`, of the sorted corners.
    height: Bernstein,
    /// Heights up to this may be 0.
    zero: f64,
    /// Bound of the error of a place on the curve, world units.
    place_error: f64,
}

impl Plane {
    fn of(curve: &Curve, c: &Corners) -> Plane {
        let (e1, e2) = (c.v[1] - c.v[0], c.v[2] - c.v[0]);
        let normal = e1.cross(e2);
        let normal_size = cross_size(e1.abs(), e2.abs());
        let points = curve.points();
        let mut heights = [0.0; 4];
        let (mut size, mut coordinate) = (0.0_f64, 0.0_f64);
        for (height, p) in heights.iter_mut().zip(points) {
            *height = normal.dot(*p - c.v[0]);
            size = size.max(normal_size.dot((*p - c.v[0]).abs()));
            coordinate = coordinate.max(p.abs().max_element());
        }
        let place_error = POINT_ROUNDING * coordinate;
        let height = Bernstein::new(&heights[..points.len()]);
        let of_points = normal.abs().element_sum() * place_error;
        let zero = TERM_ROUNDING * size + VALUE_ROUNDING * height.size() + of_points;
        Plane { normal, normal_size, height, zero, place_error }
    }

    /// The meeting at a root of the plane, if it is inside the triangle.
    fn meeting(&self, curve: &Curve, c: &Corners, root: Root) -> Option<Meeting> {
        let at = curve.at(root.t);
        // the curve's places are as exact as its points, evaluated with three levels of rounding
        let coordinate = curve.points().iter().fold(0.0_f64, |m, p| m.max(p.abs().max_element()));
        let blur = blur(&self.height, self.zero, root.t);
        let drift =
            (curve.at((root.t + blur).min(1.0)) - at).length().max((curve.at((root.t - blur).max(0.0)) - at).length());
        let reach = 2.0 * drift + 3.0 * (self.place_error + VALUE_ROUNDING * coordinate);
        let mut weight = [0.0; 3];
        for (k, (i, j, sense)) in OPPOSITE.into_iter().enumerate() {
            let (from, edge) = (c.v[i] - at, c.v[j] - c.v[i]);
            let area = from.cross(edge).dot(self.normal) * f64::from(sense);
            let tolerance = reach * edge.length() * self.normal.length()
                + 2.0 * TERM_ROUNDING * cross_size(from.abs(), edge.abs()).dot(self.normal_size);
            if area < -tolerance {
                return None;
            }
            weight[c.slot(k)] = area.max(0.0);
        }
        let sum: f64 = weight.iter().sum();
        let bary = if sum == 0.0 { [1.0 / 3.0; 2] } else { [weight[1] / sum, weight[2] / sum] };
        Some(Meeting { t: root.t, sign: root.sign * c.parity, bary })
    }
}

/// How far from `t` a polynomial may still be 0 on one side or the other, within a factor of 2, where values up to `zero` may be.
pub fn blur(height: &Bernstein, zero: f64, t: f64) -> f64 {
    let proven = |t: f64| !(0.0..=1.0).contains(&t) || height.at(t).abs() > zero;
    let mut blur = f64::EPSILON;
    while blur < 1.0 && !(proven(t - blur) && proven(t + blur)) {
        blur *= 2.0;
    }
    blur
}

/// Number of parts of a curve in its tree of boxes, by [`HALVINGS`].
const PARTS: usize = 1 << HALVINGS;
const HALVINGS: usize = 6;

/// Curves side by side as a tree of boxes: box 1 around all of them, those around the halves of box k's part in 2k and
/// 2k + 1, the last [`PARTS`] around their smallest parts.
#[derive(Debug, Clone)]
pub struct Sweep([(DVec3, DVec3); 2 * PARTS]);

impl Sweep {
    /// `None` around none. The curves are of one degree.
    pub fn around(curves: &[Curve]) -> Option<Sweep> {
        let curve = curves.first()?;
        let mut parts = [*curve; 2 * PARTS];
        for k in 1..PARTS {
            [parts[2 * k], parts[2 * k + 1]] = parts[k].split(0.5);
        }
        // at every t another curve is no farther from the first than its points are: Bernstein weights add up to 1
        let points = || curves.iter().flat_map(|c| c.points().iter().zip(curve.points()));
        let spread = points().fold(DVec3::ZERO, |m, (p, of_first)| m.max((p - of_first).abs()));
        // each halving has up to three halved sums (one rounding of the sum); and the points' own, and those of `spread`
        let coordinate = points().fold(0.0_f64, |m, (p, _)| m.max(p.abs().max_element()));
        let tolerance = spread + ((3.0 * HALVINGS as f64 + 2.0) * f64::EPSILON + POINT_ROUNDING) * coordinate;
        let mut boxes = [(DVec3::ZERO, DVec3::ZERO); 2 * PARTS];
        for k in (1..2 * PARTS).rev() {
            boxes[k] = if k < PARTS {
                let [(lo, hi), (lo2, hi2)] = [boxes[2 * k], boxes[2 * k + 1]];
                (lo.min(lo2), hi.max(hi2))
            } else {
                let points = parts[k].points();
                let (lo, hi) = points.iter().fold((points[0], points[0]), |(lo, hi), p| (lo.min(*p), hi.max(*p)));
                (lo - tolerance, hi + tolerance)
            };
        }
        Some(Sweep(boxes))
    }

    /// Where the first of the smallest parts begins, of those under box `k`, that is in range and whose box meets the given
    /// one.
    fn first(&self, k: usize, lo: DVec3, hi: DVec3, range: [f64; 2]) -> Option<f64> {
        let count = 1 << k.ilog2();
        let start = (k - count) as f64 / count as f64;
        let (a, b) = self.0[k];
        let meets = a.cmple(hi).all() && b.cmpge(lo).all();
        if !meets || start > range[1] || start + 1.0 / (count as f64) < range[0] {
            return None;
        }
        if k >= PARTS {
            return Some(start);
        }
        self.first(2 * k, lo, hi, range).or_else(|| self.first(2 * k + 1, lo, hi, range))
    }
}

impl Probe for Sweep {
    /// From the first part whose box meets the given one.
    fn span(&self, lo: DVec3, hi: DVec3, range: [f64; 2]) -> Option<[f64; 2]> {
        self.first(1, lo, hi, range).map(|start| [start, 1.0])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square_root_curve() -> Curve {
        // X = (2 t - 1, (2 t - 1)^2, 0): a parabola
        Curve::new(&[DVec3::new(-1.0, 1.0, 0.0), DVec3::new(0.0, -1.0, 0.0), DVec3::new(1.0, 1.0, 0.0)])
    }

    fn level(y: f64) -> Corners {
        Corners::new([DVec3::new(-3.0, y, -3.0), DVec3::new(3.0, y, -3.0), DVec3::new(0.0, y, 3.0)])
    }

    #[test]
    fn a_parabola_meets_levels_where_it_should() {
        for y in [0.01_f64, 0.25, 0.5, 0.81] {
            let found = meetings(&square_root_curve(), &level(y));
            let t = |x: f64| 0.5 * (x + 1.0);
            assert_eq!(found.len(), 2, "{y}");
            for (m, x) in found.iter().zip([-y.sqrt(), y.sqrt()]) {
                // f's values round to 1e-15 and its slope is 2 |x| 2 >= 0.4
                assert!((m.t - t(x)).abs() < 1e-14, "{} for {}", m.t, t(x));
                let v = [DVec3::new(-3.0, y, -3.0), DVec3::new(3.0, y, -3.0), DVec3::new(0.0, y, 3.0)];
                let on = v[0] * (1.0 - m.bary[0] - m.bary[1]) + v[1] * m.bary[0] + v[2] * m.bary[1];
                assert!((on - DVec3::new(x, y, 0.0)).length() < 1e-13);
            }
            // N = (6, 0, 0) x (3, 0, 6) points down: falling the curve runs along N, rising against it
            assert_eq!((found[0].sign, found[1].sign), (1, -1));
        }
        assert_eq!(meetings(&square_root_curve(), &level(1.0)).iter().map(|m| m.t).collect::<Vec<_>>(), [0.0, 1.0]);
        assert!(meetings(&square_root_curve(), &level(1.01)).is_empty());
        assert!(meetings(&square_root_curve(), &level(-0.01)).is_empty());
    }

    #[test]
    fn a_touch_is_a_meeting_without_a_side() {
        let found = meetings(&square_root_curve(), &level(0.0));
        assert_eq!(found.iter().map(|m| (m.t, m.sign)).collect::<Vec<_>>(), [(0.5, 0)]);
    }

    #[test]
    fn a_curve_in_the_plane_and_a_triangle_without_area_are_never_met() {
        let upright =
            Corners::new([DVec3::new(-3.0, -3.0, 0.0), DVec3::new(3.0, -3.0, 0.0), DVec3::new(0.0, 9.0, 0.0)]);
        assert!(meetings(&square_root_curve(), &upright).is_empty());
        let line = Corners::new([DVec3::new(-0.9, 0.1, -0.3), DVec3::new(0.1, 0.3, 0.1), DVec3::new(1.1, 0.5, 0.5)]);
        assert!(meetings(&square_root_curve(), &line).is_empty());
    }

    #[test]
    fn the_parts_of_a_sweep_hold_the_curve() {
        let c = Curve::new(&[DVec3::ZERO, DVec3::X, DVec3::new(-5.0, 2.0, 1.0), DVec3::new(3.0, 2.0, -7.0)]);
        let sweep = Sweep::around(&[c]).unwrap();
        for k in 0..=1000 {
            let t = f64::from(k) / 1000.0;
            let at = c.at(t);
            let [a, b] = sweep.span(at, at, [0.0, 1.0]).unwrap();
            assert!(a <= t && t <= b, "{t} in {a} {b}");
            assert!(sweep.span(at, at, [t, t]).is_some());
        }
        let far = DVec3::splat(99.0);
        assert!(sweep.span(far, far, [0.0, 1.0]).is_none());
    }

    #[test]
    fn a_sweep_around_several_curves_holds_them_all() {
        let a = Curve::new(&[DVec3::ZERO, DVec3::X, DVec3::new(3.0, 2.0, -7.0)]);
        let b = Curve::new(&[DVec3::new(0.1, 0.0, -0.2), DVec3::new(1.0, 0.3, 0.0), DVec3::new(3.0, 1.9, -7.0)]);
        let sweep = Sweep::around(&[a, b]).unwrap();
        let alone = Sweep::around(&[a]).unwrap();
        let meets = |sweep: &Sweep, c: &Curve, t: f64| sweep.span(c.at(t), c.at(t), [t, t]).is_some();
        let all: Vec<f64> = (0..=1000).map(|k| f64::from(k) / 1000.0).collect();
        assert!(all.iter().all(|&t| meets(&sweep, &a, t) && meets(&sweep, &b, t)));
        assert!(!all.iter().all(|&t| meets(&alone, &b, t)));
        assert!(Sweep::around(&[]).is_none());
    }
}

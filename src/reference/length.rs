//! Arc lengths of curves.

use crate::camera::curve::Curve;
use crate::geometry::bernstein::Bernstein;
use glam::DVec3;

/// Nodes and weights of Gauss and Legendre's rule of 5 points on [-1, 1]: 0 and +-sqrt(5 -+ 2 sqrt(10/7)) / 3.
const NODES: [(f64, f64); 5] = [
    (0.0, 128.0 / 225.0),
    (0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
    (-0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
    (0.906_179_845_938_664, 0.236_926_885_056_189_08),
    (-0.906_179_845_938_664, 0.236_926_885_056_189_08),
];

/// Halves add up to their whole within this share of the curve's length, or are halved again. A half's own error is some
/// 2^10 times smaller than the difference; some 50 stretches add up to far less than 1e-9 of the length.
const SHARE: f64 = 1e-12;

/// Most halvings: an interval of 2^-40 next to a place where the derivative nearly vanishes has negligible length.
const LEVELS: u32 = 40;

/// The length of the curve from 0 to `t`, within 1e-9 of itself: adaptive Gauss-Legendre over the speed |X'|, between the
/// places where that is least or greatest. At a cusp, where the speed has a corner, one of them lies.
pub fn arc_length(curve: &Curve, t: f64) -> f64 {
    let mut splits = vec![0.0];
    splits.extend(change_of_speed(curve).roots(0.0).iter().map(|r| r.t).filter(|r| 0.0 < *r && *r < t));
    splits.push(t);
    let stretches: Vec<[f64; 3]> = splits.windows(2).map(|c| [c[0], c[1], rule(curve, c[0], c[1])]).collect();
    let allowed = SHARE * stretches.iter().map(|s| s[2]).sum::<f64>();
    stretches.iter().map(|[a, b, whole]| refined(curve, [*a, *b], *whole, allowed, LEVELS)).sum()
}

/// `X' . X''` but for a positive factor: half the slope of the speed's square.
fn change_of_speed(curve: &Curve) -> Bernstein {
    let p = curve.points();
    let first: Vec<DVec3> = p.windows(2).map(|p| p[1] - p[0]).collect();
    let second: Vec<DVec3> = first.windows(2).map(|d| d[1] - d[0]).collect();
    match (first.as_slice(), second.as_slice()) {
        ([a0, a1, a2], [b0, b1]) => Bernstein::new(&[
            a0.dot(*b0),
            (2.0 * a1.dot(*b0) + a0.dot(*b1)) / 3.0,
            (a2.dot(*b0) + 2.0 * a1.dot(*b1)) / 3.0,
            a2.dot(*b1),
        ]),
        ([a0, a1], [b]) => Bernstein::new(&[a0.dot(*b), a1.dot(*b)]),
        _ => Bernstein::new(&[0.0, 0.0]),
    }
}

fn rule(curve: &Curve, a: f64, b: f64) -> f64 {
    let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
    half * NODES.iter().map(|(x, w)| w * curve.tangent(middle + half * x).length()).sum::<f64>()
}

fn refined(curve: &Curve, [a, b]: [f64; 2], whole: f64, allowed: f64, levels: u32) -> f64 {
    let m = 0.5 * (a + b);
    let (left, right) = (rule(curve, a, m), rule(curve, m, b));
    let off = (left + right - whole).abs();
    // halving does not mend NaN
    if levels == 0 || off <= allowed || off.is_nan() {
        return left + right;
    }
    refined(curve, [a, m], left, allowed, levels - 1) + refined(curve, [m, b], right, allowed, levels - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The promise of [`arc_length`].
    const PROMISE: f64 = 1e-9;

    fn assert_length(curve: &Curve, t: f64, expected: f64) {
        let found = arc_length(curve, t);
        assert!((found - expected).abs() <= PROMISE * expected, "{found} for {expected}");
    }

    #[test]
    fn straight_curves_of_any_degree_and_speed() {
        let (p, d) = (DVec3::new(3.0, -1.0, 2.0), DVec3::new(0.3, 0.4, 1.2));
        let line = Curve::new(&[p, p + d]);
        for m in 1..=3 {
            for t in [0.0, 1e-9, 0.25, 1.0] {
                assert_length(&line.elevated(m), t, 1.3 * t);
            }
        }
        // t^2 along a line, and out and back: the curve reverses at t = 1/2
        assert_length(&Curve::new(&[p, p, p + d]), 0.5, 0.25 * 1.3);
        assert_length(&Curve::new(&[p, p + d, p]), 1.0, 1.3);
        assert_eq!(arc_length(&Curve::new(&[p, p, p]), 1.0), 0.0);
    }

    #[test]
    fn a_parabola() {
        // (s, s^2) for s from 0 to 2: s sqrt(1 + 4 s^2) / 2 + asinh(2 s) / 4
        let c = Curve::new(&[DVec3::ZERO, DVec3::X, DVec3::new(2.0, 4.0, 0.0)]);
        for t in [1e-6, 0.1, 0.5, 1.0] {
            let s: f64 = 2.0 * t;
            assert_length(&c, t, 0.5 * s * (1.0 + 4.0 * s * s).sqrt() + 0.25 * (2.0 * s).asinh());
        }
    }

    #[test]
    fn a_cusp_anywhere() {
        for cusp in [0.5, 0.3, 0.123_456_789, 0.0, 1.0] {
            // (u^2, u^3) with u = t - cusp, by its blossom; speed |u| sqrt(4 + 9 u^2)
            let blossom = |u: [f64; 3]| {
                let u = u.map(|u| u - cusp);
                DVec3::new((u[0] * u[1] + u[1] * u[2] + u[2] * u[0]) / 3.0, u[0] * u[1] * u[2], 0.0)
            };
            let c = Curve::new(&[[0., 0., 0.], [0., 0., 1.], [0., 1., 1.], [1., 1., 1.]].map(blossom));
            let part = |u: f64| ((4.0 + 9.0 * u * u).powf(1.5) - 8.0) / 27.0;
            for t in [0.3, 0.6, 1.0_f64] {
                let expected = if t > cusp { part(cusp) + part(t - cusp) } else { part(cusp) - part(cusp - t) };
                assert_length(&c, t, expected);
            }
        }
    }

    #[test]
    fn a_length_that_overflows_ends_at_once() {
        let far = Curve::new(&[DVec3::ZERO, DVec3::splat(1e200), DVec3::X]);
        assert!(!arc_length(&far, 1.0).is_finite());
    }
}

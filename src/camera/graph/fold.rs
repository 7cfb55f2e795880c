//! Rays that cross: where a segment is inside out, objects appear mirrored, or twice.

use super::{Bend, Graph, Leg, Net};
use crate::arrays::MapEach;
use crate::parallel;
use glam::DVec3;

/// Sample places along a ray, and along a triangle's side, in the search for crossings.
const ALONG: usize = 16;
const ACROSS: usize = 4;

/// Relative rounding of the product below: some twenty roundings of 2^-53, of points as well as of their differences.
const ROUNDING: f64 = 1.0 / (1u64 << 47) as f64;

impl Graph {
    /// Number of pieces with rays that cross, inside the box if there is one, and number of all pieces. Connecting
    /// legs are treated as straight.
    pub fn folds(&self, within: Option<(DVec3, DVec3)>) -> (usize, usize) {
        let counts = |x: DVec3| within.is_none_or(|(lo, hi)| x.cmpge(lo).all() && x.cmple(hi).all());
        let legs: Vec<Leg> = self.legs.iter().flat_map(|leg| leg.bent(Bend::Straight(1))).collect();
        let crossed = |leg: &Leg| {
            let points = leg.points();
            let ends = [&points[0][..], &points[points.len() - 1][..]];
            let of_triangle = |t: &[u32; 3]| crosses(&self.net, ends, t, counts).then_some(1);
            parallel::reduce(&self.net.triangles, of_triangle, |a, b| a + b).unwrap_or(0)
        };
        (legs.iter().map(crossed).sum(), legs.len() * self.net.triangles.len())
    }
}

/// The piece maps image and t to space with the handedness of a pinhole, `D . (dX/dx x dX/dy) >= 0` with y down,
/// except where its rays cross. D is linear over the triangle and the product is constant there for one t.
fn crosses(net: &Net, [from, to]: [&[DVec3]; 2], triangle: &[u32; 3], counts: impl Fn(DVec3) -> bool) -> bool {
    let corner = triangle.map_each(|k| k as usize);
    let at = |t: f64| corner.map_each(|k| from[k].lerp(to[k], t));
    let d = corner.map_each(|k| to[k] - from[k]);
    let q = corner.map_each(|k| net.places_px[k]);
    let winding = (q[1] - q[0]).perp_dot(q[2] - q[0]).signum();
    (0..=ALONG).any(|k| {
        let x = at(k as f64 / ALONG as f64);
        let (e, g) = (x[1] - x[0], x[2] - x[0]);
        let area = winding * e.cross(g);
        let reach = x.iter().fold(0.0, |m: f64, v| m.max(v.length()));
        let bound = ROUNDING * (e.length() * g.length() + reach * (e.length() + g.length()));
        weights().any(|w| {
            let mean = |v: &[DVec3; 3]| w[0] * v[0] + w[1] * v[1] + w[2] * v[2];
            let d = mean(&d);
            d.dot(area) < -bound * d.length() && counts(mean(&x))
        })
    })
}

/// Barycentric weights all over a triangle.
fn weights() -> impl Iterator<Item = [f64; 3]> {
    let n = ACROSS as f64;
    (0..=ACROSS)
        .flat_map(move |i| (0..=ACROSS - i).map(move |j| [i as f64 / n, j as f64 / n, (ACROSS - i - j) as f64 / n]))
}

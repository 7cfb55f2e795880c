//! solve in f64, in a cell of curves: the images of a point, from the kernel's own bytes. Regions are halved while the hull of their control
//! points holds the point, which the kernel does not look at, and Newton's method ends the search.

use anamorph::internals::gpu::layout::{SolveCell, SolvePoint};
use glam::{DMat3, DVec3};

/// Sides of regions that Newton's method starts from, in u, v and s; roots closer to each other than this are one.
const SMALL: f64 = 1.0 / 256.0;
const ONE: f64 = 1e-7;

/// Regions at most; more are those of a point that a whole curve or area of places shows.
const MOST: usize = 20_000;

/// A cell about a point.
struct About<'c> {
    cell: &'c SolveCell,
    x: DVec3,
}

/// Places (u, v, s) within `lo` and `hi` whose curves pass through the point, of the polynomial without its rest; `None`: too many.
pub fn solve_cell(cell: &SolveCell, point: &SolvePoint, lo: DVec3, hi: DVec3) -> Option<Vec<DVec3>> {
    let v = |v: [f32; 3]| DVec3::from_array(v.map(f64::from));
    let x = v(point.hi) - v(cell.anchor_hi) + (v(point.lo) - v(cell.anchor_lo));
    let about = About { cell, x };
    let mut roots: Vec<DVec3> = Vec::new();
    let mut waiting = vec![(lo, hi)];
    for _ in 0..MOST {
        let Some((lo, hi)) = waiting.pop() else { return Some(roots) };
        if about.is_empty(lo, hi) {
            continue;
        }
        let side = hi - lo;
        if side.max_element() > SMALL {
            let axis = side.max_position();
            let (mut end, mut start) = (hi, lo);
            end[axis] = 0.5 * (lo[axis] + hi[axis]);
            start[axis] = end[axis];
            waiting.extend([(lo, end), (start, hi)]);
            continue;
        }
        let Some(root) = about.newton(0.5 * (lo + hi)) else { continue };
        // those beside the region are found from the next one
        let is_near = root.cmpge(lo - ONE).all() && root.cmple(hi + ONE).all();
        if is_near && !roots.iter().any(|r| (*r - root).abs().max_element() < ONE) {
            roots.push(root);
        }
    }
    None
}

impl About<'_> {
    /// Of 1, u, v, u v, u^2 and v^2: the cubic at s, and its slope.
    fn term(&self, i: usize, s: f64) -> [DVec3; 2] {
        let p = [0, 1, 2, 3].map(|k| {
            let [x, y, z, _] = self.cell.terms[4 * i + k].map(f64::from);
            DVec3::new(x, y, z)
        });
        [p[0] + s * (p[1] + s * (p[2] + s * p[3])), p[1] + s * (2.0 * p[2] + 3.0 * s * p[3])]
    }

    /// Where the curve of a place is from the point, and its slope along the curve.
    fn value(&self, u: f64, v: f64, s: f64) -> [DVec3; 2] {
        let shares = [1.0, u, v, u * v, u * u, v * v];
        let of = |k: usize| shares.iter().enumerate().map(|(i, share)| *share * self.term(i, s)[k]).sum::<DVec3>();
        [of(0) - self.x, of(1)]
    }

    fn slopes(&self, at: DVec3) -> DMat3 {
        let [u, v, uv, uu, vv] = [1, 2, 3, 4, 5].map(|i| self.term(i, at.z)[0]);
        DMat3::from_cols(
            u + at.y * uv + 2.0 * at.x * uu,
            v + at.x * uv + 2.0 * at.y * vv,
            self.value(at.x, at.y, at.z)[1],
        )
    }

    /// The control points of a region lie on one side of a plane through the point: one along the axes or across two slopes.
    fn is_empty(&self, lo: DVec3, hi: DVec3) -> bool {
        // quadratic in u and v: of three places of each, the middle control point is twice the middle less the mean of the ends
        let third = (hi.z - lo.z) / 3.0;
        let middle = 0.5 * (lo + hi);
        let cubic = |u: f64, v: f64| {
            let ([p0, d0], [p3, d3]) = (self.value(u, v, lo.z), self.value(u, v, hi.z));
            [p0, p0 + third * d0, p3 - third * d3, p3]
        };
        let control =
            |a: [[DVec3; 4]; 3]| [a[0], [0, 1, 2, 3].map(|k| 2.0 * a[1][k] - 0.5 * (a[0][k] + a[2][k])), a[2]];
        let rows = [lo.y, middle.y, hi.y].map(|v| control([lo.x, middle.x, hi.x].map(|u| cubic(u, v))));
        let net: Vec<DVec3> = (0..3).flat_map(|i| control([rows[0][i], rows[1][i], rows[2][i]])).flatten().collect();
        let j = self.slopes(middle);
        let across = [j.y_axis.cross(j.z_axis), j.z_axis.cross(j.x_axis), j.x_axis.cross(j.y_axis)];
        across.iter().chain(&[DVec3::X, DVec3::Y, DVec3::Z]).any(|n| {
            let rounding = 1e-14 * n.length() * (f64::from(self.cell.size) + self.x.length());
            let along = || net.iter().map(|p| p.dot(*n));
            along().all(|d| d > rounding) || along().all(|d| d < -rounding)
        })
    }

    fn newton(&self, mut at: DVec3) -> Option<DVec3> {
        for _ in 0..40 {
            let step = self.slopes(at).inverse() * self.value(at.x, at.y, at.z)[0];
            at -= step;
            if !at.is_finite() {
                return None;
            }
            if step.abs().max_element() < 1e-13 {
                return Some(at);
            }
        }
        None
    }
}

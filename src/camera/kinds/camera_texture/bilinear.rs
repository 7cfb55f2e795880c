//! The exact inverse of a grid of bilinear cells.

use super::{Base, Cell};
use crate::arrays::MapEach;
use crate::camera::boxes::{Boxes, around};
use crate::camera::{Ray, RayMap};
use glam::{DMat2, DVec2};

/// Cells, each the bilinear map of its (u, v) in [0, 1]^2, and the boxes around them, to find those that may hold an image place.
#[derive(Debug)]
pub struct Inverse {
    cells: Vec<Cell>,
    base: Base,
    boxes: Boxes,
}

/// How far beyond 0 and 1 a cell's u and v may be by rounding: a place on the border of two cells is in one at least. The
/// terms of the quadratic equation round to 2^-50 of a cell's size; a cell 2^-20 of the distances among its terms keeps
/// this.
const BORDER_ROUNDING: f64 = 1.0 / (1u64 << 30) as f64;

impl Inverse {
    pub fn new(cells: Vec<Cell>, base: Base) -> Inverse {
        let boxes = Boxes::new(cells.iter().map(bounds), 1);
        Inverse { cells, base, boxes }
    }

    pub fn len(&self) -> usize {
        self.cells.len()
    }

    /// Cells that are flipped over somewhere: the area's stretch is affine over a cell, so its sign at the corners tells.
    pub fn folded(&self) -> usize {
        let flipped = |cell: &&Cell| {
            let [a, b, c, d] = cell.to;
            [(a, b, c), (b, d, a), (c, a, d), (d, c, b)].iter().any(|&(at, x, y)| (x - at).perp_dot(y - at) <= 0.0)
        };
        self.cells.iter().filter(flipped).count()
    }

    /// The place in the undeformed view that is displaced to `q`, by the lowest-numbered cell.
    fn source(&self, q: DVec2) -> Option<DVec2> {
        self.boxes.first(q, &|k| {
            let cell = &self.cells[k];
            let uv = inverse(&cell.to, q)?;
            Some(cell.from[0] + uv * (cell.from[3] - cell.from[0]))
        })
    }
}

impl RayMap for Inverse {
    fn ray(&self, a: f64, b: f64) -> Option<Ray> {
        let place = self.source(DVec2::new(a, b))?;
        Some(Ray { origin: self.base.bundle.p[0], direction: self.base.direction(place) })
    }
}

/// (u, v) in [0, 1]^2 with `q = (1-u)(1-v) c0 + u(1-v) c1 + (1-u)v c2 + uv c3`; of two, the one where the cell is not flipped
/// over.
fn inverse(c: &[DVec2; 4], q: DVec2) -> Option<DVec2> {
    let (h, b, d, e) = (q - c[0], c[1] - c[0], c[2] - c[0], c[3] - c[1] - c[2] + c[0]);
    // h - v d is parallel to b + v e: v^2 (d x e) + v (d x b - h x e) - h x b = 0
    let roots = quadratic_roots([-h.perp_dot(b), d.perp_dot(b) - h.perp_dot(e), d.perp_dot(e)]);
    let stretch = |uv: DVec2| DMat2::from_cols(b + uv.y * e, d + uv.x * e);
    let place = |v: f64| {
        let along = b + v * e;
        let uv = DVec2::new((h - v * d).dot(along) / along.length_squared(), v);
        // one Newton step takes out what the roots' cancellation left
        let step = stretch(uv).inverse() * (h - uv.x * b - uv.y * d - uv.x * uv.y * e);
        if step.is_finite() { uv + step } else { uv }
    };
    let inside = |uv: &DVec2| (*uv - 0.5).abs().max_element() <= 0.5 + BORDER_ROUNDING;
    let found = roots.map_each(place);
    let mut inside = found.iter().filter(|uv| inside(uv));
    let first = inside.next()?;
    let best = if stretch(*first).determinant() > 0.0 { first } else { inside.next().unwrap_or(first) };
    Some(best.clamp(DVec2::ZERO, DVec2::ONE))
}

/// The real roots of `c0 + c1 x + c2 x^2`, ascending; NaN where there is none. Written without cancellation.
fn quadratic_roots([c0, c1, c2]: [f64; 3]) -> [f64; 2] {
    let half = -0.5 * (c1 + c1.signum() * (c1 * c1 - 4.0 * c2 * c0).sqrt());
    let (x, y) = (half / c2, c0 / half);
    if x > y { [y, x] } else { [x, y] }
}

/// The box around a displaced cell.
fn bounds(cell: &Cell) -> (DVec2, DVec2) {
    let (lo, hi) = around(&cell.to);
    // u and v may be outside [0, 1] at both ends
    let tolerance = (hi - lo) * (4.0 * BORDER_ROUNDING);
    (lo - tolerance, hi + tolerance)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_place_of_a_cell_is_found_again() {
        let v = DVec2::new;
        for c in [
            [v(0.0, 0.0), v(1.0, 0.0), v(0.0, 1.0), v(1.0, 1.0)],
            [v(0.1, 0.2), v(0.9, 0.1), v(0.2, 0.8), v(0.7, 1.1)],
            // two sides parallel, and nearly so
            [v(0.0, 0.0), v(1.0, 0.0), v(0.2, 1.0), v(0.5, 1.0)],
            [v(0.0, 0.0), v(1.0, 1e-13), v(0.2, 1.0), v(0.5, 1.0)],
            [v(0.0, 0.0), v(0.3, 0.3), v(-0.3, 0.3), v(0.05, 0.7)],
        ] {
            for (i, j) in (0..=16).flat_map(|i| (0..=16).map(move |j| (i, j))) {
                let (u, w) = (f64::from(i) / 16.0, f64::from(j) / 16.0);
                let q = (1.0 - w) * ((1.0 - u) * c[0] + u * c[1]) + w * ((1.0 - u) * c[2] + u * c[3]);
                let found = inverse(&c, q).unwrap_or_else(|| panic!("{c:?}: nothing at {u}, {w}"));
                // rounding of q, 2^-53, over the least stretch of these cells, which is over 1/20
                assert!((found - v(u, w)).length() < 1e-14 * 20.0, "{c:?}: {found}, not {u}, {w}");
            }
            assert!(inverse(&c, v(3.0, 0.5)).is_none() && inverse(&c, v(0.5, -2.0)).is_none());
        }
    }

    #[test]
    fn of_two_folded_branches_the_unfolded_one_is_seen() {
        // the lower right corner pulled over the upper left one: the cell folds along a parabola
        let c = [DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::splat(-0.5)];
        let found = inverse(&c, DVec2::splat(0.05)).unwrap();
        assert!(found.x < 0.3 && found.y < 0.3, "{found}");
    }

    #[test]
    fn memory_is_linear_in_cells_that_overlap() {
        // 90,000 cells that each cover half of the image
        let cell = |k: usize| {
            let by = DVec2::new((k % 300) as f64, (k / 300) as f64) / 600.0;
            let to = [DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::ONE].map(|c| 0.5 * c + by);
            Cell { from: to, to }
        };
        let cells: Vec<Cell> = (0..90_000).map(cell).collect();
        let boxes = Boxes::new(cells.iter().map(bounds), 1);
        for q in [DVec2::splat(0.1), DVec2::new(0.55, 0.2), DVec2::new(0.2, 0.9)] {
            let lowest = cells.iter().position(|c| inverse(&c.to, q).is_some());
            assert_eq!(boxes.first(q, &|k| inverse(&cells[k].to, q).map(|_| k)), lowest);
            assert!(lowest.is_some());
        }
        assert!(boxes.first(DVec2::splat(1.5), &Some).is_none());
    }
}

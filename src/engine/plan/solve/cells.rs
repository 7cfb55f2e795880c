//! What `solve` knows of a layer of curves: a cell for each leaf of its tree, 8 x 8 px over a span of t, as a polynomial that is quadratic in
//! the image and cubic in t, with bounds of what that leaves out ([`Bend`]). Cells without such bounds are left to the host.

use super::{LEAST, MOST, Origin, leaves};
use crate::arrays::MapEach;
use crate::camera::curve::{Bend, Curve, Curves};
use crate::camera::project::curved::{SPANS, span, tiles};
use crate::camera::project::tree::Tree;
use crate::camera::{Camera, TILE};
use crate::gpu::layout::{SolveCell, SolveImage, SolvePoint};
use crate::parallel;
use glam::{DVec2, DVec3};

/// The cells of a layer.
pub struct CellTable {
    /// By the number of their leaf.
    pub cells: Vec<SolveCell>,
    /// The leaf of each node of the layer's tree; [`crate::gpu::layout::NONE`] of those that are no leaves.
    pub leaves: Vec<u32>,
    origin: Origin,
}

/// Flags of a cell, as in the kernel.
const SOLVABLE: u32 = 1;
const OUTER: u32 = 2;

/// Half a tile, px: 1 of u and v.
const HALF_PX: f64 = TILE as f64 / 2.0;

/// How far beyond a tile, in u and v, and a span, in s, terms and bounds hold: as in the kernel, 9/16 px and 1/16 of the span.
const MARGIN: f64 = 9.0 / 64.0;
const MARGIN_S: f64 = 1.0 / 8.0;

/// Weights of a cubic's control points at a t up to 1/128 beyond its ends have magnitudes that add up to less: (1 + 1/64)^3.
const BEYOND_ENDS: f64 = 1.05;

/// A ray that misses a point by this much of a pixel's footprint, the host may take for one through it (by half as much: `newton`).
const MISS_PX: f64 = 2e-7;

/// Of the terms 1, u, v, u v, u^2 and v^2.
const DEGREES: [i32; 6] = [0, 1, 1, 2, 2, 2];

/// Bound of the rounding of places in the world on the host, relative to the largest number, and of what else its search takes for none: 256
/// times 2^-52 of the point and of the curve.
const ROUNDING: f64 = 1.0 / (1u64 << 42) as f64;

impl CellTable {
    /// Of a layer of the camera, and its tree.
    pub fn new(camera: &Camera, curves: &Curves, tree: &Tree) -> CellTable {
        let tiles = tiles(curves);
        // no other range is cut into these spans
        let is_whole = camera.t_range == [0.0, 1.0];
        let all: Vec<Option<Tile>> = parallel::map(0..tiles.x * tiles.y, |k| Tile::new(curves, k).filter(|_| is_whole));
        let longest = all.iter().flatten().map(Tile::length).fold(0.0, f64::max);
        let origin = Origin::new(tree.anchor, longest);
        let cell = |k: u32| {
            let tile = all[(k / SPANS) as usize].as_ref();
            tile.and_then(|tile| tile.cell(k % SPANS, &origin)).unwrap_or(bytemuck::Zeroable::zeroed())
        };
        let cells = parallel::map(0..tiles.x * tiles.y * SPANS, cell);
        CellTable { cells, leaves: leaves(tree), origin }
    }

    /// A point about the anchor.
    pub fn point(&self, point: DVec3) -> SolvePoint {
        self.origin.point(point)
    }

    /// Cells that f32 and bounds hold for.
    pub fn solvable(&self) -> usize {
        self.cells.iter().filter(|c| c.flags & SOLVABLE != 0).count()
    }

    /// Where an image lies, px.
    pub fn place_px(&self, image: &SolveImage) -> DVec2 {
        let cell = &self.cells[image.piece as usize];
        let base = DVec2::new(cell.base_x.into(), cell.base_y.into());
        base + DVec2::new(image.x_px.into(), image.y_px.into())
    }
}

/// Curves of a tile with its margin, and how far all are from quadratic ones.
struct Tile {
    /// Row by row from above, in each the left one, the middle one and the right one.
    samples: Vec<Curve>,
    /// px: the middle of the tile, whole or cut off by the image's border.
    base: DVec2,
    /// Greatest u and v.
    end: DVec2,
    /// Left, above, right, below: no tile follows.
    is_last: [bool; 4],
    /// By (u, v), world units.
    bend: Bend,
}

impl Tile {
    /// `None` where there are no bounds, or no curves.
    fn new(curves: &Curves, number: u32) -> Option<Tile> {
        let columns = tiles(curves).x;
        let size = DVec2::new(curves.width.into(), curves.height.into());
        let base = f64::from(TILE) * DVec2::new((number % columns).into(), (number / columns).into()) + HALF_PX;
        let reach = (1.0 + MARGIN) * HALF_PX;
        let bend = curves.map.bend([(base - reach) / size, (base + reach) / size])?;
        let bend = bend.scaled(HALF_PX / size.x, HALF_PX / size.y);
        let sample = |k: u32| {
            let share = DVec2::new((k % 3).into(), (k / 3).into()) - 1.0;
            Some(curves.at_place(base + reach * share)?.1)
        };
        let samples = (0..9).map(sample).collect::<Option<_>>()?;
        let end = ((size - base) / HALF_PX).min(DVec2::ONE);
        let last = (base + HALF_PX).cmpge(size);
        let is_last = [base.x < f64::from(TILE), base.y < f64::from(TILE), last.x, last.y];
        Some(Tile { samples, base, end, is_last, bend })
    }

    /// Of the longest curve, world units.
    fn length(&self) -> f64 {
        let length =
            |c: &Curve| c.points().iter().map(|p| (*p - c.points()[0]).abs().max_element()).fold(0.0, f64::max);
        self.samples.iter().map(length).fold(0.0, f64::max)
    }

    /// Over the `k`-th span; `None` where f32 does not hold it.
    fn cell(&self, k: u32, origin: &Origin) -> Option<SolveCell> {
        let [t0, t1] = span(k);
        let middle = 0.5 * (t0 + t1);
        let all: Vec<[DVec3; 4]> = self.samples.iter().map(|c| powers(c, middle, t1)).collect();
        let e = 1.0 + MARGIN;
        let of = |shares: [f64; 9], over: f64| -> [DVec3; 4] {
            [0, 1, 2, 3].map_each(|k| all.iter().zip(shares).map(|(p, share)| share * p[k]).sum::<DVec3>() / over)
        };
        // 1, u, v, u v, u^2 and v^2 by the samples, which lie at -e, 0 and e
        let mut terms = [
            all[4],
            of([0., 0., 0., -1., 0., 1., 0., 0., 0.], 2.0 * e),
            of([0., -1., 0., 0., 0., 0., 0., 1., 0.], 2.0 * e),
            of([1., 0., -1., 0., 0., 0., -1., 0., 1.], 4.0 * e * e),
            of([0., 0., 0., 1., -2., 1., 0., 0., 0.], 2.0 * e * e),
            of([0., 1., 0., 0., -2., 0., 0., 1., 0.], 2.0 * e * e),
        ];
        let ([anchor_hi, anchor_lo], at) = origin.split(terms[0][0]);
        let world = (at.abs().max_element() + self.length()) / origin.unit;
        terms[0][0] -= at;
        terms.iter_mut().flatten().for_each(|v| *v /= origin.unit);
        let along = |i: usize| {
            let share = |k: usize| (1.0 + MARGIN_S).powi(k as i32) * terms[i][k].length();
            e.powi(DEGREES[i]) * (0..4).map(share).sum::<f64>()
        };
        let size = (0..6).map(along).sum::<f64>() + ROUNDING * world;
        if !(world < MOST && size < MOST && size > LEAST) {
            return None;
        }

        // Taylor's rest of degree 3 is within `most` e^3 anywhere, and within e^3 / 6 of a third derivative at the four samples beside the
        // middle one. What the terms make of its values at the samples is within the sum of theirs; the rest here is the two together.
        let b = self.bend.times(BEYOND_ENDS / origin.unit);
        let most = (b.aaa + 3.0 * b.aab + 3.0 * b.abb + b.bbb) / 6.0;
        let rest = e * e * e * (2.0 * most + (b.aaa + b.bbb) / 3.0);
        let rest_u = e * e * (most + b.aaa + b.aab + 0.5 * b.abb);
        let rest_v = e * e * (most + b.bbb + b.abb + 0.5 * b.aab);
        // a cubic's slope is three times a difference of control points; s is 16 t
        let rest_s = 6.0 / f64::from(2 * SPANS) * rest;
        let slopes = (1..6).map(|i| f64::from(DEGREES[i]) * along(i) / e).sum::<f64>();
        let px = (slopes + rest_u + rest_v) / HALF_PX;
        let missed = MISS_PX * px + ROUNDING * world;
        let rounding = ROUNDING * world;
        let errors = [rest + missed, rest_u + rounding, rest_v + rounding, rest_s + rounding];
        let outer = [self.is_last[0], self.is_last[1], k == 0, self.is_last[2], self.is_last[3], k + 1 == SPANS];
        let flags = (0..6).filter(|k| outer[*k]).fold(SOLVABLE, |flags, k| flags | OUTER << k);
        let mut packed = [[0.0; 4]; 24];
        packed.iter_mut().zip(terms.iter().flatten()).for_each(|(to, v)| *to = v.as_vec3().extend(0.0).to_array());
        Some(SolveCell {
            terms: packed,
            anchor_hi,
            base_x: self.base.x as i32,
            anchor_lo,
            base_y: self.base.y as i32,
            errors: errors.map_each(|x| (1.001 * x) as f32),
            end: self.end.as_vec2().to_array(),
            size: (1.001 * size) as f32,
            flags,
            middle: middle as f32,
            pad0: 0,
            pad1: 0,
            pad2: 0,
        })
    }
}

/// Of a curve by s, which is 0 at `middle` and 1 at `end`: `p[0] + s (p[1] + s (p[2] + s p[3]))`.
fn powers(curve: &Curve, middle: f64, end: f64) -> [DVec3; 4] {
    let half = curve.elevated(3).span([middle, end]);
    let [a, b, c, d] = [0, 1, 2, 3].map_each(|k| half.points()[k]);
    [a, 3.0 * (b - a), 3.0 * (c - 2.0 * b + a), d - 3.0 * (c - b) - a]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::curve::CurveMap;
    use std::sync::Arc;

    /// Bent in the image by known derivatives.
    #[derive(Debug)]
    struct Bowl;

    impl CurveMap for Bowl {
        fn degree(&self) -> usize {
            2
        }

        fn curve(&self, a: f64, b: f64) -> Option<(u32, Curve)> {
            let bowl = DVec3::Z * (a * a * b + a * a * a + (3.0 * b).sin());
            let p = DVec3::new(a, -b, 0.0);
            Some((0, Curve::new(&[p + bowl, 2.0 * p + DVec3::new(0.3, 0.1, -1.0), 3.0 * p - 4.0 * DVec3::Z + bowl])))
        }

        fn bend(&self, _: [DVec2; 2]) -> Option<Bend> {
            Some(Bend { aaa: 6.0, aab: 2.0, abb: 0.0, bbb: 27.0 })
        }
    }

    #[test]
    fn cells_hold_their_curves_and_slopes_within_their_errors() {
        let curves = Curves::new(44, 30, Arc::new(Bowl));
        let camera = Camera::of("projector", (44, 30), [0.0, 1.0], crate::camera::Rays::Curves(curves.clone()));
        let tree = Tree::new(Vec::new(), [0.0, 1.0]);
        let table = CellTable::new(&camera, &curves, &tree);
        let unit = table.origin.unit;
        let mut share = [0.0_f64; 4];
        for (k, cell) in table.cells.iter().enumerate() {
            assert_eq!(cell.flags & SOLVABLE, SOLVABLE, "{k}");
            let v = |v: [f32; 3]| DVec3::from_array(v.map(f64::from));
            let at = |u: f64, v_: f64, s: f64| {
                let of = |i: usize| {
                    (0..4).rev().fold(DVec3::ZERO, |m, k| {
                        s * m + DVec3::from_array([0, 1, 2].map(|c| f64::from(cell.terms[4 * i + k][c])))
                    })
                };
                v(cell.anchor_hi)
                    + v(cell.anchor_lo)
                    + of(0)
                    + u * of(1)
                    + v_ * of(2)
                    + u * v_ * of(3)
                    + u * u * of(4)
                    + v_ * v_ * of(5)
            };
            let seen = |u: f64, v: f64, s: f64| {
                let place = DVec2::new(f64::from(cell.base_x) + 4.0 * u, f64::from(cell.base_y) + 4.0 * v);
                let t = f64::from(cell.middle) + s / 16.0;
                (curves.at_place(place).unwrap().1.at(t) - table.origin.anchor) / unit
            };
            let off = |u: f64, v: f64, s: f64| seen(u, v, s) - at(u, v, s);
            let rounding = 8.0 * 2f64.powi(-24) * f64::from(cell.size);
            for n in 0..125 {
                let place = [n % 5, n / 5 % 5, n / 25].map(|k| f64::from(k) / 2.0 - 1.0);
                let [u, v, s] = [1.14 * place[0], 1.14 * place[1], 1.12 * place[2]];
                let step = 1e-4;
                let slopes = [
                    (off(u + step, v, s) - off(u - step, v, s)) / (2.0 * step),
                    (off(u, v + step, s) - off(u, v - step, s)) / (2.0 * step),
                    (off(u, v, s + step) - off(u, v, s - step)) / (2.0 * step),
                ];
                let all = [off(u, v, s), slopes[0], slopes[1], slopes[2]].map(DVec3::length);
                for c in 0..4 {
                    let bound = f64::from(cell.errors[c]);
                    assert!(all[c] <= bound + rounding + 1e-9, "{k}: {c}: {} {bound}", all[c]);
                    share[c] = share[c].max(all[c] / (bound + rounding));
                }
                assert!(at(u, v, s).distance(at(0.0, 0.0, 0.0)) <= f64::from(cell.size));
            }
        }
        // the bounds are not far off: Taylor's rest counts twice, and the middle control points bend less
        assert!(share.iter().zip([0.05, 0.1, 0.1, 0.02]).all(|(s, least)| *s > least), "{share:?}");
    }
}

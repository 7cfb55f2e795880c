//! The curves of a layer through a point.
//!
//! A curve lies in the box of its control points. Such boxes over tiles of the image, for each of a few spans of t, rule
//! most of the volume out; what is left is cut, in the image or in t, whichever is longer in space, until it is small.

use super::newton::{self, Volume};
use super::tree::{Bound, TILE, Tree};
use super::{BORDER_PX, Found, Shown};
use crate::camera::curve::{Curve, Curves};
use glam::{DVec2, DVec3};

/// Curves, and bounds over their tiles.
pub struct Search<'a> {
    curves: &'a Curves,
    tree: Tree<Boxes>,
}

/// Spans of t that a tile has boxes for: a power of 2.
const SPANS: usize = 8;

/// Boxes around all curves of a tile, span by span, and how far curves between four places may be from bilinear ones.
#[derive(Debug, Clone)]
struct Boxes {
    spans: [[DVec3; 2]; SPANS],
    bulge: f64,
    /// The largest distance between neighbouring curves.
    step: f64,
}

/// Times that a cell of a pixel is halved, and that t is: a curve of 2^10 times its neighbours' distance takes ten more
/// of t than of the image.
const HALVINGS: u32 = 2;
const T_HALVINGS: u32 = 40;

impl Volume for Curves {
    fn at(&self, place_px: DVec2, t: f64) -> Option<(DVec3, DVec3)> {
        let (_, curve) = self.at_place(place_px)?;
        Some((curve.at(t), curve.tangent(t)))
    }

    fn size(&self, place_px: DVec2, _: f64) -> f64 {
        let curve = self.at_place(place_px);
        curve.map_or(0.0, |(_, c)| c.points().iter().fold(0.0, |m, p| p.length().max(m)))
    }
}

impl<'a> Search<'a> {
    pub fn new(curves: &'a Curves) -> Search<'a> {
        Search { curves, tree: Tree::build(curves.width, curves.height, |x, y| bound(curves, x, y)) }
    }

    pub fn images(&self, point: DVec3) -> Shown {
        let mut shown = Shown::default();
        let may = |b: &Boxes| b.spans.iter().any(|s| holds(s, b.bulge + b.step, point));
        self.tree.walk(may, |x, y, boxes| {
            for (i, j) in cells(self.curves, x, y) {
                let at = DVec2::new(i.into(), j.into());
                let curves = corners(at, 1.0).map(|q| self.curves.at_place(q).map(|c| c.1));
                let middle = self.curves.at_place(at + 0.5).map(|c| c.1);
                let bulge = bulge(&curves, &middle).unwrap_or(boxes.bulge);
                let cell = Cell { at, side: 1.0, bulge, step: boxes.step, halvings: HALVINGS };
                self.search(point, &cell, curves, [0.0, 1.0], T_HALVINGS, &mut shown);
            }
        });
        shown
    }

    /// `curves` are those of the cell's corners over the `span` of t.
    fn search(
        &self,
        point: DVec3,
        cell: &Cell,
        curves: [Option<Curve>; 4],
        span: [f64; 2],
        t_halvings: u32,
        shown: &mut Shown,
    ) {
        let Some(around) = around(&curves) else { return };
        // where a corner has no curve the others may stand for one a step away
        let gap = if curves.iter().all(Option::is_some) { 0.0 } else { cell.step };
        if !holds(&around, cell.bulge + gap, point) {
            return;
        }
        let long = curves.iter().flatten().fold(0.0_f64, |m, c| m.max(length(c)));
        let wide = spread(&curves);
        if t_halvings > 0 && long > wide.max(cell.bulge + gap) {
            let middle = 0.5 * (span[0] + span[1]);
            let halves = curves.map(|c| c.map(|c| c.split(0.5)));
            for (k, span) in [[span[0], middle], [middle, span[1]]].into_iter().enumerate() {
                self.search(point, cell, halves.map(|c| c.map(|c| c[k])), span, t_halvings - 1, shown);
            }
        } else if cell.halvings > 0 {
            let half = 0.5 * cell.side;
            for at in corners(cell.at, half) {
                let curves = corners(at, half).map(|q| self.part(q, span));
                let (bulge, step) = (cell.bulge / 4.0, cell.step / 2.0);
                let cell = Cell { at, side: half, bulge, step, halvings: cell.halvings - 1 };
                self.search(point, &cell, curves, span, t_halvings, shown);
            }
        } else {
            self.solve(point, cell, span, shown);
        }
    }

    /// The curve at a place over a span of t.
    fn part(&self, place: DVec2, [t0, t1]: [f64; 2]) -> Option<Curve> {
        let (_, curve) = self.curves.at_place(place)?;
        let [before, _] = curve.split(t1);
        Some(before.split(t0 / t1)[1])
    }

    /// Newton's method from the cell's middle and its corners, in the middle of the span.
    fn solve(&self, point: DVec3, cell: &Cell, [t0, t1]: [f64; 2], shown: &mut Shown) {
        let end = DVec2::new(self.curves.width.into(), self.curves.height.into());
        for from in corners(cell.at, cell.side).into_iter().chain([cell.at + 0.5 * cell.side]) {
            let Some(root) = newton::solve(self.curves, point, from, 0.5 * (t0 + t1)) else { continue };
            let slack = DVec2::splat(BORDER_PX);
            if root.place.cmplt(-slack).any() || root.place.cmpgt(end + slack).any() {
                continue;
            }
            let place = root.place.clamp(DVec2::ZERO, end);
            match (root.degenerate, self.curves.at_place(place)) {
                (None, Some((piece, _))) => shown.found.push(Found { place, t: root.t, piece }),
                (degenerate, _) => shown.degenerate = shown.degenerate.max(degenerate),
            }
        }
    }
}

/// A square of the image.
struct Cell {
    at: DVec2,
    side: f64,
    bulge: f64,
    /// How far a curve may be from the next corner's.
    step: f64,
    halvings: u32,
}

fn corners(at: DVec2, side: f64) -> [DVec2; 4] {
    [DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::ONE].map(|c| at + side * c)
}

/// Columns and rows of the pixels of a tile.
fn cells(curves: &Curves, x: u32, y: u32) -> impl Iterator<Item = (u32, u32)> + use<> {
    let [columns, rows] =
        [(x * TILE, curves.width), (y * TILE, curves.height)].map(|(from, end)| from..(from + TILE).min(end));
    rows.flat_map(move |j| columns.clone().map(move |i| (i, j)))
}

fn holds([lo, hi]: &[DVec3; 2], bulge: f64, point: DVec3) -> bool {
    let room = bulge + 64.0 * f64::EPSILON * (point.abs().max_element() + lo.abs().max(hi.abs()).max_element());
    (*lo - room).cmple(point).all() && (*hi + room).cmpge(point).all()
}

/// The box around all control points.
fn around(curves: &[Option<Curve>]) -> Option<[DVec3; 2]> {
    let points = curves.iter().flatten().flat_map(|c| c.points());
    points.fold(None, |b: Option<[DVec3; 2]>, p| Some(b.map_or([*p, *p], |[lo, hi]| [lo.min(*p), hi.max(*p)])))
}

/// The way along the control points.
fn length(c: &Curve) -> f64 {
    c.points().windows(2).map(|p| (p[1] - p[0]).length()).sum()
}

/// The largest distance between control points of one number.
fn spread(curves: &[Option<Curve>; 4]) -> f64 {
    let apart =
        |a: &Curve, b: &Curve| a.points().iter().zip(b.points()).fold(0.0_f64, |m, (a, b)| m.max((*a - *b).length()));
    let all: Vec<&Curve> = curves.iter().flatten().collect();
    let pairs = all.iter().enumerate().flat_map(|(k, a)| all[..k].iter().map(move |b| apart(a, b)));
    pairs.fold(0.0, f64::max)
}

/// How far curves between four may be from bilinear ones: twice as far as the one in the middle is.
fn bulge(corners: &[Option<Curve>; 4], middle: &Option<Curve>) -> Option<f64> {
    let [Some(a), Some(b), Some(c), Some(d)] = corners else { return None };
    let off = |(k, m): (usize, &DVec3)| {
        let mean = 0.25 * (a.points()[k] + b.points()[k] + c.points()[k] + d.points()[k]);
        2.0 * (*m - mean).length()
    };
    Some(middle.as_ref()?.points().iter().enumerate().map(off).fold(0.0, f64::max))
}

/// The curves of a tile's pixels, sampled at their corners and middles.
fn bound(curves: &Curves, x: u32, y: u32) -> Option<Boxes> {
    let empty = [DVec3::INFINITY, DVec3::NEG_INFINITY];
    let mut boxes = Boxes { spans: [empty; SPANS], bulge: 0.0, step: 0.0 };
    let mut any = false;
    for (i, j) in cells(curves, x, y) {
        let at = DVec2::new(i.into(), j.into());
        let corners = corners(at, 1.0).map(|q| curves.at_place(q).map(|c| c.1));
        let middle = curves.at_place(at + 0.5).map(|c| c.1);
        for curve in corners.iter().chain([&middle]).flatten() {
            boxes.hold(curve);
            any = true;
        }
        boxes.step = boxes.step.max(spread(&corners));
        boxes.bulge = boxes.bulge.max(bulge(&corners, &middle).unwrap_or(0.0));
    }
    any.then_some(boxes)
}

impl Boxes {
    fn hold(&mut self, curve: &Curve) {
        let mut parts = vec![*curve];
        while parts.len() < SPANS {
            parts = parts.iter().flat_map(|c| c.split(0.5)).collect();
        }
        for (span, part) in self.spans.iter_mut().zip(&parts) {
            *span = part.points().iter().fold(*span, |[lo, hi], p| [lo.min(*p), hi.max(*p)]);
        }
    }
}

impl Bound for Boxes {
    fn joined(mut self, other: &Boxes) -> Boxes {
        for ([lo, hi], [a, b]) in self.spans.iter_mut().zip(&other.spans) {
            (*lo, *hi) = (lo.min(*a), hi.max(*b));
        }
        Boxes { bulge: self.bulge.max(other.bulge), step: self.step.max(other.step), ..self }
    }
}

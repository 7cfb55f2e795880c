//! The curves of a layer through a point.
//!
//! A curve lies in the box of its control points. Such boxes over tiles of the image, for each of a few spans of t,
//! rule most of the volume out; what is left is cut, in the image or in t, whichever is longer in space, until it is
//! small.

use super::beam::Beam;
use super::newton::{self, Volume};
use super::samples::{MARGIN, SMOOTH, corners, least_slope, samples, squares};
use super::tree::{KEY_BITS, Leaf, Tree, place_key};
use super::{BORDER_PX, Degenerate, Found, NEWTON_WORK, Shown};
use crate::arrays::MapEach;
use crate::camera::TILE;
use crate::camera::curve::{Curve, Curves};
use crate::parallel;
use glam::{DVec2, DVec3, UVec2};

/// Curves, and beams along spans of them over tiles.
pub struct Search<'a> {
    curves: &'a Curves,
    /// Of each tile, row by row: between which curves all of its are, where it is smooth.
    nets: Vec<Option<Net>>,
    pub tree: Tree,
}

/// Spans of t that a tile's curves are cut into, each a leaf: a power of 2.
pub const SPANS: u32 = 1 << SPAN_HALVINGS;
const SPAN_HALVINGS: u32 = 3;

/// Most halvings of a pixel's cell.
const HALVINGS: u32 = 2;

/// Most halvings of t: curves that are then still longer than their distance (2^-40 of their length) meet in the point.
const T_HALVINGS: u32 = 40;

/// Four curves between which all are bilinear within [`Net::error_bound`], or one around which all of its neighbourhood are.
#[derive(Debug, Clone)]
struct Net {
    curves: Vec<Curve>,
    /// The one in the middle of four: tells how far others are from bilinear ones.
    middle: Option<Curve>,
    /// Of the whole net: other than what the middle tells it does not shrink with t's span.
    reach: f64,
}

/// A square of the image.
struct Cell {
    at: DVec2,
    side: f64,
    halvings: u32,
}

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
        let tiles = tiles(curves);
        let all = parallel::map(0..tiles.x * tiles.y, |tile| bound(curves, tile));
        let (nets, leaves): (Vec<_>, Vec<_>) = all.into_iter().unzip();
        Search { curves, nets, tree: Tree::new(leaves.concat(), [0.0, 1.0]) }
    }

    /// At and below the nodes `from` of the tree.
    pub(super) fn images(&self, point: DVec3, from: &[u32]) -> Shown {
        let mut shown = Shown::default();
        self.tree.walk(point, from, |leaf| {
            let (tile, whole) = (leaf / SPANS, (span(leaf % SPANS), T_HALVINGS - SPAN_HALVINGS));
            let Some(net) = &self.nets[tile as usize] else {
                let cells = pixels(self.curves, tile).map(|at| Cell { at, side: 1.0, halvings: HALVINGS });
                cells.for_each(|cell| self.search(point, &cell, whole.0, whole.1, None, &mut shown));
                return;
            };
            let mut spans = Vec::new();
            net.over(whole.0).spans_near(point, whole, &mut spans, &mut shown);
            let Some(first) = pixels(self.curves, tile).next() else { return };
            for (span, t_halvings) in spans {
                let mut near = Vec::new();
                net.over(span).pixels_near(point, first, f64::from(TILE), &mut near);
                for at in near.into_iter().filter(|at| at.cmplt(self.size()).all()) {
                    let cell = Cell { at, side: 1.0, halvings: HALVINGS };
                    self.search(point, &cell, span, t_halvings, None, &mut shown);
                }
            }
        });
        shown
    }

    /// Of the image, px.
    fn size(&self) -> DVec2 {
        DVec2::new(self.curves.width.into(), self.curves.height.into())
    }

    /// `known`: the nets of the cell over the `span` of t; `None`: they are taken here.
    fn search(
        &self,
        point: DVec3,
        cell: &Cell,
        span: [f64; 2],
        t_halvings: u32,
        known: Option<Vec<Net>>,
        shown: &mut Shown,
    ) {
        if !shown.may_spend(1) {
            return;
        }
        let mut nets = known.unwrap_or_else(|| {
            let nets = nets(self.curves, cell.at, cell.side);
            if span == [0.0, 1.0] { nets } else { nets.iter().map(|n| n.over(span)).collect() }
        });
        nets.retain(|n| contains(&n.around(), n.error_bound(), point));
        if nets.is_empty() {
            return;
        }
        if !nets.iter().all(Net::is_short) {
            if t_halvings == 0 {
                shown.degenerate = shown.degenerate.max(Some(Degenerate::Eye));
                return;
            }
            let middle = 0.5 * (span[0] + span[1]);
            for (k, span) in [[span[0], middle], [middle, span[1]]].into_iter().enumerate() {
                let half = nets.iter().map(|n| n.half(k)).collect();
                self.search(point, cell, span, t_halvings - 1, Some(half), shown);
            }
        } else if cell.halvings > 0 {
            let half = 0.5 * cell.side;
            for at in corners(cell.at, half) {
                let cell = Cell { at, side: half, halvings: cell.halvings - 1 };
                self.search(point, &cell, span, t_halvings, None, shown);
            }
        } else {
            self.solve(point, cell, span, shown);
        }
    }

    /// Newton's method from the cell's middle and its corners, in the middle of the span.
    fn solve(&self, point: DVec3, cell: &Cell, [t0, t1]: [f64; 2], shown: &mut Shown) {
        let end = self.size();
        for from in samples(cell.at, cell.side) {
            if !shown.may_spend(NEWTON_WORK) {
                return;
            }
            let Some(root) = newton::solve(self.curves, point, from, 0.5 * (t0 + t1)) else { continue };
            let tolerance = DVec2::splat(BORDER_PX);
            if root.place.cmplt(-tolerance).any() || root.place.cmpgt(end + tolerance).any() {
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

fn contains([lo, hi]: &[DVec3; 2], error: f64, point: DVec3) -> bool {
    let error = error + 64.0 * f64::EPSILON * (point.abs().max_element() + lo.abs().max(hi.abs()).max_element());
    (*lo - error).cmple(point).all() && (*hi + error).cmpge(point).all()
}

/// The curves of a square: one net where they are smooth; where they jump, fold or end, one for each sample.
fn nets(curves: &Curves, at: DVec2, side: f64) -> Vec<Net> {
    let places = samples(at, side);
    let found = places.map(|q| curves.at_place(q).map(|c| c.1));
    if let [Some(a), Some(b), Some(c), Some(d), Some(m)] = found {
        let net = Net { curves: vec![a, b, c, d], middle: Some(m), reach: 0.0 };
        if net.off(&m) <= SMOOTH * net.spread() {
            return vec![net];
        }
    }
    let slope = |(q, c): (DVec2, &Option<Curve>)| {
        let c = c.as_ref()?;
        Some(least_slope(q, |q| curves.at_place(q).map(|near| distance(&near.1, c))))
    };
    let steepest = places.into_iter().zip(&found).filter_map(slope).fold(0.0, f64::max);
    // with as much again for what bends
    let reach = 2.0 * side * steepest;
    found.into_iter().flatten().map(|c| Net { curves: vec![c], middle: None, reach }).collect()
}

impl Net {
    /// The box around all control points.
    fn around(&self) -> [DVec3; 2] {
        let points = self.curves.iter().flat_map(|c| c.points());
        points.fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[lo, hi], p| [lo.min(*p), hi.max(*p)])
    }

    /// The largest distance between control points of one number.
    fn spread(&self) -> f64 {
        let pairs =
            self.curves.iter().enumerate().flat_map(|(k, a)| self.curves[..k].iter().map(move |b| distance(a, b)));
        pairs.fold(0.0, f64::max)
    }

    /// The control polygons are not longer than the net is wide.
    fn is_short(&self) -> bool {
        let length = |c: &Curve| c.points().windows(2).map(|p| (p[1] - p[0]).length()).sum::<f64>();
        let long = self.curves.iter().map(length).fold(0.0, f64::max);
        long <= self.spread().max(self.error_bound())
    }

    /// How far curves between the four may be from bilinear ones: twice as far as the one in the middle is.
    fn off(&self, middle: &Curve) -> f64 {
        let off =
            |(k, m): (usize, &DVec3)| (*m - self.curves.iter().map(|c| c.points()[k]).sum::<DVec3>() / 4.0).length();
        2.0 * middle.points().iter().enumerate().map(off).fold(0.0, f64::max)
    }

    /// The first or the second half of t.
    fn half(&self, k: usize) -> Net {
        self.mapped(|c| c.split(0.5)[k])
    }

    /// Spans of t, halved until the net is short, over which it may run through the point, and the halvings left.
    fn spans_near(
        &self,
        point: DVec3,
        (span, t_halvings): ([f64; 2], u32),
        spans: &mut Vec<([f64; 2], u32)>,
        shown: &mut Shown,
    ) {
        if !shown.may_spend(1) || !contains(&self.around(), self.error_bound(), point) {
            return;
        }
        if self.is_short() {
            spans.push((span, t_halvings));
        } else if t_halvings == 0 {
            shown.degenerate = shown.degenerate.max(Some(Degenerate::Eye));
        } else {
            let middle = 0.5 * (span[0] + span[1]);
            for (k, span) in [[span[0], middle], [middle, span[1]]].into_iter().enumerate() {
                self.half(k).spans_near(point, (span, t_halvings - 1), spans, shown);
            }
        }
    }

    /// The corners of the pixels whose curves may run through the point, in the square that the net is of: quarter by
    /// quarter, without a look at the curves themselves.
    fn pixels_near(self, point: DVec3, at: DVec2, side: f64, near: &mut Vec<DVec2>) {
        if !contains(&self.around(), self.error_bound(), point) {
            return;
        }
        if side <= 1.0 {
            near.push(at);
            return;
        }
        let half = 0.5 * side;
        for (at, quarter) in corners(at, half).into_iter().zip(self.quarters()) {
            quarter.pixels_near(point, at, half, near);
        }
    }

    /// Left and right above, left and right below; each with the error bound of the whole.
    fn quarters(&self) -> [Net; 4] {
        let middle = |a: &Curve, b: &Curve| {
            let mut points = [DVec3::ZERO; 4];
            points.iter_mut().zip(a.points().iter().zip(b.points())).for_each(|(m, (a, b))| *m = a.midpoint(*b));
            Curve::new(&points[..=a.degree()])
        };
        let [a, b, c, d] = [0, 1, 2, 3].map_each(|k| self.curves[k]);
        let (ab, ac, bd, cd) = (middle(&a, &b), middle(&a, &c), middle(&b, &d), middle(&c, &d));
        let m = middle(&ab, &cd);
        let reach = self.error_bound();
        [[a, ab, ac, m], [ab, b, m, bd], [ac, m, c, cd], [m, bd, cd, d]].map_each(|curves| Net {
            curves: curves.to_vec(),
            middle: None,
            reach,
        })
    }

    fn over(&self, span: [f64; 2]) -> Net {
        self.mapped(|c| c.span(span))
    }

    fn mapped(&self, part: impl Fn(&Curve) -> Curve) -> Net {
        Net {
            curves: self.curves.iter().map(&part).collect(),
            middle: self.middle.as_ref().map(&part),
            reach: self.reach,
        }
    }

    /// Along the chords of the curves' spans, by as much off them as the control points between their ends are.
    fn beam(&self, span: [f64; 2]) -> Beam {
        let of = |c: &Curve| {
            let part = c.span(span);
            let (p, m) = (part.points(), part.degree());
            let chord = p[m] - p[0];
            let beam = Beam::about(p[0], chord, self.error_bound(), 0.0);
            let off = |k: usize| p[k] - p[0] - k as f64 / m as f64 * chord;
            let offs = (1..m).map(off).fold([DVec3::ZERO; 2], |[lo, hi], v| [lo.min(v), hi.max(v)]);
            Beam { p: [beam.p[0] + offs[0], beam.p[1] + offs[1]], ..beam }
        };
        self.curves.iter().map(of).fold(Beam::NONE, |a, b| a.joined(&b))
    }

    /// How far curves may be outside of what the net's control points hold.
    fn error_bound(&self) -> f64 {
        self.reach + MARGIN * self.spread() + self.middle.map_or(0.0, |m| self.off(&m))
    }
}

/// The largest distance between two curves' control points.
fn distance(a: &Curve, b: &Curve) -> f64 {
    a.points().iter().zip(b.points()).fold(0.0, |m, (a, b)| m.max((*a - *b).length()))
}

/// The `k`-th of the [`SPANS`].
pub fn span(k: u32) -> [f64; 2] {
    [k, k + 1].map_each(|k| f64::from(k) / f64::from(SPANS))
}

/// Tiles a row, and rows. The leaves of tile k, row by row, are those from `SPANS k` on.
pub fn tiles(curves: &Curves) -> UVec2 {
    UVec2::new(curves.width.div_ceil(TILE), curves.height.div_ceil(TILE))
}

/// The corners of a tile's pixels, px.
fn pixels(curves: &Curves, tile: u32) -> impl Iterator<Item = DVec2> + use<> {
    squares(tile, TILE, [curves.width, curves.height])
}

/// The curves of a tile's pixels: its net, and its leaves.
fn bound(curves: &Curves, tile: u32) -> (Option<Net>, Vec<Leaf>) {
    let pixels: Vec<DVec2> = pixels(curves, tile).collect();
    let all: Vec<Vec<Net>> = pixels.iter().map(|at| nets(curves, *at, 1.0)).collect();
    let place = place_key(pixels[0], DVec2::new(curves.width.into(), curves.height.into()));
    let net = tile_net(curves, pixels[0], &pixels, &all);
    let bounds: Vec<&Net> = net.as_ref().map_or_else(|| all.iter().flatten().collect(), |net| vec![net]);
    let leaf = |k: u32| {
        let beam = bounds.iter().map(|n| n.beam(span(k))).reduce(|a, b| a.joined(&b))?;
        // span by span: beams of one span are nearer to each other than those of one place
        Some(Leaf { key: u64::from(k) << (2 * KEY_BITS) | place, number: tile * SPANS + k, beam })
    };
    let leaves = (0..SPANS).filter_map(leaf).collect();
    (net, leaves)
}

/// The curves at a tile's corners, with as much margin as those of its pixels are off what is bilinear between them;
/// `None` where some are not smooth.
fn tile_net(curves: &Curves, at: DVec2, pixels: &[DVec2], all: &[Vec<Net>]) -> Option<Net> {
    let side = f64::from(TILE);
    let corner = |q: DVec2| Some(curves.at_place(q)?.1);
    let [a, b, c, d, _] = samples(at, side);
    let whole = Net { curves: vec![corner(a)?, corner(b)?, corner(c)?, corner(d)?], middle: None, reach: 0.0 };
    let mut reach = 0.0_f64;
    for (pixel, nets) in pixels.iter().zip(all) {
        let [net @ Net { curves, middle: Some(_), .. }] = nets.as_slice() else { return None };
        for (place, curve) in samples(*pixel, 1.0).iter().zip(curves) {
            let q = (place - at) / side;
            let shares = [(1.0 - q.x) * (1.0 - q.y), q.x * (1.0 - q.y), (1.0 - q.x) * q.y, q.x * q.y];
            let off = |(k, p): (usize, &DVec3)| {
                let bilinear = whole.curves.iter().zip(shares).map(|(c, share)| share * c.points()[k]).sum::<DVec3>();
                (*p - bilinear).length()
            };
            reach = curve.points().iter().enumerate().map(off).fold(reach, |m, off| m.max(off + net.error_bound()));
        }
    }
    Some(Net { reach, ..whole })
}

//! The rays of a field through a point.
//!
//! A ray meets X where `E = (X - P) x D` is 0. Bounds of P and D over tiles rule most of the image out; in a cell
//! between four places P and D are taken as bilinear, so E is biquadratic, and where all its Bernstein coefficients of
//! one component have one sign there is no root in the cell. What is left is cut down to quarters of a pixel.

use super::beam::Beam;
use super::newton::{self, Volume};
use super::samples::{MARGIN, SMOOTH, corners, least_slope, samples, squares};
use super::tree::{Leaf, Tree, place_key};
use super::{BORDER_PX, Degenerate, Found, NEWTON_WORK, Shown};
use crate::arrays::MapEach;
use crate::camera::bundle::Ray;
use crate::camera::field::Field;
use crate::parallel;
use glam::{DVec2, DVec3};

/// A field, and beams over squares of its cells.
pub struct Search<'a> {
    field: &'a Field,
    /// The image place of the first cell's corner, px, and the cells that follow it.
    start: DVec2,
    cells: [u32; 2],
    /// Cells per side of a leaf.
    side: u32,
    pub tree: Tree,
}

/// Leaves at most, but for rounding at the image's borders: 100 bytes each. A leaf has one cell in images up to that.
const LEAVES: u32 = 1 << 18;

/// Four rays between which origins and directions are bilinear within the error bounds, or one around which all of its
/// neighbourhood are.
struct Net {
    rays: [Ray; 4],
    p_error: f64,
    d_error: f64,
    /// The four are the ray of one sample.
    is_lone: bool,
}

/// Times that a cell of a pixel is halved.
const HALVINGS: u32 = 2;

/// E within this of the product of its terms is nothing: the rays meet in the point.
pub const NOTHING: f64 = 1.0 / (1u64 << 40) as f64;

impl Volume for Field {
    fn at(&self, place_px: DVec2, t: f64) -> Option<(DVec3, DVec3)> {
        // a table stands still beyond its outer pixel centres, which says nothing about its slope there
        let (lo, hi) = (DVec2::splat(0.5), DVec2::new(self.width.into(), self.height.into()) - 0.5);
        if self.map().is_none() && (place_px.cmplt(lo - BORDER_PX).any() || place_px.cmpgt(hi + BORDER_PX).any()) {
            return None;
        }
        let ray = self.ray_at(place_px)?;
        Some((ray.origin + t * ray.direction, ray.direction))
    }

    fn size(&self, place_px: DVec2, t: f64) -> f64 {
        self.ray_at(place_px).map_or(0.0, |r| r.origin.length() + t.abs() * r.direction.length())
    }
}

impl<'a> Search<'a> {
    pub fn new(field: &'a Field, t_range: [f64; 2]) -> Search<'a> {
        let mut search = Search::of_closed_form(field, t_range);
        let columns = search.cells[0].div_ceil(search.side);
        let leaves = parallel::flat_map(0..columns * search.cells[1].div_ceil(search.side), |k| search.leaf(k));
        search.tree = Tree::new(leaves, t_range);
        search
    }

    /// Without beams: for [`Search::closed_form`] alone.
    pub fn of_closed_form(field: &'a Field, t_range: [f64; 2]) -> Search<'a> {
        // a table is bilinear between pixel centres, a formula holds all over the image
        let (start, cells) = match field.map() {
            Some(_) => (DVec2::ZERO, [field.width, field.height]),
            None => (DVec2::splat(0.5), [field.width - 1, field.height - 1]),
        };
        let mut side = 1;
        while cells[0].div_ceil(side) * cells[1].div_ceil(side) > LEAVES {
            side *= 2;
        }
        Search { field, start, cells, side, tree: Tree::new(Vec::new(), t_range) }
    }

    /// The images by the formula of the rays; `None` where it has no closed form for this point.
    pub fn closed_form(&self, point: DVec3) -> Option<Shown> {
        let all = self.field.map()?.images(point)?;
        let mut shown = Shown::default();
        let size = DVec2::new(self.field.width.into(), self.field.height.into());
        all.into_iter().for_each(|(place, t)| self.add(place * size, t, &mut shown));
        Some(shown)
    }

    /// At and below the nodes `from` of the tree.
    pub fn images(&self, point: DVec3, from: &[u32]) -> Shown {
        if let Some(shown) = self.closed_form(point) {
            return shown;
        }
        let mut shown = Shown::default();
        self.tree.walk(point, from, |k| {
            for at in self.squares(k) {
                self.search(point, at, 1.0, HALVINGS, &mut shown);
            }
        });
        shown
    }

    /// The corners of a leaf's cells, px.
    fn squares(&self, leaf: u32) -> impl Iterator<Item = DVec2> + use<> {
        let start = self.start;
        squares(leaf, self.side, self.cells).map(move |at| start + at)
    }

    /// What the rays of a leaf's cells do; `None` where there are none.
    fn leaf(&self, number: u32) -> Option<Leaf> {
        let beam = self.squares(number).flat_map(|at| nets(self.field, at, 1.0)).map(|n| n.beam());
        let beam = beam.reduce(|a, b| a.joined(&b))?;
        let size = DVec2::new(self.cells[0].into(), self.cells[1].into());
        let key = place_key(self.squares(number).next()? - self.start, size);
        Some(Leaf { key, number, beam })
    }

    /// The square of the image at `at`, px.
    fn search(&self, point: DVec3, at: DVec2, side: f64, halvings: u32, shown: &mut Shown) {
        if !shown.may_spend(1) {
            return;
        }
        let nets = nets(self.field, at, side);
        if is_eye(point, &nets) {
            shown.degenerate = Some(Degenerate::Eye);
            return;
        }
        if !nets.iter().any(|n| n.may_meet(point)) {
            return;
        }
        if halvings == 0 {
            self.solve(point, at, side, shown);
            return;
        }
        let half = 0.5 * side;
        corners(at, half).into_iter().for_each(|at| self.search(point, at, half, halvings - 1, shown));
    }

    /// Newton's method from the square's middle and its corners.
    fn solve(&self, point: DVec3, at: DVec2, side: f64, shown: &mut Shown) {
        for from in samples(at, side) {
            if !shown.may_spend(NEWTON_WORK) {
                return;
            }
            let Some(ray) = self.field.ray_at(from) else { continue };
            let t = (point - ray.origin).dot(ray.direction) / ray.direction.length_squared();
            let Some(root) = newton::solve(self.field, point, from, t) else { continue };
            match root.degenerate {
                None => self.add(root.place, root.t, shown),
                degenerate if self.contains(root.place) => shown.degenerate = shown.degenerate.max(degenerate),
                _ => {}
            }
        }
    }

    fn end(&self) -> DVec2 {
        self.start + DVec2::new(self.cells[0].into(), self.cells[1].into())
    }

    /// The place (px) is in the image.
    fn contains(&self, place: DVec2) -> bool {
        let tolerance = DVec2::splat(BORDER_PX);
        place.cmpge(self.start - tolerance).all() && place.cmple(self.end() + tolerance).all()
    }

    /// Adds a place that shows the point, if it is in the image.
    fn add(&self, place: DVec2, t: f64, shown: &mut Shown) {
        if self.contains(place) {
            shown.found.push(Found { place: place.clamp(self.start, self.end()), t, piece: 0 });
        }
    }
}

/// All rays of a square meet in the point. A lone ray that does is no sign of that: it may be the one that shows the point.
fn is_eye(point: DVec3, nets: &[Net]) -> bool {
    let is_lone = matches!(nets, [] | [Net { is_lone: true, .. }]);
    !is_lone && nets.iter().flat_map(|n| &n.rays).all(|r| is_nothing(point, r))
}

fn is_nothing(point: DVec3, r: &Ray) -> bool {
    let size = (point.length() + r.origin.length()) * r.direction.length();
    (point - r.origin).cross(r.direction).length() <= NOTHING * size
}

/// The rays of a square: one net where they are smooth; where they jump, fold or end, one for each sample.
fn nets(field: &Field, at: DVec2, side: f64) -> Vec<Net> {
    let places = samples(at, side);
    let found = places.map(|q| field.ray_at(q));
    if let [Some(a), Some(b), Some(c), Some(d), Some(m)] = found {
        let error = |of: fn(&Ray) -> DVec3| {
            let all = [a, b, c, d].map_each(|r| of(&r));
            let bulge = 2.0 * (of(&m) - all.iter().sum::<DVec3>() / 4.0).length();
            let spread = (0..4).flat_map(|k| (0..k).map(move |l| (k, l)));
            let spread = spread.map(|(k, l)| (all[k] - all[l]).length()).fold(0.0, f64::max);
            let rounding = NOTHING * of(&m).length();
            (bulge <= (SMOOTH * spread).max(rounding)).then_some(bulge + MARGIN * spread)
        };
        if let (Some(p_error), Some(d_error)) = (error(|r| r.origin), error(|r| r.direction)) {
            return vec![Net { rays: [a, b, c, d], p_error, d_error, is_lone: false }];
        }
    }
    // as far as the steepest of the samples goes, with as much again for what bends
    let error = |of: fn(&Ray) -> DVec3| {
        let slope = |(q, r): (DVec2, &Option<Ray>)| {
            let here = of(r.as_ref()?);
            Some(least_slope(q, |q| field.ray_at(q).map(|near| (of(&near) - here).length())))
        };
        2.0 * side * places.into_iter().zip(&found).filter_map(slope).fold(0.0, f64::max)
    };
    let (p_error, d_error) = (error(|r| r.origin), error(|r| r.direction));
    found.into_iter().flatten().map(|r| Net { rays: [r; 4], p_error, d_error, is_lone: true }).collect()
}

impl Net {
    fn beam(&self) -> Beam {
        let about = |r: &Ray| Beam::about(r.origin, r.direction, self.p_error, self.d_error);
        self.rays.iter().map(about).fold(Beam::NONE, |a, b| a.joined(&b))
    }

    /// E may be 0 between the rays.
    fn may_meet(&self, x: DVec3) -> bool {
        let Net { rays: r, p_error, d_error, .. } = self;
        let q = r.map_each(|r| x - r.origin);
        let d = r.map_each(|r| r.direction);
        let size = |v: &[DVec3; 4]| v.iter().fold(0.0_f64, |m, v| m.max(v.length()));
        let terms = x.length() + r.iter().fold(0.0_f64, |m, r| m.max(r.origin.length()));
        let error = p_error * (size(&d) + d_error) + size(&q) * d_error + NOTHING * terms * size(&d);
        // Bernstein coefficients of a product of bilinear functions: of each pair of corners, divided by C(2,k) C(2,l)
        let mut e = [[DVec3::ZERO; 3]; 3];
        for (a, q) in q.iter().enumerate() {
            for (b, d) in d.iter().enumerate() {
                let (k, l) = (a % 2 + b % 2, a / 2 + b / 2);
                let share = [1.0, 0.5, 1.0][k] * [1.0, 0.5, 1.0][l];
                e[l][k] += share * q.cross(*d);
            }
        }
        (0..3).all(|c| {
            let all = e.iter().flatten().map(|e| e[c]);
            let (lo, hi) = all.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(v), hi.max(v)));
            lo <= error && hi >= -error
        })
    }
}

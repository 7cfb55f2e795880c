//! The rays of a field through a point.
//!
//! A ray meets X where `E = (X - P) x D` is 0. Bounds of P and D over tiles rule most of the image out; in a cell between
//! four places P and D are taken as bilinear, so E is biquadratic, and where all its Bernstein coefficients of one component
//! have one sign there is no root in the cell. What is left is cut down to quarters of a pixel.

use super::newton::{self, Volume};
use super::tree::{Bound, TILE, Tree};
use super::{BORDER_PX, Degenerate, Found, Shown};
use crate::camera::bundle::Ray;
use crate::camera::field::Field;
use glam::{DVec2, DVec3};

/// A field, and bounds over its tiles.
pub struct Search<'a> {
    field: &'a Field,
    /// The image place of the first cell's corner, px, and the cells that follow it.
    start: DVec2,
    cells: [u32; 2],
    tree: Tree<Rays>,
    forward: bool,
}

/// Bounds of origins and directions, and how far the rays between four places may be from bilinear ones.
#[derive(Debug, Clone)]
pub struct Rays {
    p: [DVec3; 2],
    d: [DVec3; 2],
    p_bulge: f64,
    d_bulge: f64,
}

/// Times that a cell of a pixel is halved.
const HALVINGS: u32 = 2;

/// E within this of the product of its terms is nothing: the rays meet in the point.
const NOTHING: f64 = 1.0 / (1u64 << 40) as f64;

impl Volume for Field {
    fn at(&self, place_px: DVec2, t: f64) -> Option<(DVec3, DVec3)> {
        let ray = self.ray_at(place_px)?;
        Some((ray.origin + t * ray.direction, ray.direction))
    }

    fn size(&self, place_px: DVec2, t: f64) -> f64 {
        self.ray_at(place_px).map_or(0.0, |r| r.origin.length() + t.abs() * r.direction.length())
    }
}

impl<'a> Search<'a> {
    pub fn new(field: &'a Field, t_range: [f64; 2]) -> Search<'a> {
        // a table is bilinear between pixel centres, a formula holds all over the image
        let (start, cells) = match field.map() {
            Some(_) => (DVec2::ZERO, [field.width, field.height]),
            None => (DVec2::splat(0.5), [field.width - 1, field.height - 1]),
        };
        let tree = Tree::build(cells[0], cells[1], |x, y| bound(field, start, cells, x, y));
        Search { field, start, cells, tree, forward: t_range[0] >= 0.0 }
    }

    pub fn images(&self, point: DVec3) -> Shown {
        let mut shown = Shown::default();
        let may = |rays: &Rays| rays.may_meet(point, self.forward);
        self.tree.walk(may, |x, y, rays| {
            let row = |j: u32| (x * TILE..(x * TILE + TILE).min(self.cells[0])).map(move |i| (i, j));
            for (i, j) in (y * TILE..(y * TILE + TILE).min(self.cells[1])).flat_map(row) {
                let at = self.start + DVec2::new(i.into(), j.into());
                let corners = corners(at, 1.0).map(|q| self.field.ray_at(q));
                let cell = Cell { at, side: 1.0, corners, p_bulge: rays.p_bulge, d_bulge: rays.d_bulge };
                self.search(point, &cell, HALVINGS, &mut shown);
            }
        });
        shown
    }

    fn search(&self, point: DVec3, cell: &Cell, halvings: u32, shown: &mut Shown) {
        if cell.corners.iter().all(Option::is_none) && halvings < HALVINGS {
            return;
        }
        if let [Some(a), Some(b), Some(c), Some(d)] = cell.corners {
            let corners = [a, b, c, d];
            if corners.iter().all(|r| is_nothing(point, r)) {
                shown.degenerate = Some(Degenerate::Eye);
                return;
            }
            if !may_meet(point, &corners, cell.p_bulge, cell.d_bulge) {
                return;
            }
        }
        if halvings == 0 {
            self.solve(point, cell, shown);
            return;
        }
        let half = 0.5 * cell.side;
        for at in corners(cell.at, half) {
            let corners = corners(at, half).map(|q| self.field.ray_at(q));
            let (p_bulge, d_bulge) = (cell.p_bulge / 4.0, cell.d_bulge / 4.0);
            self.search(point, &Cell { at, side: half, corners, p_bulge, d_bulge }, halvings - 1, shown);
        }
    }

    /// Newton's method from the cell's middle and its corners.
    fn solve(&self, point: DVec3, cell: &Cell, shown: &mut Shown) {
        let middle = cell.at + 0.5 * cell.side;
        let end = self.start + DVec2::new(self.cells[0].into(), self.cells[1].into());
        for from in corners(cell.at, cell.side).into_iter().chain([middle]) {
            let Some(ray) = self.field.ray_at(from) else { continue };
            let t = (point - ray.origin).dot(ray.direction) / ray.direction.length_squared();
            let Some(root) = newton::solve(self.field, point, from, t) else { continue };
            let slack = DVec2::splat(BORDER_PX);
            if root.place.cmplt(self.start - slack).any() || root.place.cmpgt(end + slack).any() {
                continue;
            }
            match root.degenerate {
                None => shown.found.push(Found { place: root.place.clamp(self.start, end), t: root.t, piece: 0 }),
                degenerate => shown.degenerate = shown.degenerate.max(degenerate),
            }
        }
    }
}

/// A square of the image.
struct Cell {
    at: DVec2,
    side: f64,
    /// Left and right above, left and right below.
    corners: [Option<Ray>; 4],
    p_bulge: f64,
    d_bulge: f64,
}

fn corners(at: DVec2, side: f64) -> [DVec2; 4] {
    [DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::ONE].map(|c| at + side * c)
}

fn is_nothing(point: DVec3, r: &Ray) -> bool {
    let size = (point.length() + r.origin.length()) * r.direction.length();
    (point - r.origin).cross(r.direction).length() <= NOTHING * size
}

/// What the rays of a tile's cells do, sampled at their corners and middles.
fn bound(field: &Field, start: DVec2, cells: [u32; 2], x: u32, y: u32) -> Option<Rays> {
    let mut rays = Rays {
        p: [DVec3::INFINITY, DVec3::NEG_INFINITY],
        d: [DVec3::INFINITY, DVec3::NEG_INFINITY],
        p_bulge: 0.0,
        d_bulge: 0.0,
    };
    let cells = [(x * TILE, cells[0]), (y * TILE, cells[1])].map(|(from, end)| from..(from + TILE).min(end));
    for (i, j) in cells[1].clone().flat_map(|j| cells[0].clone().map(move |i| (i, j))) {
        let at = start + DVec2::new(i.into(), j.into());
        let corners = corners(at, 1.0).map(|q| field.ray_at(q));
        let middle = field.ray_at(at + 0.5);
        corners.iter().chain([&middle]).flatten().for_each(|r| rays.hold(r));
        if field.map().is_none() {
            continue;
        }
        if let ([Some(a), Some(b), Some(c), Some(d)], Some(m)) = (corners, middle) {
            let bulge = |m: DVec3, sum: DVec3| 2.0 * (m - 0.25 * sum).length();
            rays.p_bulge = rays.p_bulge.max(bulge(m.origin, a.origin + b.origin + c.origin + d.origin));
            rays.d_bulge = rays.d_bulge.max(bulge(m.direction, a.direction + b.direction + c.direction + d.direction));
        }
    }
    (rays.p[0].x <= rays.p[1].x).then_some(rays)
}

impl Bound for Rays {
    fn joined(self, other: &Rays) -> Rays {
        let join = |a: [DVec3; 2], b: [DVec3; 2]| [a[0].min(b[0]), a[1].max(b[1])];
        Rays {
            p: join(self.p, other.p),
            d: join(self.d, other.d),
            p_bulge: self.p_bulge.max(other.p_bulge),
            d_bulge: self.d_bulge.max(other.d_bulge),
        }
    }
}

impl Rays {
    fn hold(&mut self, r: &Ray) {
        self.p = [self.p[0].min(r.origin), self.p[1].max(r.origin)];
        self.d = [self.d[0].min(r.direction), self.d[1].max(r.direction)];
    }

    /// Some ray within the bounds may pass through the point; only at t >= 0 where `forward`.
    fn may_meet(&self, x: DVec3, forward: bool) -> bool {
        let size = x.abs().max_element() + self.p[0].abs().max(self.p[1].abs()).max_element();
        let room = 2.0 * self.p_bulge + NOTHING * size;
        let q = [x - self.p[1] - room, x - self.p[0] + room];
        let room = 2.0 * self.d_bulge + NOTHING * self.d[0].abs().max(self.d[1].abs()).max_element();
        let d = [self.d[0] - room, self.d[1] + room];
        let product = |i: usize, j: usize| {
            let all = [q[0][i] * d[0][j], q[0][i] * d[1][j], q[1][i] * d[0][j], q[1][i] * d[1][j]];
            all.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(*v), hi.max(*v)))
        };
        let crosses_0 = |(i, j): (usize, usize)| {
            let (a, b) = (product(i, j), product(j, i));
            a.0 <= b.1 && b.0 <= a.1
        };
        let ahead = !forward || (0..3).map(|k| product(k, k).1).sum::<f64>() >= 0.0;
        ahead && [(1, 2), (2, 0), (0, 1)].into_iter().all(crosses_0)
    }
}

/// E may be 0 between four rays that are bilinear within the bulges.
fn may_meet(x: DVec3, r: &[Ray; 4], p_bulge: f64, d_bulge: f64) -> bool {
    let q = r.map(|r| x - r.origin);
    let d = r.map(|r| r.direction);
    let size = |v: &[DVec3; 4]| v.iter().fold(0.0_f64, |m, v| m.max(v.length()));
    let terms = x.length() + r.iter().fold(0.0_f64, |m, r| m.max(r.origin.length()));
    let room = p_bulge * (size(&d) + d_bulge) + size(&q) * d_bulge + NOTHING * terms * size(&d);
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
        lo <= room && hi >= -room
    })
}

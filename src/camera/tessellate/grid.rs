//! Image triangles in equal cells or strips, with the exact rays at their corners.

use super::bend::usable;
use super::bound::{Judge, Verdict};
use crate::arrays::MapEach;
use crate::camera::bundle::Ray;
use crate::camera::mesh::triangle;
use crate::camera::pieces::Piece;
use glam::{DVec2, DVec3};

/// A mesh of image triangles.
pub struct Cells {
    /// Image places, px.
    pub places: Vec<DVec2>,
    /// The exact ray of each place.
    pub rays: Vec<Option<Ray>>,
    /// Three indices of places each.
    pub triangles: Vec<[u32; 3]>,
    /// One per triangle; empty before they are judged.
    pub verdicts: Vec<Verdict>,
    /// Number of parts, across and down, into which a triangle's box is divided for the bound.
    pub parts: (u32, u32),
    /// Columns and rows of cells before any refinement.
    pub size: (usize, usize),
}

/// The curvature of the rays over the whole image.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Bends {
    /// Along a only: P and D are affine in b, with the same slope for all a.
    Across,
    /// Along b only.
    Down,
    Both,
}

/// Number of parts of a strip along its length, for the bound.
const STRIP_PARTS: u32 = 16;

/// Places per side of the lattice that tells how the image bends, and how large a second difference may be against the
/// rays' own differences to be rounding.
const LATTICE: usize = 17;
const STRAIGHT: f64 = 1e-9;

impl Cells {
    fn new(parts: (u32, u32)) -> Cells {
        let (places, rays, triangles, verdicts) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        Cells { places, rays, triangles, verdicts, parts, size: (0, 0) }
    }

    /// Triangles with a ray at each corner, as pieces.
    pub fn pieces(&self) -> Vec<Piece> {
        self.triangles.iter().filter_map(|t| Some(triangle(self.corners(t), self.rays_of(t)?))).collect()
    }

    /// The corners of these triangles, with their verdicts.
    pub fn verdicts(&self) -> impl Iterator<Item = ([DVec2; 3], Verdict)> + '_ {
        let judged = self.triangles.iter().zip(&self.verdicts);
        judged.filter(|(t, _)| self.rays_of(t).is_some()).map(|(t, verdict)| (self.corners(t), *verdict))
    }

    fn corners(&self, t: &[u32; 3]) -> [DVec2; 3] {
        t.map_each(|i| self.places[i as usize])
    }

    fn rays_of(&self, t: &[u32; 3]) -> Option<[Ray; 3]> {
        let [a, b, c] = t.map_each(|i| self.rays[i as usize]);
        Some([a?, b?, c?])
    }

    /// The verdict on a triangle; at the rim where a corner has no ray.
    pub fn judge(&self, judge: &Judge, t: &[u32; 3]) -> Verdict {
        match self.rays_of(t) {
            Some(rays) => judge.judge(&self.corners(t), &rays, self.parts),
            None => Verdict::RIM,
        }
    }

    /// A verdict that holds for each triangle of a rectangle of equal cells: from column and row `at`, `span` cells each way or up to the
    /// border.
    pub fn judge_group(&self, judge: &Judge, at: (usize, usize), span: (usize, usize)) -> Verdict {
        let (columns, rows) = self.size;
        let (right, below) = ((at.0 + span.0).min(columns), (at.1 + span.1).min(rows));
        let place = |i: usize, j: usize| j * (columns + 1) + i;
        let corners = [place(at.0, at.1), place(right, at.1), place(at.0, below), place(right, below)];
        let Some(rays) = corners.iter().map(|&k| self.rays[k]).collect::<Option<Vec<Ray>>>() else {
            return Verdict::RIM;
        };
        let (lo, hi) = (self.places[corners[0]], self.places[corners[3]]);
        let cell = (hi - lo) / DVec2::new((right - at.0) as f64, (below - at.1) as f64);
        judge.judge_box([lo, hi], rays, cell, self.parts)
    }

    /// A new place with its ray.
    pub fn add(&mut self, judge: &Judge, at_px: DVec2) -> u32 {
        self.places.push(at_px);
        self.rays.push(judge.ray(at_px));
        self.places.len() as u32 - 1
    }

    /// Columns and rows between the given image places, each cell split along its diagonal from bottom left to top right; the
    /// corner off the diagonal comes first.
    pub fn between(judge: &Judge, xs: &[f64], ys: &[f64], parts: (u32, u32)) -> Cells {
        let mut cells = Cells::new(parts);
        for y in ys {
            for x in xs {
                cells.add(judge, DVec2::new(*x, *y));
            }
        }
        cells.size = (xs.len() - 1, ys.len() - 1);
        let n = xs.len() as u32;
        for k in (0..ys.len() as u32 - 1).flat_map(|j| (0..n - 1).map(move |i| j * n + i)) {
            cells.triangles.extend([[k, k + n, k + 1], [k + n + 1, k + 1, k + n]]);
        }
        cells
    }
}

/// `n` equal strips, or about `n` triangles.
pub fn of_count(judge: &Judge, n: u32) -> Cells {
    let n = f64::from(n);
    match bends(judge) {
        Bends::Across => Cells::between(judge, &even(judge.size.x, n), &even(judge.size.y, 1.0), (1, STRIP_PARTS)),
        Bends::Down => Cells::between(judge, &even(judge.size.x, 1.0), &even(judge.size.y, n), (STRIP_PARTS, 1)),
        Bends::Both => {
            let cells = (n / 2.0).max(1.0);
            let columns = (cells * judge.size.x / judge.size.y).sqrt().round().clamp(1.0, cells.floor());
            let rows = (cells / columns).round().max(1.0);
            Cells::between(judge, &even(judge.size.x, columns), &even(judge.size.y, rows), (1, 1))
        }
    }
}

/// Strips between the given places along the axis that bends.
pub fn strips(judge: &Judge, bends: Bends, borders: &[f64]) -> Cells {
    match bends {
        Bends::Down => Cells::between(judge, &even(judge.size.x, 1.0), borders, (STRIP_PARTS, 1)),
        _ => Cells::between(judge, borders, &even(judge.size.y, 1.0), (1, STRIP_PARTS)),
    }
}

/// The borders of `n` equal parts of a length.
pub fn even(length: f64, n: f64) -> Vec<f64> {
    (0..=n as u32).map(|k| f64::from(k) / n * length).collect()
}

/// How the rays bend. What the lattice misses costs pieces or tightness, nothing else: each piece is judged by itself.
pub fn bends(judge: &Judge) -> Bends {
    match differences(judge).map(|d| d.map_each(|v| v > STRAIGHT)) {
        Some([_, false, false]) => Bends::Across,
        Some([false, false, true]) => Bends::Down,
        _ => Bends::Both,
    }
}

/// Columns and rows of cells, about `side` squared in all, in which the rays bend alike both ways: the error of a cell grows
/// with the square of its sides.
pub fn balanced(judge: &Judge, side: f64) -> (f64, f64) {
    let [aa, ab, bb] = differences(judge).unwrap_or([judge.size.x.powi(2), 0.0, judge.size.y.powi(2)]);
    let stretch = ((aa + ab).max(STRAIGHT) / (bb + ab).max(STRAIGHT)).sqrt().sqrt();
    let count = |n: f64| n.round().clamp(1.0, side * side);
    (count(side * stretch), count(side / stretch))
}

/// The largest second differences of the rays on a lattice over the image - across, mixed and down - in parts of the rays'
/// range; `None` where a place has no ray.
fn differences(judge: &Judge) -> Option<[f64; 3]> {
    let at = |k: usize| k as f64 / (LATTICE - 1) as f64;
    let mut rays = Vec::with_capacity(LATTICE * LATTICE);
    for (i, j) in (0..LATTICE).flat_map(|j| (0..LATTICE).map(move |i| (i, j))) {
        rays.push(usable(judge.map.ray(at(i), at(j)))?);
    }
    let most = |of: fn(&Ray) -> DVec3| {
        let f = |i: usize, j: usize| of(&rays[j * LATTICE + i]);
        let largest = |list: &mut dyn Iterator<Item = DVec3>| list.fold(0f64, |m, v| m.max(v.length()));
        let inner = || (0..LATTICE).flat_map(|j| (1..LATTICE - 1).map(move |i| (i, j)));
        let cells = || (1..LATTICE).flat_map(|j| (1..LATTICE).map(move |i| (i, j)));
        let range = largest(&mut rays.iter().map(|r| of(r) - of(&rays[0])));
        let size = range.max(f64::MIN_POSITIVE);
        let aa = largest(&mut inner().map(|(i, j)| f(i - 1, j) - 2.0 * f(i, j) + f(i + 1, j)));
        let bb = largest(&mut inner().map(|(j, i)| f(i, j - 1) - 2.0 * f(i, j) + f(i, j + 1)));
        let ab = largest(&mut cells().map(|(i, j)| f(i, j) - f(i - 1, j) - f(i, j - 1) + f(i - 1, j - 1)));
        [aa, ab, bb].map_each(|v| v / size)
    };
    let (p, d) = (most(|r| r.origin), most(|r| r.direction));
    Some([0, 1, 2].map_each(|k| p[k].max(d[k])))
}

//! Adaptive refinement until every piece meets the error.
//!
//! Where the rays bend along one axis alone, strips are halved. Otherwise right-angled image triangles are bisected through their
//! newest corner (Mitchell 1989): a triangle is split from its first corner to the middle of the opposite edge, and the triangle
//! beyond that edge is split with it, after itself being split until it has that edge to split. So every edge has the same end points
//! from both sides: no corner lies on another triangle's edge, and the rays are continuous across every border.

use super::bound::{Judge, Verdict};
use super::grid::{Bends, Cells, balanced, bends, even, strips};
use crate::arrays::MapEach;
use crate::input::limits::PIECES;
use crate::parallel;
use std::collections::{BTreeSet, HashMap};

/// Pieces this wide and high, px, are split no further: a remaining error there is a jump, or the rim of the rays.
pub const PIECE_MIN_PX: f64 = 0.25;

/// The square root of the initial number of cells.
const CELLS: f64 = 4.0;

pub fn refine(judge: &Judge, error_px: f64) -> Cells {
    match bends(judge) {
        Bends::Both => refine_triangles(judge, error_px),
        one => refine_strips(judge, error_px, one),
    }
}

/// Whether a verdict requires smaller pieces.
fn asks(verdict: &Verdict, error_px: f64) -> bool {
    verdict.rim || verdict.error_px > error_px
}

fn refine_strips(judge: &Judge, error_px: f64, axis: Bends) -> Cells {
    let length = if axis == Bends::Down { judge.size.y } else { judge.size.x };
    let mut borders = even(length, 1.0);
    loop {
        let mut cells = strips(judge, axis, &borders);
        cells.verdicts = parallel::map(&cells.triangles, |t| cells.judge(judge, t));
        let wide = |k: usize| borders[k + 1] - borders[k] > PIECE_MIN_PX;
        let split = |k: usize| wide(k) && cells.verdicts[2 * k..2 * k + 2].iter().any(|v| asks(v, error_px));
        let halved: Vec<usize> = (0..borders.len() - 1).filter(|&k| split(k)).collect();
        if halved.is_empty() || cells.triangles.len() + 2 * halved.len() > PIECES.most as usize {
            return cells;
        }
        borders.extend(halved.iter().map(|&k| (borders[k] + borders[k + 1]) / 2.0).collect::<Vec<_>>());
        borders.sort_by(f64::total_cmp);
    }
}

fn refine_triangles(judge: &Judge, error_px: f64) -> Cells {
    let (columns, rows) = balanced(judge, CELLS);
    let grid = Cells::between(judge, &even(judge.size.x, columns), &even(judge.size.y, rows), (1, 1));
    let mut mesh = Mesh::new(grid);
    loop {
        let new: Vec<u32> = std::mem::take(&mut mesh.new).into_iter().collect();
        let verdicts: Vec<Verdict> = parallel::map(&new, |&t| mesh.verdict(judge, t));
        for (&t, verdict) in new.iter().zip(verdicts) {
            mesh.cells.verdicts[t as usize] = verdict;
        }
        let over: Vec<u32> =
            new.into_iter().filter(|&t| asks(&mesh.cells.verdicts[t as usize], error_px) && mesh.is_large(t)).collect();
        for t in over {
            if mesh.cells.triangles.len() + 2 > PIECES.most as usize {
                break;
            }
            // it may have been split with a neighbour already
            if !mesh.new.contains(&t) {
                mesh.split(judge, t);
            }
        }
        if mesh.new.is_empty() {
            return mesh.cells;
        }
    }
}

/// Triangles and their neighbours.
struct Mesh {
    cells: Cells,
    /// The triangles at an edge, its places ascending.
    beyond: HashMap<(u32, u32), [Option<u32>; 2]>,
    /// Triangles without a verdict.
    new: BTreeSet<u32>,
}

fn edge(a: u32, b: u32) -> (u32, u32) {
    (a.min(b), a.max(b))
}

fn edges([a, b, c]: [u32; 3]) -> [(u32, u32); 3] {
    [edge(a, b), edge(b, c), edge(c, a)]
}

impl Mesh {
    fn new(mut cells: Cells) -> Mesh {
        let n = cells.triangles.len();
        cells.verdicts = vec![Verdict::NONE; n];
        let mut mesh = Mesh { cells, beyond: HashMap::new(), new: (0..n as u32).collect() };
        (0..n as u32).for_each(|t| mesh.join(t));
        mesh
    }

    fn join(&mut self, t: u32) {
        for e in edges(self.cells.triangles[t as usize]) {
            let sides = self.beyond.entry(e).or_default();
            // an edge has two sides, of which one was left
            if let Some(free) = sides.iter_mut().find(|s| s.is_none()) {
                *free = Some(t);
            }
        }
    }

    fn leave(&mut self, t: u32) {
        for e in edges(self.cells.triangles[t as usize]) {
            if let Some(sides) = self.beyond.get_mut(&e) {
                sides.iter_mut().filter(|s| **s == Some(t)).for_each(|s| *s = None);
                if *sides == [None, None] {
                    self.beyond.remove(&e);
                }
            }
        }
    }

    /// The verdict on a triangle. One without any ray is done.
    fn verdict(&self, judge: &Judge, t: u32) -> Verdict {
        let triangle = &self.cells.triangles[t as usize];
        let verdict = self.cells.judge(judge, triangle);
        let blind = triangle.iter().all(|&i| self.cells.rays[i as usize].is_none());
        Verdict { rim: verdict.rim && !blind, error_px: if blind { 0.0 } else { verdict.error_px }, ..verdict }
    }

    fn is_large(&self, t: u32) -> bool {
        let [a, b, c] = self.cells.triangles[t as usize].map_each(|i| self.cells.places[i as usize]);
        (a.max(b).max(c) - a.min(b).min(c)).max_element() > PIECE_MIN_PX
    }

    /// The triangle beyond the edge at which `t` is split.
    fn partner(&self, t: u32) -> Option<u32> {
        let [_, b, c] = self.cells.triangles[t as usize];
        self.beyond.get(&edge(b, c))?.iter().flatten().copied().find(|&n| n != t)
    }

    /// Splits the triangle, and the one beyond the split edge.
    fn split(&mut self, judge: &Judge, t: u32) {
        let [_, b, c] = self.cells.triangles[t as usize];
        // a partner that is split elsewhere is larger; one of its halves then has this edge to split
        if let Some(n) = self.partner(t) {
            let [_, nb, nc] = self.cells.triangles[n as usize];
            if edge(nb, nc) != edge(b, c) {
                self.split(judge, n);
            }
        }
        let partner = self.partner(t);
        let middle = (self.cells.places[b as usize] + self.cells.places[c as usize]) / 2.0;
        let m = self.cells.add(judge, middle);
        self.halve(t, m);
        partner.into_iter().for_each(|n| self.halve(n, m));
    }

    fn halve(&mut self, t: u32, m: u32) {
        let [a, b, c] = self.cells.triangles[t as usize];
        self.leave(t);
        self.cells.triangles[t as usize] = [m, a, b];
        let other = self.cells.triangles.len() as u32;
        self.cells.triangles.push([m, c, a]);
        self.cells.verdicts.push(self.cells.verdicts[t as usize]);
        self.new.extend([t, other]);
        self.join(t);
        self.join(other);
    }
}

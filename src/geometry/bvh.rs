//! A bounding volume hierarchy: boxes in Morton order, joined two by two.

use glam::DVec3;
use rayon::prelude::*;

/// Items under one of the lowest boxes.
const LEAF: usize = 4;

/// Bits of a Morton code along each axis.
const CODE_BITS: u32 = 21;

/// The box of all points between two corners.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Aabb {
    pub lo: DVec3,
    pub hi: DVec3,
}

/// Boxes over numbered items.
#[derive(Debug)]
pub struct Bvh {
    /// Ids of the items, [`LEAF`] to each of the lowest boxes.
    order: Vec<u32>,
    /// The lowest boxes first. Box `k` of a level holds boxes `2 k` and `2 k + 1` of the level below; the last level is one box.
    levels: Vec<Vec<Aabb>>,
}

impl Aabb {
    const EMPTY: Aabb = Aabb { lo: DVec3::INFINITY, hi: DVec3::NEG_INFINITY };

    pub fn around(points: &[DVec3]) -> Aabb {
        points.iter().fold(Aabb::EMPTY, |b, p| Aabb { lo: b.lo.min(*p), hi: b.hi.max(*p) })
    }

    fn joined(self, other: Aabb) -> Aabb {
        Aabb { lo: self.lo.min(other.lo), hi: self.hi.max(other.hi) }
    }

    /// The distance from a point to the box; 0 inside.
    pub fn distance(&self, p: DVec3) -> f64 {
        (p.max(self.lo).min(self.hi) - p).length()
    }
}

impl Bvh {
    /// A hierarchy over items with these ids and boxes, which are finite.
    pub fn build(items: &[(u32, Aabb)]) -> Bvh {
        let centre = |b: &Aabb| b.lo / 2.0 + b.hi / 2.0;
        let all = items.iter().fold(Aabb::EMPTY, |all, (_, b)| all.joined(Aabb::around(&[centre(b)])));
        let mut sorted: Vec<(u64, usize)> =
            items.par_iter().enumerate().map(|(k, (_, b))| (code(centre(b), &all), k)).collect();
        sorted.par_sort_unstable();
        let join = |boxes: &[Aabb]| boxes.iter().fold(Aabb::EMPTY, |a, b| a.joined(*b));
        let lowest = sorted.chunks(LEAF).map(|leaf| join(&leaf.iter().map(|(_, k)| items[*k].1).collect::<Vec<_>>()));
        let mut levels = vec![lowest.collect::<Vec<_>>()];
        while let Some(below) = levels.last().filter(|l| l.len() > 1) {
            levels.push(below.chunks(2).map(join).collect());
        }
        Bvh { order: sorted.iter().map(|(_, k)| items[*k].0).collect(), levels }
    }

    /// Visits items whose boxes are `near` enough, mostly near to far. `near` gives a lower bound of the distance to what is in
    /// a box, or `None` for boxes to leave out; `visit` returns the largest distance that still matters.
    pub fn walk(&self, near: impl Fn(&Aabb) -> Option<f64>, mut visit: impl FnMut(u32) -> f64) {
        let at = |level: usize, k: usize| Some((near(self.levels[level].get(k)?)?, level, k));
        let mut limit = f64::INFINITY;
        // one more a level at most, and the one that is taken
        let mut todo: Vec<(f64, usize, usize)> = Vec::with_capacity(self.levels.len() + 1);
        todo.extend(at(self.levels.len() - 1, 0));
        while let Some((distance, level, k)) = todo.pop() {
            if distance > limit {
                continue;
            }
            if level == 0 {
                let end = self.order.len().min((k + 1) * LEAF);
                self.order[k * LEAF..end].iter().for_each(|id| limit = limit.min(visit(*id)));
                continue;
            }
            let (a, b) = (at(level - 1, 2 * k), at(level - 1, 2 * k + 1));
            // the nearer one is taken first
            let [far, nearer] = if a.is_some_and(|a| b.is_some_and(|b| a.0 > b.0)) { [a, b] } else { [b, a] };
            todo.extend([far, nearer].into_iter().flatten());
        }
    }
}

/// The Morton code of a point in `all`.
fn code(p: DVec3, all: &Aabb) -> u64 {
    let cells = f64::from((1_u32 << CODE_BITS) - 1);
    // a box without extent gives NaN, which becomes 0
    let cell = ((p - all.lo) / (all.hi - all.lo) * cells).to_array().map(|v| v as u64);
    let spread = |v: u64| (0..CODE_BITS).fold(0, |code, bit| code | (v >> bit & 1) << (3 * bit));
    spread(cell[0]) | spread(cell[1]) << 1 | spread(cell[2]) << 2
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_item_is_visited_once_and_each_box_is_in_the_one_above() {
        // all in one place, on a line, and at distances that share most codes
        let same = |_: u32| DVec3::ONE;
        let line = |k: u32| DVec3::new(f64::from(k), 0.0, 0.0);
        let steep = |k: u32| DVec3::new(0.5_f64.powi((k % 900) as i32), 0.0, 0.0);
        for place in [&same as &dyn Fn(u32) -> DVec3, &line, &steep] {
            for n in [0, 1, 4, 5, 100, 40_001] {
                let items: Vec<(u32, Aabb)> = (0..n).map(|id| (id, Aabb::around(&[place(id)]))).collect();
                let bvh = Bvh::build(&items);
                let mut ids = Vec::new();
                bvh.walk(
                    |_| Some(0.0),
                    |id| {
                        ids.push(id);
                        f64::INFINITY
                    },
                );
                ids.sort_unstable();
                assert!(ids.into_iter().eq(0..n));
                for level in bvh.levels.windows(2) {
                    let holds = |(k, b): (usize, &Aabb)| level[1][k / 2].joined(*b) == level[1][k / 2];
                    assert!(level[0].iter().enumerate().all(holds));
                }
            }
        }
    }
}

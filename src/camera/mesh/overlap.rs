//! Which triangles of an image overlap, by binary space partition: a line splits them into two sets, again and again, until few are left to
//! compare.
//!
//! The line runs along an edge of a triangle, or along an axis. Triangles that it crosses go to both sides. Triangles that do not
//! overlap always have such lines (Paterson and Yao 1990: n segments have a partition of O(n log n) parts), however long and
//! thin they are and however many meet in a corner.

use super::side;
use crate::arrays::MapEach;
use crate::camera::boxes::around;
use crate::parallel;
use glam::DVec2;

/// Sets up to this size are compared pair by pair.
const FEW: usize = 16;

/// Triangles of a set whose edges are candidates for its line, and triangles that a candidate is scored on.
const TRIED: usize = 6;
const SCORED: usize = 48;

/// Candidates that are tried on the whole set, the best first.
const BEST: usize = 3;

type Triangle = [DVec2; 3];
type Line = [DVec2; 2];

/// The first pair of triangles whose interiors overlap, by their numbers.
pub fn first_overlap(corners: &[Triangle]) -> Option<(usize, usize)> {
    within(corners, (0..corners.len() as u32).collect())
}

/// The same among the triangles `set`, which ascend.
fn within(corners: &[Triangle], set: Vec<u32>) -> Option<(usize, usize)> {
    let Some([left, right]) = split(corners, &set) else { return first_pair(corners, &set) };
    drop(set);
    let mut halves = [(left, None), (right, None)];
    parallel::for_each_mut(&mut halves, |_, (set, found)| *found = within(corners, std::mem::take(set)));
    halves.into_iter().filter_map(|(_, found)| found).min()
}

/// The same, pair by pair.
fn first_pair(corners: &[Triangle], set: &[u32]) -> Option<(usize, usize)> {
    let boxes: Vec<(DVec2, DVec2)> = set.iter().map(|&k| around(&corners[k as usize])).collect();
    let disjoint = |i: usize, j: usize| boxes[i].0.cmpge(boxes[j].1).any() || boxes[j].0.cmpge(boxes[i].1).any();
    let of = |i: usize| set[i] as usize;
    let pairs = (0..set.len()).flat_map(|i| (i + 1..set.len()).map(move |j| (i, j)));
    pairs
        .filter(|&(i, j)| !disjoint(i, j))
        .find(|&(i, j)| overlap(&corners[of(i)], &corners[of(j)]))
        .map(|(i, j)| (of(i), of(j)))
}

/// The triangles on either side of a line; those that it crosses are on both. `None` if the set is small, or if no candidate splits it
/// well, as where most triangles overlap.
fn split(corners: &[Triangle], set: &[u32]) -> Option<[Vec<u32>; 2]> {
    if set.len() <= FEW {
        return None;
    }
    let spread = |count: usize| (0..count).map(move |k| set[(2 * k + 1) * set.len() / (2 * count)] as usize);
    let sample: Vec<&Triangle> = spread(SCORED).map(|k| &corners[k]).collect();
    let edges = spread(TRIED).flat_map(|k| (0..3).map(move |e| [corners[k][e], corners[k][(e + 1) % 3]]));
    let mut lines: Vec<(usize, Line)> = edges
        .chain(medians(&sample))
        .map(|line| {
            let sides = sample.iter().map(|t| sides(line, t));
            let (left, right) = sides.fold((0, 0), |n, s| (n.0 + usize::from(s[0]), n.1 + usize::from(s[1])));
            // fewer in all, and fewer on the larger side, is better
            (left + right + left.max(right), line)
        })
        .collect();
    lines.sort_by_key(|l| l.0);
    lines.iter().take(BEST).find_map(|(_, line)| {
        let mut parts = [Vec::new(), Vec::new()];
        for &k in set {
            let is_on = sides(*line, &corners[k as usize]);
            (0..2).filter(|s| is_on[*s]).for_each(|s| parts[s].push(k));
        }
        let [left, right] = parts.each_ref().map_each(Vec::len);
        // at most a quarter more in all, and nine tenths on one side, so that the recursion ends
        let is_good = 4 * (left + right) <= 5 * set.len() && 10 * left.max(right) <= 9 * set.len();
        is_good.then_some(parts)
    })
}

/// Lines along the axes through the median of the triangles' middles.
fn medians(triangles: &[&Triangle]) -> [Line; 2] {
    let middle = |of: fn(DVec2) -> f64| {
        let mut all: Vec<f64> = triangles.iter().map(|t| of((t[0] + t[1] + t[2]) / 3.0)).collect();
        all.sort_by(f64::total_cmp);
        all[all.len() / 2]
    };
    let at = DVec2::new(middle(|q| q.x), middle(|q| q.y));
    [[at, at + DVec2::X], [at, at + DVec2::Y]]
}

/// Whether the triangle reaches the left and the right side of a line; both if it lies on the line.
fn sides([a, b]: Line, t: &Triangle) -> [bool; 2] {
    let at = t.map_each(|q| side(a, b, q));
    let (left, right) = (at.iter().all(|s| *s >= 0.0), at.iter().all(|s| *s <= 0.0));
    if left == right { [true; 2] } else { [left, right] }
}

/// The triangles' interiors overlap: no edge of either has the other wholly on its outer side.
fn overlap(s: &Triangle, t: &Triangle) -> bool {
    let separates = |s: &Triangle, t: &Triangle| {
        let o = side(s[0], s[1], s[2]);
        (0..3).any(|k| t.iter().all(|q| side(s[k], s[(k + 1) % 3], *q) * o <= 0.0))
    };
    !separates(s, t) && !separates(t, s)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::TAU;

    fn by_all_pairs(corners: &[Triangle]) -> Option<(usize, usize)> {
        let pairs = (0..corners.len()).flat_map(|j| (j + 1..corners.len()).map(move |k| (j, k)));
        pairs.filter(|&(j, k)| overlap(&corners[j], &corners[k])).min()
    }

    /// Triangles around one corner.
    fn fan(n: usize, centre: DVec2, radius: f64) -> Vec<Triangle> {
        let rim = |k: usize| centre + radius * DVec2::from_angle(TAU * (k % n) as f64 / n as f64);
        (0..n).map(|k| [centre, rim(k), rim(k + 1)]).collect()
    }

    /// Strips across a square that is rotated by `angle`.
    fn strips(n: usize, angle: f64) -> Vec<Triangle> {
        let at = |x: usize, y: f64| 300.0 + DVec2::from_angle(angle).rotate(DVec2::new(200.0 * x as f64 / n as f64, y));
        (0..n)
            .flat_map(|k| {
                [[at(k, 0.0), at(k + 1, 0.0), at(k, 200.0)], [at(k + 1, 200.0), at(k + 1, 0.0), at(k, 200.0)]]
            })
            .collect()
    }

    #[test]
    fn a_hundred_thousand_pieces_take_far_less_than_quadratic_time() {
        // all pairs are 5e9, of some 10 ns each
        let n = 100_000;
        for pieces in [fan(n, DVec2::splat(50.0), 40.0), strips(n / 2, 0.0), strips(n / 2, 0.37)] {
            let started = std::time::Instant::now();
            assert_eq!(first_overlap(&pieces), None);
            assert!(started.elapsed().as_secs() < 10, "{:?}", started.elapsed());
        }
    }

    #[test]
    fn one_piece_too_many_is_found_among_many() {
        for mut pieces in [fan(3000, DVec2::splat(50.0), 40.0), strips(3000, 0.2), strips(3000, 0.0)] {
            assert_eq!(first_overlap(&pieces), None);
            let k = pieces.len() / 3;
            let middle = pieces[k].iter().sum::<DVec2>() / 3.0;
            pieces.push(pieces[k].map(|q| middle + 1e-3 * (q - middle)));
            assert_eq!(first_overlap(&pieces), Some((k, pieces.len() - 1)));
        }
        // no line splits triangles that all overlap
        assert_eq!(first_overlap(&vec![[DVec2::ZERO, DVec2::X, DVec2::Y]; 100_000]), Some((0, 1)));
    }

    proptest! {
        #[test]
        fn random_triangles_overlap_as_all_pairs_say(
            triangles in prop::collection::vec(prop::array::uniform6(0i32..40), 2..120),
            size in 0.05f64..1.0,
        ) {
            let pieces: Vec<Triangle> = triangles
                .iter()
                .map(|t| [0, 2, 4].map(|k| DVec2::new(f64::from(t[k]), f64::from(t[k + 1]))))
                .map(|t| t.map(|q| t[0] + (size * (q - t[0])).round()))
                .filter(|t| side(t[0], t[1], t[2]) != 0.0)
                .collect();
            prop_assert_eq!(first_overlap(&pieces), by_all_pairs(&pieces));
        }
    }
}

//! A hierarchy of boxes in the image over items in their order: finds the first item at a place.

use glam::DVec2;

/// A binary tree of boxes: box k bounds boxes 2k and 2k + 1; each box of the last half bounds a run of consecutive items. Its memory is
/// linear in the number of items, however much they overlap.
#[derive(Debug, Clone, PartialEq)]
pub struct Boxes {
    run: usize,
    count: usize,
    all: Vec<(DVec2, DVec2)>,
}

/// The empty box.
const EMPTY: (DVec2, DVec2) = (DVec2::INFINITY, DVec2::NEG_INFINITY);

fn join(a: (DVec2, DVec2), b: (DVec2, DVec2)) -> (DVec2, DVec2) {
    (a.0.min(b.0), a.1.max(b.1))
}

/// The least box around points.
pub fn around(points: &[DVec2]) -> (DVec2, DVec2) {
    points.iter().fold(EMPTY, |b, q| join(b, (*q, *q)))
}

/// How far the box of a triangle extends beyond its corners, relative to their coordinates. [`side`](super::pieces::side) may be off by the
/// root of its rounding times the square of the coordinates over the edge's length, so this covers edges over a millionth of the
/// coordinates.
const TOLERANCE: f64 = 1e-9;

/// A box that holds every place that a triangle holds within rounding.
pub fn around_triangle(corners: &[DVec2; 3]) -> (DVec2, DVec2) {
    let (lo, hi) = around(corners);
    let tolerance = TOLERANCE * (1.0 + lo.abs().max(hi.abs()).max_element());
    (lo - tolerance, hi + tolerance)
}

impl Boxes {
    /// Over items with these boxes (least and greatest corner), `run` items a leaf.
    pub fn new(boxes: impl ExactSizeIterator<Item = (DVec2, DVec2)>, run: usize) -> Boxes {
        let count = boxes.len();
        let leaves = count.div_ceil(run).next_power_of_two();
        let mut all = vec![EMPTY; 2 * leaves];
        boxes.enumerate().for_each(|(k, b)| all[leaves + k / run] = join(all[leaves + k / run], b));
        (1..leaves).rev().for_each(|k| all[k] = join(all[2 * k], all[2 * k + 1]));
        Boxes { run, count, all }
    }

    /// The first `Some` of `give`, called in order with the numbers of the items whose run's box contains the place.
    pub fn first<T>(&self, q: DVec2, give: &impl Fn(usize) -> Option<T>) -> Option<T> {
        self.first_under(1, q, give)
    }

    fn first_under<T>(&self, k: usize, q: DVec2, give: &impl Fn(usize) -> Option<T>) -> Option<T> {
        let ((lo, hi), leaves) = (self.all[k], self.all.len() / 2);
        if q.cmplt(lo).any() || q.cmpgt(hi).any() {
            return None;
        }
        if k < leaves {
            return self.first_under(2 * k, q, give).or_else(|| self.first_under(2 * k + 1, q, give));
        }
        let from = (k - leaves) * self.run;
        (from..(from + self.run).min(self.count)).find_map(give)
    }
}

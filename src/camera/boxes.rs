//! Boxes in the image in the order of what they are around: which of it comes first at a place.

use glam::DVec2;

/// Boxes as a binary tree over runs in order: box k is around boxes 2k and 2k + 1, and each of the last half around a run.
/// However much they overlap, it takes memory by their number.
#[derive(Debug, Clone)]
pub struct Boxes {
    run: usize,
    count: usize,
    all: Vec<(DVec2, DVec2)>,
}

/// Around nothing.
pub const EMPTY: (DVec2, DVec2) = (DVec2::INFINITY, DVec2::NEG_INFINITY);

pub fn join(a: (DVec2, DVec2), b: (DVec2, DVec2)) -> (DVec2, DVec2) {
    (a.0.min(b.0), a.1.max(b.1))
}

impl Boxes {
    /// Around each of `boxes` (least and greatest corner), `run` of them together.
    pub fn new(boxes: impl ExactSizeIterator<Item = (DVec2, DVec2)>, run: usize) -> Boxes {
        let count = boxes.len();
        let leaves = count.div_ceil(run).next_power_of_two();
        let mut all = vec![EMPTY; 2 * leaves];
        boxes.enumerate().for_each(|(k, b)| all[leaves + k / run] = join(all[leaves + k / run], b));
        (1..leaves).rev().for_each(|k| all[k] = join(all[2 * k], all[2 * k + 1]));
        Boxes { run, count, all }
    }

    /// What `give` makes of the first number whose run's box holds the place and of which it makes something.
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

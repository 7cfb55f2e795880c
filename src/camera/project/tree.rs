//! Bounds over an image's tiles, and over ever larger squares of them: finds the tiles that may see a point.

use rayon::prelude::*;

pub use crate::TILE;

/// What holds for all rays or curves of some part of the image.
pub trait Bound: Clone + Send + Sync {
    fn joined(self, other: &Self) -> Self;
}

/// Levels of squares, the tiles first, each level half as many a side; `None`: no rays there.
pub struct Tree<B> {
    levels: Vec<Level<B>>,
}

struct Level<B> {
    width: u32,
    squares: Vec<Option<B>>,
}

impl<B: Bound> Tree<B> {
    /// Over `columns x rows` cells; `bound` is given a tile's column and row.
    pub fn build(columns: u32, rows: u32, bound: impl Fn(u32, u32) -> Option<B> + Sync) -> Tree<B> {
        let (mut width, mut height) = (columns.div_ceil(TILE), rows.div_ceil(TILE));
        let each = |k: u32| bound(k % width, k / width);
        let mut levels = vec![Level { width, squares: (0..width * height).into_par_iter().map(each).collect() }];
        while width * height > 1 {
            let below = &levels[levels.len() - 1];
            let (w, h) = (width.div_ceil(2), height.div_ceil(2));
            let join = |k: u32| {
                let children = children(k % w, k / w, width, height);
                let bounds = children.filter_map(|(x, y)| below.squares[(y * width + x) as usize].clone());
                bounds.reduce(|a, b| a.joined(&b))
            };
            let squares = (0..w * h).map(join).collect();
            (width, height) = (w, h);
            levels.push(Level { width, squares });
        }
        Tree { levels }
    }

    /// Calls `visit` with the column, row and bound of each tile whose squares all pass `may`.
    pub fn walk(&self, may: impl Fn(&B) -> bool, mut visit: impl FnMut(u32, u32, &B)) {
        let mut open = vec![(self.levels.len() - 1, 0, 0)];
        while let Some((level, x, y)) = open.pop() {
            let Level { width, squares } = &self.levels[level];
            let Some(bound) = squares.get((y * width + x) as usize).and_then(Option::as_ref) else { continue };
            if !may(bound) {
                continue;
            }
            if level == 0 {
                visit(x, y, bound);
                continue;
            }
            let Level { width, squares } = &self.levels[level - 1];
            open.extend(children(x, y, *width, squares.len() as u32 / width).map(|(x, y)| (level - 1, x, y)));
        }
    }
}

/// The up to four squares of the finer level, `width x height` of them, in the square at `(x, y)`.
fn children(x: u32, y: u32, width: u32, height: u32) -> impl Iterator<Item = (u32, u32)> {
    let of = move |k: u32| (2 * x + k % 2, 2 * y + k / 2);
    (0..4).map(of).filter(move |&(x, y)| x < width && y < height)
}

/// The cells of a tile, of `size` in all: columns and rows.
pub fn cells(x: u32, y: u32, size: [u32; 2]) -> impl Iterator<Item = (u32, u32)> {
    let [columns, rows] = [(x, size[0]), (y, size[1])].map(|(k, end)| k * TILE..(k * TILE + TILE).min(end));
    rows.flat_map(move |j| columns.clone().map(move |i| (i, j)))
}

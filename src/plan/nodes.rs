//! A tree of squares over a band's tiles, four by four children a node, each with bounds on its rays; below the tiles
//! that hold several cells, these.

use super::tiles::{Bounds, Sample, Sampled};
use crate::gpu::rows::{self, BRANCH, RAYS_AFFINE, RAYS_LOOSE, RAYS_NONE, RAYS_TORN};
use glam::{DVec2, DVec3};
use rayon::prelude::*;

/// All levels of nodes, tiles first; behind them those of cells.
#[derive(Debug, Clone, Default)]
pub struct Nodes {
    pub nodes: Vec<rows::Node>,
    /// Of each level: index of its first node, nodes a row, rows.
    pub levels: Vec<Level>,
    /// Every node's rays are one affine bundle.
    pub exact: bool,
    /// Some node of level 1 is torn: cull descends to tiles and cells there.
    pub torn: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Level {
    pub start: u32,
    pub width: u32,
    pub height: u32,
}

/// An affine fit of rays over a square, (x, y) in [-1, 1]^2, and how far the rays may lie from it.
#[derive(Debug, Clone, Copy, Default)]
pub struct Fit {
    p: [DVec3; 3],
    d: [DVec3; 3],
    r_p: f64,
    r_d: f64,
    rays: u32,
    /// How wide the bundles are, on average, that cull may hand on in its stead; see [`Depth::width`].
    below: f64,
}

/// Where bundles are compared.
#[derive(Debug, Clone, Copy)]
pub struct Depth {
    /// Of the scene, relative to the anchor.
    pub middle: DVec3,
    pub t_range: [f64; 2],
}

impl Depth {
    /// Half-size of a bundle as far along its middle ray as the scene's middle is.
    fn width(&self, fit: &Fit) -> f64 {
        let [t0, t1] = self.t_range;
        let t = (self.middle - fit.p[0]).length() / fit.d[0].length();
        let t = if t.is_finite() { t.min(t0.abs().max(t1.abs())) } else { 0.0 };
        let half = |c: &[DVec3; 3], r: f64| c[1].length() + c[2].length() + r;
        half(&fit.p, fit.r_p) + t * half(&fit.d, fit.r_d)
    }

    /// Marks a node as torn where what lies below it is bounded much better.
    fn marked(&self, fit: Fit, below: f64) -> Fit {
        let width = self.width(&fit);
        let torn = fit.rays == RAYS_LOOSE && fit.strays() && below < TORN_WIDTH * width;
        if torn { Fit { rays: RAYS_TORN, below, ..fit } } else { Fit { below: width, ..fit } }
    }
}

/// What f32 rounding of a node's row and of what kernels compute from it may add to its radii, relative to the sizes
/// summed and the radii themselves: four roundings of 2^-24.
const NODE_SLACK: f64 = 1.0 / (1u64 << 22) as f64;
/// Residuals below this share of the rays' size are rounding of the fit itself: 64 samples of some 2^-50 each.
const FIT_ROUNDING: f64 = 1.0 / (1u64 << 40) as f64;
/// Rays stray that lie farther from their fit than this share of its slopes: twice that is a Newton step's slack in
/// the node's units, and of half the node such a step says nothing any more.
const TORN: f64 = 0.25;
/// And farther than this share of their own size: next to no slope at all a hair would count.
const TORN_SIZE: f64 = 1.0 / (1u64 << 12) as f64;
/// It pays to hand on what is below a torn node where that is narrower than this share of the node: a quarter of the
/// triangles then, each with a set-up of its own.
const TORN_WIDTH: f64 = 0.5;

impl Nodes {
    /// From the rays of each tile, row by row, and of its cells where they are several. At least two levels; the top one
    /// at most 2 x 2 nodes.
    pub fn new(tiles: &[Bounds], (tiles_x, tiles_y): (u32, u32), depth: Depth) -> Nodes {
        let cells: Vec<Vec<Fit>> = tiles.par_iter().map(|tile| tile.each.iter().map(Fit::of).collect()).collect();
        let tile = |(tile, cells): (&Bounds, &Vec<Fit>)| {
            depth.marked(Fit::of(&tile.whole), mean(cells.iter().map(|c| depth.width(c))))
        };
        let mut fits: Vec<Fit> = tiles.par_iter().zip(&cells).map(tile).collect();
        let mut nodes = Nodes { nodes: Vec::new(), levels: levels(tiles_x, tiles_y), exact: true, torn: false };
        for (k, Level { width, height, .. }) in nodes.levels.iter().enumerate() {
            if k > 0 {
                let below = nodes.levels[k - 1];
                let at = |n: u32| parent(&fits, (below.width, below.height), n % width, n / width, depth);
                fits = (0..width * height).into_par_iter().map(at).collect();
            }
            nodes.exact &= fits.iter().all(|f| f.rays == RAYS_AFFINE || f.rays == RAYS_NONE);
            nodes.torn |= k == 1 && fits.iter().any(|f| f.rays == RAYS_TORN);
            nodes.nodes.extend(fits.iter().map(Fit::row));
        }
        nodes.nodes.extend(cells.iter().flatten().map(Fit::row));
        nodes
    }

    /// Dispatches in which cull descends: a level each, down to level 1; one more from there where rays are torn.
    pub fn cull_steps(&self) -> u32 {
        self.levels.len() as u32 - 1 + u32::from(self.torn)
    }
}

/// The levels over a grid of tiles.
fn levels(tiles_x: u32, tiles_y: u32) -> Vec<Level> {
    let mut list = vec![Level { start: 0, width: tiles_x, height: tiles_y }];
    loop {
        let Level { start, width, height } = list[list.len() - 1];
        if list.len() >= 2 && width <= TOP && height <= TOP {
            return list;
        }
        let (w, h) = (width.div_ceil(BRANCH), height.div_ceil(BRANCH));
        list.push(Level { start: start + width * height, width: w, height: h });
    }
}

/// How many nodes lie before the first cell's.
pub fn above_cells(tiles_x: u32, tiles_y: u32) -> u32 {
    levels(tiles_x, tiles_y).last().map_or(0, |top| top.start + top.width * top.height)
}

/// Nodes a side at most on the top level.
const TOP: u32 = 2;

/// A node from its children: their rays are those at the corners of their own fits, give or take their radii.
fn parent(children: &[Fit], (width, height): (u32, u32), x: u32, y: u32, depth: Depth) -> Fit {
    let mut below = Sampled::default();
    let mut affine = true;
    let mut widths = Vec::new();
    for j in 0..BRANCH.min(height - y * BRANCH) {
        for i in 0..BRANCH.min(width - x * BRANCH) {
            let child = &children[((y * BRANCH + j) * width + x * BRANCH + i) as usize];
            if child.rays == RAYS_NONE {
                continue;
            }
            affine &= child.rays == RAYS_AFFINE;
            widths.push(child.below);
            (below.r_p, below.r_d) = (below.r_p.max(child.r_p), below.r_d.max(child.r_d));
            let half = 1.0 / BRANCH as f64;
            let middle = (2.0 * DVec2::new(i as f64, j as f64) + 1.0) * half - 1.0;
            for corner in [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)].map(DVec2::from) {
                let at = |c: &[DVec3; 3]| c[0] + corner.x * c[1] + corner.y * c[2];
                below.samples.push(Sample { place: middle + half * corner, p: at(&child.p), d: at(&child.d) });
            }
        }
    }
    let fit = Fit::of(&below);
    let rays = if affine { fit.rays } else { fit.rays.min(RAYS_LOOSE) };
    depth.marked(Fit { rays, ..fit }, mean(widths.into_iter()))
}

/// Infinite of nothing.
fn mean(values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let n = values.len() as f64;
    if n > 0.0 { values.sum::<f64>() / n } else { f64::INFINITY }
}

/// The affine function nearest to values at places, by least squares: value in the middle and slopes; and the largest
/// distance that remains. At least one place.
pub fn affine(places: &[DVec2], values: &[DVec3]) -> ([DVec3; 3], f64) {
    let n = places.len() as f64;
    let middle = places.iter().sum::<DVec2>() / n;
    let mean = values.iter().sum::<DVec3>() / n;
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    let mut right = [DVec3::ZERO; 2];
    for (place, value) in places.iter().zip(values) {
        let q = *place - middle;
        (xx, xy, yy) = (xx + q.x * q.x, xy + q.x * q.y, yy + q.y * q.y);
        right[0] += q.x * (*value - mean);
        right[1] += q.y * (*value - mean);
    }
    let det = xx * yy - xy * xy;
    // places on a line fix no plane: the mean alone, and honest radii
    let inverse = if det > FIT_ROUNDING * (xx + yy).powi(2) { [yy / det, -xy / det, xx / det] } else { [0.0; 3] };
    let x = inverse[0] * right[0] + inverse[1] * right[1];
    let y = inverse[1] * right[0] + inverse[2] * right[1];
    let fit = [mean - middle.x * x - middle.y * y, x, y];
    let far = |(q, v): (&DVec2, &DVec3)| (fit[0] + q.x * fit[1] + q.y * fit[2] - *v).length();
    (fit, places.iter().zip(values).map(far).fold(0.0, f64::max))
}

impl Fit {
    /// The bundle nearest to the samples; its radii hold them and what lies that far from them.
    pub fn of(sampled: &Sampled) -> Fit {
        if sampled.samples.is_empty() {
            return Fit::default();
        }
        let list = |f: fn(&Sample) -> DVec3| sampled.samples.iter().map(f).collect::<Vec<_>>();
        let places: Vec<DVec2> = sampled.samples.iter().map(|s| s.place).collect();
        let (p, off_p) = affine(&places, &list(|s| s.p));
        let (d, off_d) = affine(&places, &list(|s| s.d));
        let (r_p, r_d) = (off_p + sampled.r_p, off_d + sampled.r_d);
        let mut fit = Fit { p, d, r_p, r_d, rays: RAYS_LOOSE, below: f64::INFINITY };
        let (size_p, size_d) = fit.sizes();
        if r_p <= FIT_ROUNDING * size_p && r_d <= FIT_ROUNDING * size_d {
            fit.rays = RAYS_AFFINE;
        }
        fit
    }

    /// Origins or directions lie so far from the fit that it says little.
    pub fn strays(&self) -> bool {
        let far = |r: f64, fit: &[DVec3; 3], size: f64| {
            r > TORN * (fit[1].length() + fit[2].length()) && r > TORN_SIZE * size
        };
        let (size_p, size_d) = self.sizes();
        far(self.r_p, &self.p, size_p) || far(self.r_d, &self.d, size_d)
    }

    /// How far rays may lie from the fit, against how large they are.
    pub fn looseness(&self) -> f64 {
        let (size_p, size_d) = self.sizes();
        let share = |r: f64, size: f64| if r > 0.0 { r / size } else { 0.0 };
        share(self.r_p, size_p) + share(self.r_d, size_d)
    }

    fn sizes(&self) -> (f64, f64) {
        let size = |c: &[DVec3; 3]| c.iter().map(|v| v.length()).sum::<f64>();
        (size(&self.p), size(&self.d))
    }

    fn row(&self) -> rows::Node {
        let (size_p, size_d) = self.sizes();
        let v = |v: DVec3| v.as_vec3().to_array();
        rows::Node {
            p: v(self.p[0]),
            r_p: (self.r_p + NODE_SLACK * (size_p + self.r_p)) as f32,
            px: v(self.p[1]),
            r_d: (self.r_d + NODE_SLACK * (size_d + self.r_d)) as f32,
            py: v(self.p[2]),
            rays: self.rays,
            d: v(self.d[0]),
            pad0: 0.0,
            dx: v(self.d[1]),
            pad1: 0.0,
            dy: v(self.d[2]),
            pad2: 0.0,
        }
    }
}

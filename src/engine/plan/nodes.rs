//! A tree of squares over a band's tiles, four by four children a node, each with bounds on its rays; below the tiles
//! that hold several cells, these.

use super::fit::Fit;
use super::tiles::{TileFits, TileRay, TileRays};
use crate::arrays::MapEach;
use crate::gpu::layout::{self, BRANCH, RAYS_AFFINE, RAYS_DISCONTINUOUS, RAYS_LOOSE, RAYS_NONE};
use crate::parallel;
use glam::{DVec2, DVec3};

/// All levels of nodes, tiles first; behind them those of cells.
#[derive(Debug, Clone, Default)]
pub struct Nodes {
    pub nodes: Vec<layout::Node>,
    /// Of each level: index of its first node, nodes a row, rows.
    pub levels: Vec<Level>,
    /// Every node's rays are one affine bundle.
    pub exact: bool,
    /// Some node of level 1 is discontinuous: cull descends to tiles and cells there.
    pub discontinuous: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Level {
    pub start: u32,
    pub width: u32,
    pub height: u32,
}

/// The rays of a node, before they are packed.
struct NodeFit {
    fit: Fit,
    /// Mean width of the bundles that `cull` passes on here: the node's own, or its children's if they are bounded separately; see
    /// [`WidthMeasure::width`].
    width: f64,
}

/// Where bundles are compared.
#[derive(Debug, Clone, Copy)]
pub struct WidthMeasure {
    /// Of the scene, relative to the anchor.
    pub centre: DVec3,
    pub t_range: [f64; 2],
    /// The rays are incoherent: cull descends to every tile.
    pub incoherent: bool,
    /// By which rays are perturbed; 0 for rays that are not.
    pub scene_size: f64,
}

impl WidthMeasure {
    /// Half-size of a bundle as far along its central ray as the scene's centre is.
    fn width(&self, fit: &Fit) -> f64 {
        let [t0, t1] = self.t_range;
        let t = (self.centre - fit.p[0]).length() / fit.d[0].length();
        let t = if t.is_finite() { t.min(t0.abs().max(t1.abs())) } else { 0.0 };
        let half = |c: &[DVec3; 3], r: f64| c[1].length() + c[2].length() + r;
        half(&fit.p, fit.r_p) + t * half(&fit.d, fit.r_d)
    }

    /// A node above bundles of these widths: discontinuous where they are bounded much better than it, or where rays are incoherent.
    fn node_fit(&self, fit: Fit, below: impl ExactSizeIterator<Item = f64>) -> NodeFit {
        let (width, count) = (self.width(&fit), below.len() as f64);
        let below = below.sum::<f64>() / count;
        // the mean of nothing is NaN, which is not narrower
        let is_narrower = fit.is_loose() && below < DISCONTINUOUS_WIDTH * width;
        let discontinuous = fit.rays == RAYS_LOOSE && (is_narrower || self.incoherent && count > 0.0);
        if discontinuous {
            NodeFit { fit: Fit { rays: RAYS_DISCONTINUOUS, ..fit }, width: below }
        } else {
            NodeFit { fit, width }
        }
    }
}

/// It pays to hand on what is below a discontinuous node where that is narrower than this share of the node: a quarter of the
/// triangles then, each with a set-up of its own.
pub const DISCONTINUOUS_WIDTH: f64 = 0.5;

impl Nodes {
    /// From the rays of each tile, row by row, and of its cells where they are several. At least two levels; the top one
    /// at most 2 x 2 nodes.
    pub fn new(tiles: &[TileFits], (tiles_x, tiles_y): (u32, u32), measure: WidthMeasure) -> Nodes {
        let tile = |tile: &TileFits| measure.node_fit(tile.whole, tile.each.iter().map(|cell| measure.width(cell)));
        let mut fits: Vec<NodeFit> = parallel::map(tiles, tile);
        let mut nodes =
            Nodes { nodes: Vec::new(), levels: levels(tiles_x, tiles_y), exact: true, discontinuous: false };
        for (k, Level { width, height, .. }) in nodes.levels.iter().enumerate() {
            if k > 0 {
                let below = nodes.levels[k - 1];
                let at = |n: u32| parent(&fits, (below.width, below.height), n % width, n / width, measure);
                fits = parallel::map(0..width * height, at);
            }
            let all = || fits.iter().map(|s| s.fit);
            nodes.exact &= all().all(|f| f.rays == RAYS_AFFINE || f.rays == RAYS_NONE);
            nodes.discontinuous |= k == 1 && all().any(|f| f.rays == RAYS_DISCONTINUOUS);
            nodes.nodes.extend(all().map(|f| f.packed(measure.scene_size)));
        }
        nodes.nodes.extend(tiles.iter().flat_map(|tile| &tile.each).map(|f| f.packed(measure.scene_size)));
        nodes
    }

    /// Says of each node which piece owns all of its square's pixels; `alone` says it of a tile.
    pub fn own(&mut self, alone: impl Fn(u32, u32) -> u32) {
        for (k, level) in self.levels.clone().into_iter().enumerate() {
            for y in 0..level.height {
                for x in 0..level.width {
                    let piece = match k.checked_sub(1).map(|k| self.levels[k]) {
                        None => alone(x, y),
                        Some(below) => {
                            let rows = BRANCH * y..(BRANCH * (y + 1)).min(below.height);
                            let columns = || BRANCH * x..(BRANCH * (x + 1)).min(below.width);
                            let all = rows.flat_map(|j| columns().map(move |i| below.start + j * below.width + i));
                            let mut all = all.map(|n| self.nodes[n as usize].piece);
                            let first = all.next().unwrap_or(layout::NONE);
                            if all.all(|p| p == first) { first } else { layout::NONE }
                        }
                    };
                    self.nodes[(level.start + y * level.width + x) as usize].piece = piece;
                }
            }
        }
    }

    /// Dispatches in which cull descends: a level each, down to level 1; one more from there where rays are discontinuous.
    pub fn cull_steps(&self) -> u32 {
        self.levels.len() as u32 - 1 + u32::from(self.discontinuous)
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
fn parent(children: &[NodeFit], (width, height): (u32, u32), x: u32, y: u32, measure: WidthMeasure) -> NodeFit {
    let mut below = TileRays::default();
    let mut affine = true;
    let mut widths = Vec::new();
    for j in 0..BRANCH.min(height - y * BRANCH) {
        for i in 0..BRANCH.min(width - x * BRANCH) {
            let NodeFit { fit: child, width } = &children[((y * BRANCH + j) * width + x * BRANCH + i) as usize];
            if child.rays == RAYS_NONE {
                continue;
            }
            affine &= child.rays == RAYS_AFFINE;
            widths.push(*width);
            (below.r_p, below.r_d) = (below.r_p.max(child.r_p), below.r_d.max(child.r_d));
            let half = 1.0 / BRANCH as f64;
            let centre = (2.0 * DVec2::new(i as f64, j as f64) + 1.0) * half - 1.0;
            for corner in [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)].map_each(DVec2::from) {
                let at = |c: &[DVec3; 3]| c[0] + corner.x * c[1] + corner.y * c[2];
                below.rays.push(TileRay { place: centre + half * corner, p: at(&child.p), d: at(&child.d) });
            }
        }
    }
    let fit = Fit::of(&below);
    let rays = if affine { fit.rays } else { fit.rays.min(RAYS_LOOSE) };
    measure.node_fit(Fit { rays, ..fit }, widths.into_iter())
}

//! A tree of squares over a band's tiles, four by four children a node, each with bounds on its rays; below the tiles
//! that hold several cells, these.

use super::fit::Fit;
use super::tiles::{TileFits, TileRay, TileRays};
use crate::arrays::MapEach;
use crate::gpu::layout::{self, BRANCH, RAYS_AFFINE, RAYS_DISCONTINUOUS, RAYS_LOOSE, RAYS_NONE};
use crate::parallel;
use bytemuck::Zeroable;
use glam::{DVec2, DVec3};
use std::borrow::Borrow;

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
    /// The piece that owns all pixels of the square; see [`TileFits::sole_piece`].
    sole_piece: Option<u32>,
    /// Mean width of the bundles that `cull` passes on here: the node's own, or its children's if they are bounded separately; see
    /// [`WidthMeasure::width`].
    width: f64,
}

impl NodeFit {
    /// Returns the node of a tile.
    fn of_tile(tile: &TileFits, measure: WidthMeasure) -> NodeFit {
        let node = measure.node_fit(tile.whole, tile.each.iter().map(|cell| measure.width(cell)));
        NodeFit { sole_piece: tile.sole_piece, ..node }
    }

    /// All rays are affine, or there are none.
    fn is_exact(&self) -> bool {
        self.fit.rays == RAYS_AFFINE || self.fit.rays == RAYS_NONE
    }

    fn packed(&self, measure: WidthMeasure) -> layout::Node {
        let piece = self.sole_piece.unwrap_or(layout::NONE);
        layout::Node { piece, ..self.fit.packed(measure.scene_size) }
    }
}

/// A row of nodes right above tiles.
#[derive(Default)]
struct NodeRow {
    fits: Vec<NodeFit>,
    /// Nodes of the cells of all tiles below that have several cells.
    of_cells: Vec<layout::Node>,
    /// Each tile below has one affine bundle of rays, or no ray.
    exact: bool,
}

impl NodeRow {
    /// Returns the row of nodes above up to four rows of tiles, and writes the tiles' own nodes to `nodes`.
    fn of_tiles<T: Borrow<TileFits>>(
        nodes: &mut [layout::Node],
        tile: impl Fn(usize) -> T,
        tiles_x: u32,
        measure: WidthMeasure,
    ) -> NodeRow {
        let rows = nodes.len() as u32 / tiles_x;
        let mut row = NodeRow { exact: true, ..NodeRow::default() };
        let mut of_cells: Vec<Vec<layout::Node>> = vec![Vec::new(); rows as usize];
        for x in (0..tiles_x).step_by(BRANCH as usize) {
            let columns = BRANCH.min(tiles_x - x);
            let places = (0..rows).flat_map(|j| (x..x + columns).map(move |i| (i, j)));
            let below: Vec<NodeFit> = places
                .map(|(i, j)| {
                    let k = (j * tiles_x + i) as usize;
                    let fits = tile(k);
                    let node = NodeFit::of_tile(fits.borrow(), measure);
                    nodes[k] = node.packed(measure);
                    of_cells[j as usize].extend(fits.borrow().each.iter().map(|cell| cell.packed(measure.scene_size)));
                    row.exact &= node.is_exact();
                    node
                })
                .collect();
            row.fits.push(parent(|i, j| &below[(j * columns + i) as usize], [columns, rows], measure));
        }
        row.of_cells = of_cells.concat();
        row
    }
}

/// The place along rays where the widths of bundles are compared, and what counts as their width.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WidthMeasure {
    /// How far along a bundle's central ray, world units: [`crate::camera::perturb::scene_size`], which no pose changes.
    pub distance: f64,
    pub t_range: [f64; 2],
    /// The rays are incoherent: cull descends to every tile.
    pub incoherent: bool,
    /// By which rays are perturbed; 0 for rays that are not.
    pub scene_size: f64,
}

impl WidthMeasure {
    /// Half-size of a bundle.
    fn width(&self, fit: &Fit) -> f64 {
        let [t0, t1] = self.t_range;
        let t = self.distance / fit.d[0].length();
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
            NodeFit { fit: Fit { rays: RAYS_DISCONTINUOUS, ..fit }, sole_piece: None, width: below }
        } else {
            NodeFit { fit, sole_piece: None, width }
        }
    }
}

/// It pays to hand on what is below a discontinuous node where that is narrower than this share of the node: a quarter of the
/// triangles then, each with a set-up of its own.
pub const DISCONTINUOUS_WIDTH: f64 = 0.5;

impl Nodes {
    /// Builds the tree; `tile` returns the bounds of a tile, counted row by row. There are at least two levels, and the top one has at most 2 x 2
    /// nodes.
    pub fn new<T: Borrow<TileFits>>(
        tile: impl Fn(usize) -> T + Sync,
        (tiles_x, tiles_y): (u32, u32),
        measure: WidthMeasure,
    ) -> Nodes {
        let levels = levels(tiles_x, tiles_y);
        let mut nodes = vec![layout::Node::zeroed(); above_cells(tiles_x, tiles_y) as usize];
        // bounds in f64 take several times the memory of nodes: the bounds of tiles are dropped once the node above is made
        let mut rows: Vec<NodeRow> = (0..levels[1].height).map(|_| NodeRow::default()).collect();
        let of_tiles = nodes[..levels[1].start as usize].chunks_mut((BRANCH * tiles_x) as usize);
        parallel::for_each(of_tiles.zip(&mut rows).enumerate(), |(y, (nodes, row))| {
            let first = y * (BRANCH * tiles_x) as usize;
            *row = NodeRow::of_tiles(nodes, |k| tile(first + k), tiles_x, measure);
        });
        let mut exact = rows.iter().all(|row| row.exact);
        let of_cells: Vec<layout::Node> = rows.iter_mut().flat_map(|row| std::mem::take(&mut row.of_cells)).collect();
        let mut fits: Vec<NodeFit> = rows.into_iter().flat_map(|row| row.fits).collect();
        let mut discontinuous = false;
        for (k, Level { start, width, height }) in levels.iter().enumerate().skip(1) {
            if k > 1 {
                let below = levels[k - 1];
                let at = |n: u32| {
                    let (x, y) = (BRANCH * (n % width), BRANCH * (n / width));
                    let child = |i: u32, j: u32| &fits[((y + j) * below.width + x + i) as usize];
                    parent(child, [below.width - x, below.height - y], measure)
                };
                fits = parallel::map(0..width * height, at);
            }
            exact &= fits.iter().all(NodeFit::is_exact);
            discontinuous |= k == 1 && fits.iter().any(|node| node.fit.rays == RAYS_DISCONTINUOUS);
            nodes[*start as usize..].iter_mut().zip(&fits).for_each(|(node, fit)| *node = fit.packed(measure));
        }
        nodes.extend(of_cells);
        Nodes { nodes, levels, exact, discontinuous }
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

/// A node from its children; `left` is the number of columns and rows of children from `child(0, 0)` to the border. It bounds the rays at the
/// corners of the children's fits, plus their radii. If one affine piece owns all children, it takes that piece's rays instead.
fn parent<'a>(child: impl Fn(u32, u32) -> &'a NodeFit, left: [u32; 2], measure: WidthMeasure) -> NodeFit {
    let [columns, rows] = left.map_each(|left| left.min(BRANCH));
    let first = child(0, 0);
    let mut all = (0..rows).flat_map(|j| (0..columns).map(move |i| (i, j)));
    let sole_piece = first.sole_piece.filter(|piece| all.all(|(i, j)| child(i, j).sole_piece == Some(*piece)));
    if sole_piece.is_some() && first.fit.is_of_bundle() {
        let fit = first.fit.extended(BRANCH.into());
        return NodeFit { fit, sole_piece, width: measure.width(&fit) };
    }
    let mut below = TileRays::default();
    let mut affine = true;
    let mut widths = Vec::new();
    for j in 0..rows {
        for i in 0..columns {
            let NodeFit { fit: child, width, .. } = child(i, j);
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
    NodeFit { sole_piece, ..measure.node_fit(Fit { rays, ..fit }, widths.into_iter()) }
}

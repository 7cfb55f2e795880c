//! What `solve` knows of a camera's pieces and of points: each piece about an anchor of its own, so that f32 holds what a point's image
//! depends on. Curves: [`cells`].

pub mod cells;

use crate::arrays::MapEach;
use crate::camera::Camera;
use crate::camera::mesh::overlap::first_overlap;
use crate::camera::pieces::{Piece, Pieces};
use crate::camera::project::tree::{INNER, Tree};
use crate::gpu::layout::{NONE, SolveImage, SolvePiece, SolvePoint};
use crate::parallel;
use glam::{DVec2, DVec3};

/// The pieces of a layer.
pub struct SolveTable {
    pub pieces: Vec<SolvePiece>,
    /// The piece of each node of the layer's tree; [`NONE`] of those that are no leaves.
    pub leaves: Vec<u32>,
    /// Ends of t_range; [`ENDLESS`] in place of what is beyond.
    pub t_range: [f32; 2],
    origin: Origin,
}

/// Where the camera's coordinates in f32 begin.
#[derive(Debug, Clone, Copy)]
struct Origin {
    anchor: DVec3,
    /// The length that is 1: a power of 2.
    unit: f64,
}

/// Stands for an end of t_range that is none, as in the kernel.
const ENDLESS: f64 = (1u64 << 60) as f64;

/// Flags of a piece, as in the kernel.
const SOLVABLE: u32 = 1;
const ALONE: u32 = 2;

/// Largest coordinate, and largest half of a piece, px: products of three columns are within f32, and a px is far above its rounding.
const MOST: f64 = (1u64 << 20) as f64;
const HALF_PX_MOST: f64 = 32768.0;

/// Smallest magnitude that is not taken for 0 by what underflows.
const LEAST: f64 = 1.0 / (1u64 << 20) as f64;

/// How far beyond a piece's border the host may take a place for one of the piece, px: it does up to 1e-9, and a ray for one through the
/// point that misses it by 1e-7 of a pixel's footprint.
const BEYOND_PX: f64 = 1.0 / 64.0;

/// Points farther away than this from the anchor are left to the host; the kernel looks again, from each piece.
const FARTHEST: f64 = (1u64 << 30) as f64;

impl SolveTable {
    /// Of a layer of the camera, and its tree.
    pub fn new(camera: &Camera, pieces: &Pieces, tree: &Tree) -> SolveTable {
        let all = &pieces.pieces;
        let longest = all.iter().map(|p| (p.bundle.d[0] / p.bundle.h[0]).abs().max_element()).fold(0.0, f64::max);
        let origin = Origin::new(tree.anchor, longest);
        let size = DVec2::new(camera.width.into(), camera.height.into());
        let corners: Option<Vec<[DVec2; 3]>> = all.iter().map(|p| p.corners_px).collect();
        let is_alone = all.len() == 1 || corners.is_some_and(|corners| first_overlap(&corners).is_none());
        let flags = SOLVABLE | if is_alone { ALONE } else { 0 };
        let packed = |p: &Piece| packed(p, size, &origin, flags).unwrap_or(bytemuck::Zeroable::zeroed());
        let t_range = camera.t_range.map_each(|t| t.clamp(-ENDLESS, ENDLESS) as f32);
        SolveTable { pieces: parallel::map(all, packed), leaves: leaves(tree), t_range, origin }
    }

    /// A point about the anchor.
    pub fn point(&self, point: DVec3) -> SolvePoint {
        self.origin.point(point)
    }

    /// Where an image lies, px.
    pub fn place_px(&self, image: &SolveImage) -> DVec2 {
        let piece = &self.pieces[image.piece as usize];
        let base = DVec2::new(piece.base_x.into(), piece.base_y.into());
        base + DVec2::new(image.x_px.into(), image.y_px.into())
    }
}

/// The leaf of each node; [`NONE`] of those that are none.
fn leaves(tree: &Tree) -> Vec<u32> {
    tree.nodes.iter().map(|n| if n.leaf == INNER { NONE } else { n.leaf }).collect()
}

impl Origin {
    /// For rays that are so long.
    fn new(anchor: DVec3, longest: f64) -> Origin {
        let unit = if longest > 0.0 && longest.is_finite() {
            longest.log2().ceil().clamp(-1000.0, 1000.0).exp2()
        } else {
            1.0
        };
        Origin { anchor, unit }
    }

    /// The two halves of a place of the world, and the place that they are.
    fn split(&self, place: DVec3) -> ([[f32; 3]; 2], DVec3) {
        let [hi, lo] = pair((place - self.anchor) / self.unit);
        let own = DVec3::from_array(hi.map_each(f64::from)) + DVec3::from_array(lo.map_each(f64::from));
        ([hi, lo], self.anchor + self.unit * own)
    }

    fn point(&self, point: DVec3) -> SolvePoint {
        let x = (point - self.anchor) / self.unit;
        if !x.is_finite() || x.abs().max_element() > FARTHEST {
            return SolvePoint { hi: [0.0; 3], is_near: 0, lo: [0.0; 3], pad0: 0 };
        }
        let [hi, lo] = pair(x);
        SolvePoint { hi, is_near: 1, lo, pad0: 0 }
    }
}

/// The sum of two f32, nearest to f64.
fn pair(x: DVec3) -> [[f32; 3]; 2] {
    let hi = x.as_vec3();
    [hi.to_array(), (x - hi.as_dvec3()).as_vec3().to_array()]
}

/// `None` where f32 does not hold it.
fn packed(piece: &Piece, size: DVec2, origin: &Origin, flags: u32) -> Option<SolvePiece> {
    let outline = match piece.corners_px {
        Some(corners) => corners.to_vec(),
        None => vec![DVec2::ZERO, DVec2::new(size.x, 0.0), size, DVec2::new(0.0, size.y)],
    };
    let lo = outline.iter().fold(DVec2::INFINITY, |m, q| m.min(*q));
    let hi = outline.iter().fold(DVec2::NEG_INFINITY, |m, q| m.max(*q));
    let half_px = f64::from((0.5 * (hi - lo).max_element()) as f32);
    if !(half_px > LEAST && half_px < HALF_PX_MOST) {
        return None;
    }
    // about a whole pixel in its middle
    let base = (0.5 * (lo + hi)).round();
    let to = base - piece.centre_px;
    let b = piece.bundle.recentred(to.x, to.y);
    let h0 = b.h[0];
    if h0 <= 0.0 || h0.is_nan() {
        return None;
    }
    let scale = [1.0 / h0, half_px / h0, half_px / h0];
    let ([anchor_hi, anchor_lo], at) = origin.split(b.p[0] / h0);
    let unit = origin.unit;
    let h = [0, 1, 2].map_each(|k| scale[k] * b.h[k]);
    let p = [0, 1, 2].map_each(|k| scale[k] * (b.p[k] - at * b.h[k]) / unit);
    let d = [0, 1, 2].map_each(|k| scale[k] * b.d[k] / unit);
    // f64 has rounded the world's coordinates far below what f32 rounds here
    let world = at.abs().max_element() / unit;
    let sizes = p.iter().chain(&d).map(|v| v.abs().max_element());
    if !(world < MOST
        && sizes.fold(0.0, f64::max) < MOST
        && d[0].abs().max_element() > LEAST
        && h[1].abs().max(h[2].abs()) < MOST)
    {
        return None;
    }
    let beyond = BEYOND_PX / half_px;
    let inwards = edges(&outline.iter().map(|q| (*q - base) / half_px).collect::<Vec<_>>())?;
    let corners = moved_out(&inwards, 4.0 * beyond)?;
    let reach = corners.iter().flat_map(|q| [q.x.abs(), q.y.abs()]).fold(0.0, f64::max);
    if reach > 64.0 {
        return None;
    }
    let v = |v: DVec3| v.as_vec3().to_array();
    let two = |k: usize| [corners[k].x, corners[k].y, corners[k + 1].x, corners[k + 1].y].map_each(|x| x as f32);
    Some(SolvePiece {
        p0: v(p[0]),
        flags,
        p1: v(p[1]),
        h1: h[1] as f32,
        p2: v(p[2]),
        h2: h[2] as f32,
        d0: v(d[0]),
        half_px: half_px as f32,
        d1: v(d[1]),
        beyond: beyond as f32,
        d2: v(d[2]),
        reach: (reach as f32).next_up(),
        anchor_hi,
        base_x: base.x as i32,
        anchor_lo,
        base_y: base.y as i32,
        corners_01: two(0),
        corners_23: two(2),
        edges: inwards.map_each(|e| e.as_vec3().extend(0.0).to_array()),
    })
}

/// `x u + y v + z` for each edge of an outline of three or four corners: the distance inwards. A triangle has its last edge twice.
fn edges(outline: &[DVec2]) -> Option<[DVec3; 4]> {
    let n = outline.len();
    let middle = outline.iter().sum::<DVec2>() / n as f64;
    let edge = |k: usize| {
        let k = k.min(n - 1);
        let (a, b) = (outline[k], outline[(k + 1) % n]);
        let normal = (b - a).perp().normalize_or_zero();
        let normal = if normal.dot(middle - a) < 0.0 { -normal } else { normal };
        (normal != DVec2::ZERO).then(|| normal.extend(-normal.dot(a)))
    };
    Some([edge(0)?, edge(1)?, edge(2)?, edge(3)?])
}

/// The corners of what is up to `by` outside of the edges: where neighbours meet. `None` of slivers.
fn moved_out(edges: &[DVec3; 4], by: f64) -> Option<[DVec2; 4]> {
    let is_triangle = edges[3] == edges[2];
    let n = if is_triangle { 3 } else { 4 };
    let corner = |k: usize| {
        let (e, f) = (edges[k.min(n - 1)], edges[(k.min(n - 1) + 1) % n]);
        let across = e.x * f.y - e.y * f.x;
        let (c, d) = (e.z + by, f.z + by);
        let q = DVec2::new(e.y * d - f.y * c, f.x * c - e.x * d) / across;
        q.is_finite().then_some(q)
    };
    Some([corner(0)?, corner(1)?, corner(2)?, corner(3)?])
}

//! Slabs: the copies of the image's tiles that one tree bounds, stacked below each other.
//!
//! Every layer of a chain is a slab, and so is every span of t of a layer of curves: over one span a curve is a
//! segment, give or take its bend. An ordinary camera has one slab.

use crate::camera::TILE;
use crate::camera::{Camera, Curve, Rays};
use crate::gpu::kernels::RaysKind;
use crate::gpu::layout::BRANCH;

/// The slabs of a camera.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Slabs {
    pub layers: u32,
    /// Into how many equal spans of t each layer is split.
    pub spans: u32,
}

/// Spans of a curve at most: beyond, each slab's own cost outweighs what its tighter bound culls.
const SPANS_MAX: u32 = 64;

/// Every how many pixels a curve is looked at to choose the spans.
const SAMPLE_STEP_PX: u32 = 16;

impl Slabs {
    pub fn of(camera: &Camera) -> Slabs {
        let layers = camera.layers.len() as u32;
        Slabs { layers, spans: if camera.is_curved() { spans(camera) } else { 1 } }
    }

    pub fn count(&self) -> u32 {
        self.layers * self.spans
    }

    /// Tile rows from one slab to the next over a band of `rows` pixels. Of several slabs a whole number of nodes, so that
    /// no node above a tile's has rays of two.
    pub fn tile_rows(&self, rows: u32) -> u32 {
        let tiles = rows.div_ceil(TILE);
        if self.count() == 1 { tiles } else { tiles.next_multiple_of(BRANCH) }
    }

    /// Layer, and the ends of the span of its t, of a slab.
    pub fn of_slab(&self, slab: u32) -> (usize, [f64; 2]) {
        let span = slab % self.spans;
        let at = |k: u32| f64::from(k) / f64::from(self.spans);
        ((slab / self.spans) as usize, [at(span), at(span + 1)])
    }
}

/// How kernels store a camera's rays.
pub fn kind(camera: &Camera) -> RaysKind {
    match camera.layers.as_slice() {
        [Rays::Field(field)] => RaysKind::Field { incoherent: field.is_reordered },
        layers if layers.iter().all(|l| matches!(l, Rays::Pieces(_))) => RaysKind::Pieces,
        layers => RaysKind::Curves { degree: layers.iter().map(degree).max().unwrap_or(1) },
    }
}

fn degree(rays: &Rays) -> u32 {
    match rays {
        Rays::Curves(c) => c.map.degree() as u32,
        _ => 1,
    }
}

/// As many spans as bring the bend of half of the curves under half the distance to the next tile's: the bend falls
/// with the square of their number.
fn spans(camera: &Camera) -> u32 {
    let mut wanted = Vec::new();
    for layer in 0..camera.layers.len() {
        for j in (SAMPLE_STEP_PX / 2..camera.height).step_by(SAMPLE_STEP_PX as usize) {
            for i in (SAMPLE_STEP_PX / 2..camera.width).step_by(SAMPLE_STEP_PX as usize) {
                let near = (i.saturating_sub(TILE).max(i % TILE), j);
                let (Some((_, c)), Some((_, next))) = (camera.curve(layer, i, j), camera.curve(layer, near.0, near.1))
                else {
                    continue;
                };
                let distance = (c.at(0.5) - next.at(0.5)).length();
                if bend(&c) > 0.0 {
                    wanted.push((2.0 * bend(&c) / distance.max(f64::MIN_POSITIVE)).sqrt());
                }
            }
        }
    }
    wanted.sort_by(f64::total_cmp);
    let middle = wanted.get(wanted.len() / 2).copied().unwrap_or(1.0);
    (middle.ceil().min(f64::from(SPANS_MAX)) as u32).max(1)
}

/// How far a curve may lie from its chord at the same t: Bernstein weights are positive and add up to 1, and the chord is
/// the curve of evenly spaced control points.
pub fn bend(curve: &Curve) -> f64 {
    let (p, m) = (curve.points(), curve.degree() as f64);
    p.iter().enumerate().map(|(k, q)| (*q - p[0].lerp(p[curve.degree()], k as f64 / m)).length()).fold(0.0, f64::max)
}

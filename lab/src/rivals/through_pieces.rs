//! Draws of every triangle through every piece: `raster-warp` and `raster-bound`.
//!
//! * warp: vertices are projected exactly, and what is between them straight (Brosz et al. 2007; Popescu et al., section 4.2).
//!   Subdividing triangles beforehand brings the edges nearer to what they should be. Of a
//!   camera of several layers, what a segment's t does not reach is cut off first.
//! * bound: a triangle around the image of each triangle, whose fragments intersect their own rays with its plane (Hou et al.
//!   2006, section 2); all cameras in one instanced draw, or a pass for each as in the paper.

use super::draw::{BandRaster, Draw};
use super::outline;
use super::{kernels, with};
use anamorph::internals::engine::rival::{Rival, Setup, Target};
use anamorph::internals::gpu::Gpu;
use anamorph::internals::gpu::buffers::Buffers;
use anamorph::internals::gpu::recorder::Recorder;
use anamorph::internals::input::Result;

struct ThroughPieces {
    draw: Draw,
    band_raster: BandRaster,
    own: Buffers,
    /// Draws of a triangle.
    parts: u32,
    pieces: u32,
    /// Each piece has a pass of its own.
    is_each: bool,
}

/// Triangles that are left of one between two planes.
const CUT_TRIANGLES: u32 = 3;

/// The parameter: how often each triangle is split in four.
pub fn warp(gpu: &Gpu, setup: &Setup) -> Result<Box<dyn Rival>> {
    let layers = setup.layers();
    let fan = if layers > 1 { CUT_TRIANGLES } else { 1 };
    let kernel = kernels::warp(layers, setup.variant.extras.culling, setup.parameter, fan);
    Ok(Box::new(ThroughPieces::new(gpu, setup, Draw::clipped(gpu, kernel, 1)?, fan << (2 * setup.parameter))?))
}

pub fn bound(gpu: &Gpu, setup: &Setup) -> Result<Box<dyn Rival>> {
    Ok(Box::new(ThroughPieces::new(gpu, setup, bound_draw(gpu, setup)?, 1)?))
}

/// A pass for each camera.
pub fn bound_passes(gpu: &Gpu, setup: &Setup) -> Result<Box<dyn Rival>> {
    Ok(Box::new(ThroughPieces { is_each: true, ..ThroughPieces::new(gpu, setup, bound_draw(gpu, setup)?, 1)? }))
}

fn bound_draw(gpu: &Gpu, setup: &Setup) -> Result<Draw> {
    Draw::clipped(gpu, kernels::bound(setup.layers(), setup.variant.extras.culling, setup.centre - setup.anchor), 1)
}

impl ThroughPieces {
    fn new(gpu: &Gpu, setup: &Setup, draw: Draw, parts: u32) -> Result<ThroughPieces> {
        let mut own = Buffers::default();
        let pieces = outline::upload(gpu, setup, &mut own)?;
        let band_raster = BandRaster::new(gpu, setup)?;
        Ok(ThroughPieces { draw, band_raster, own, parts, pieces, is_each: false })
    }
}

impl Rival for ThroughPieces {
    fn aim(&mut self, gpu: &Gpu, setup: &Setup) -> Result<()> {
        self.pieces = outline::upload(gpu, setup, &mut self.own)?;
        Ok(())
    }

    fn draws(&self, slots: u32) -> u64 {
        u64::from(slots) * u64::from(self.parts) * u64::from(self.pieces)
    }

    fn passes(&self, _band: &Target) -> u32 {
        1 + if self.is_each { self.pieces } else { 1 }
    }

    fn encode(&self, gpu: &Gpu, recorder: &mut Recorder, band: &Target) -> Result<()> {
        let groups = band.chunks.iter().map(|c| self.draw.bind(gpu, &with(&c.scopes, &[&self.own])));
        let groups = groups.collect::<Result<Vec<_>>>()?;
        let each = if self.is_each { 1 } else { self.pieces };
        for first in (0..self.pieces).step_by(each.max(1) as usize) {
            let mut pass = self.band_raster.raster_target.pass(recorder, "draw", first == 0);
            pass.set_pipeline(&self.draw.pipeline);
            for (group, chunk) in groups.iter().zip(&band.chunks) {
                pass.set_bind_group(0, group, &[]);
                pass.draw(0..3 * chunk.slots * self.parts, first..first + each);
            }
        }
        self.band_raster.take(gpu, recorder, band)
    }

    fn bytes(&self) -> u64 {
        self.band_raster.raster_target.bytes() + self.own.bytes()
    }
}

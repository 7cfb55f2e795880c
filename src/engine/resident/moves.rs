//! Triangles on the device that move: only the parts of tables that changed are sent.

use super::upload::place;
use super::{BvhState, ChunkOnDevice, Resident, Triangles};
use crate::engine::clusters::moved::{Moved, MovedChunk};
use crate::engine::clusters::{Chunk, Clustered};
use crate::engine::plan::hierarchy::moving::MovingBvh;
use crate::gpu::Gpu;
use crate::gpu::buffers::Buffers;
use crate::input::Result;
use glam::DVec3;

impl Resident {
    /// Updates the positions of the triangles on the device: all of them, or only the clusters and vertices in `moved`.
    pub fn move_scene(&mut self, gpu: &Gpu, triangles: Triangles, moved: Option<&Moved>, origin: DVec3) -> Result<()> {
        if triangles.0.placed.is_some() {
            return self.upload_placed_bvh(gpu, triangles.0, origin);
        }
        let (clustered, all) = triangles;
        let has_bvh = self.traces && matches!(self.bvh, BvhState::Built | BvhState::Preferred);
        let offset = clustered.anchor - origin;
        let mut rebuilds = false;
        for (k, (there, chunk)) in self.chunks.iter_mut().zip(&clustered.chunks).enumerate() {
            let chunk = &chunk.with_vertices(all, clustered.anchor);
            let moved = moved.map(|moved| &moved.chunks[k]);
            match moved {
                Some(moved) => move_chunk(gpu, &mut there.buffers, chunk, moved, clustered)?,
                None => {
                    there.buffers.upload_texels(gpu, "triangles", &chunk.triangles)?;
                    place(gpu, &mut there.buffers, chunk, clustered)?;
                }
            }
            if has_bvh {
                match there.move_bvh(gpu, chunk, moved, offset)? {
                    Fit::Refitted => {}
                    Fit::Rebuilt => rebuilds = true,
                    Fit::TooDeep => self.bvh = BvhState::GivenUp,
                }
            }
        }
        if has_bvh {
            self.rebuilds = rebuilds;
        }
        Ok(())
    }

    /// Cost of fitting the hierarchies to moved triangles, if these fit as well as the last time. Without `moved`, all triangles count.
    pub fn fit_cost(&self, moved: Option<&Moved>) -> u64 {
        if self.rebuilds {
            return self.rebuild_cost();
        }
        let slots = |k: usize| moved.map_or(u64::from(self.chunks[k].slots), |moved| moved.chunks[k].slot_count());
        self.costs.moved_triangle * (0..self.chunks.len()).map(slots).sum::<u64>()
    }

    /// Deletes the hierarchies that trace follows.
    pub fn forget_bvh(&mut self, gpu: &Gpu, triangles: Triangles, origin: DVec3) -> Result<()> {
        self.bvh = BvhState::None;
        self.upload_bvh(gpu, triangles, origin)
    }
}

/// How the hierarchy of a chunk followed moved triangles.
enum Fit {
    /// Its boxes were fitted; or it was built so that they can be from now on.
    Refitted,
    /// It was built again, as its boxes had grown.
    Rebuilt,
    /// It is deeper than the kernel can follow.
    TooDeep,
}

impl ChunkOnDevice {
    /// Fits the hierarchy that trace follows to triangles that moved.
    fn move_bvh(&mut self, gpu: &Gpu, chunk: &Chunk, moved: Option<&MovedChunk>, offset: DVec3) -> Result<Fit> {
        if let (Some(bvh), Some(moved)) = (&mut self.moving_bvh, moved)
            && let Some(changed) = bvh.refit(chunk, offset, &moved.slots())
        {
            self.buffers.update_texels(gpu, "bvh", &bvh.traced.nodes, &changed.nodes)?;
            self.buffers.update_texels(gpu, "bvh_triangles", &bvh.traced.triangles, &changed.triangles)?;
            return Ok(Fit::Refitted);
        }
        let fit = if self.moving_bvh.is_some() { Fit::Rebuilt } else { Fit::Refitted };
        self.moving_bvh = MovingBvh::new(chunk, offset);
        let Some(bvh) = &self.moving_bvh else { return Ok(Fit::TooDeep) };
        self.buffers.upload_texels(gpu, "bvh", &bvh.traced.nodes)?;
        self.buffers.upload_texels(gpu, "bvh_triangles", &bvh.traced.triangles)?;
        Ok(fit)
    }
}

/// Sends the tables of a chunk, which has its vertices, where triangles moved.
fn move_chunk(
    gpu: &Gpu,
    buffers: &mut Buffers,
    chunk: &Chunk,
    moved: &MovedChunk,
    clustered: &Clustered,
) -> Result<()> {
    buffers.update_texels(gpu, "triangles", &chunk.triangles, &moved.slots())?;
    buffers.update_texels(gpu, "vertices", &chunk.vertices, &moved.vertices)?;
    buffers.update_texels(gpu, "clusters", &chunk.clusters(clustered.anchor), &moved.clusters)?;
    buffers.update(gpu, "triangle_groups", &chunk.triangle_groups(clustered.anchor), &moved.groups())
}

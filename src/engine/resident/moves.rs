//! Triangles on the device that move: only the parts of tables that changed are sent.

use super::upload::place;
use super::{BvhState, Resident, Triangles};
use crate::engine::clusters::Chunk;
use crate::engine::clusters::moved::{Moved, MovedChunk};
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
        for (k, (there, chunk)) in self.chunks.iter_mut().zip(&triangles.0.chunks).enumerate() {
            match moved.map(|moved| &moved.chunks[k]) {
                Some(moved) => move_chunk(gpu, &mut there.buffers, chunk, moved, triangles)?,
                None => {
                    there.buffers.upload_texels(gpu, "triangles", &chunk.triangles)?;
                    place(gpu, &mut there.buffers, chunk, triangles)?;
                }
            }
        }
        self.move_bvh(gpu, triangles, moved, origin)
    }

    /// Fits the hierarchies that trace follows to triangles that moved, where they are there.
    fn move_bvh(&mut self, gpu: &Gpu, (clustered, all): Triangles, moved: Option<&Moved>, origin: DVec3) -> Result<()> {
        if !self.traces || !matches!(self.bvh, BvhState::Built | BvhState::Preferred) {
            return Ok(());
        }
        let offset = clustered.anchor - origin;
        for (k, (there, chunk)) in self.chunks.iter_mut().zip(&clustered.chunks).enumerate() {
            let chunk = chunk.with_vertices(all, clustered.anchor);
            let moved = moved.map(|moved| moved.chunks[k].slots());
            if let (Some(bvh), Some(moved)) = (&mut there.moving_bvh, moved)
                && let Some(changed) = bvh.refit(&chunk, offset, &moved)
            {
                there.buffers.update_texels(gpu, "bvh", &bvh.traced.nodes, &changed.nodes)?;
                there.buffers.update_texels(gpu, "bvh_triangles", &bvh.traced.triangles, &changed.triangles)?;
                continue;
            }
            there.moving_bvh = MovingBvh::new(&chunk, offset);
            let Some(bvh) = &there.moving_bvh else {
                self.bvh = BvhState::GivenUp;
                continue;
            };
            there.buffers.upload_texels(gpu, "bvh", &bvh.traced.nodes)?;
            there.buffers.upload_texels(gpu, "bvh_triangles", &bvh.traced.triangles)?;
        }
        Ok(())
    }
}

/// Sends the tables of a chunk where triangles moved.
fn move_chunk(
    gpu: &Gpu,
    buffers: &mut Buffers,
    chunk: &Chunk,
    moved: &MovedChunk,
    (clustered, all): Triangles,
) -> Result<()> {
    buffers.update_texels(gpu, "triangles", &chunk.triangles, &moved.slots())?;
    buffers.update_texels(gpu, "vertices", &chunk.vertices(all, clustered.anchor), &moved.vertices)?;
    buffers.update_texels(gpu, "clusters", &chunk.clusters(clustered.anchor), &moved.clusters)?;
    buffers.update(gpu, "triangle_groups", &chunk.triangle_groups(clustered.anchor), &moved.groups())
}

//! Uploads of chunks and of bands.

use super::{ChunkOnDevice, Triangles};
use crate::engine::clusters::Chunk;
use crate::engine::plan::Band;
use crate::geometry::time_steps::MovingMesh;
use crate::gpu::Gpu;
use crate::gpu::buffers::Buffers;
use crate::gpu::kernels::SurfaceKind;
use crate::input::Result;
use wgpu::BufferUsages;

/// Uploads a chunk, into `buffers` where they are as large.
pub(super) fn chunk_on_device(
    gpu: &Gpu,
    chunk: &Chunk,
    triangles: Triangles,
    mut buffers: Buffers,
) -> Result<ChunkOnDevice> {
    let (clustered, MovingMesh { mesh, .. }) = triangles;
    place(gpu, &mut buffers, chunk, triangles)?;
    buffers.upload_texels(gpu, "triangles", &chunk.triangles)?;
    let mut surface_rows = 1;
    match clustered.surfaces {
        SurfaceKind::Plain => {
            let (rows, each) = chunk.plain_surfaces(mesh);
            surface_rows = each;
            buffers.upload_texels(gpu, "surfaces", &rows)?;
        }
        SurfaceKind::Mapped => buffers.upload_texels(gpu, "surfaces", &chunk.mapped_surfaces(mesh))?,
        SurfaceKind::Colored => buffers.upload_texels(gpu, "surfaces", &chunk.colored_surfaces(mesh))?,
    }
    buffers.upload(gpu, "slot_of_id", &chunk.slot_of_id)?;
    let clusters = chunk.cluster_count() as u32;
    let slots = chunk.triangles.len() as u32;
    let Chunk { id_first, id_count, .. } = *chunk;
    Ok(ChunkOnDevice { buffers, id_first, id_count, clusters, slots, surface_rows, moving_bvh: None, placed_bvh: None })
}

/// Uploads the tables of a chunk that are relative to the anchor.
pub(super) fn place(gpu: &Gpu, buffers: &mut Buffers, chunk: &Chunk, (clustered, all): Triangles) -> Result<()> {
    if let Some(placed) = &clustered.placed {
        // no kernel reads boxes of clusters
        return buffers.upload_texels(gpu, "vertices", &placed.vertices());
    }
    buffers.upload_texels(gpu, "vertices", &chunk.vertices(all, clustered.anchor))?;
    buffers.upload_texels(gpu, "clusters", &chunk.clusters(clustered.anchor))?;
    buffers.upload(gpu, "triangle_groups", &chunk.triangle_groups(clustered.anchor))
}

/// Bytes of a ray in each of its two tables.
const RAY_BYTES: u64 = 24;

/// A band's tables; those of its lens are there already with `keeps_lens`.
pub(super) fn upload_band(gpu: &Gpu, band: &Band, keeps_lens: bool, buffers: &mut Buffers) -> Result<()> {
    buffers.upload(gpu, "nodes", &band.nodes.nodes)?;
    if !band.moments.is_empty() {
        buffers.upload(gpu, "moments", &band.moments)?;
    }
    if let Some(turned) = &band.turned {
        buffers.upload_uniform(gpu, "viewer", &turned.pose())?;
    }
    if keeps_lens {
        return Ok(());
    }
    if let Some(turned) = &band.turned {
        buffers.upload(gpu, "lens_hi", &turned.lens.table.hi)?;
        buffers.upload(gpu, "lens_lo", &turned.lens.table.lo)?;
        let bytes = RAY_BYTES * u64::from(turned.count());
        buffers.create(gpu, "rays_hi", bytes, BufferUsages::empty())?;
        buffers.create(gpu, "rays_lo", bytes, BufferUsages::empty())?;
    }
    buffers.upload(gpu, "tile_start", &band.tiles.start)?;
    buffers.upload(gpu, "cells", &band.tiles.cells)?;
    buffers.upload_texels(gpu, "pieces", &band.tiles.pieces)?;
    if let Some(rays) = &band.rays {
        buffers.upload(gpu, "rays_hi", &rays.hi)?;
        buffers.upload(gpu, "rays_lo", &rays.lo)?;
    }
    if !band.tiles.cell_samples.is_empty() {
        buffers.upload(gpu, "cell_samples", &band.tiles.cell_samples)?;
        buffers.upload(gpu, "sample_ray_deltas", &band.sample_ray_deltas)?;
    }
    Ok(())
}

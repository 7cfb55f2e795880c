//! Uploads of chunks and of bands.

use super::{ChunkOnDevice, Triangles};
use crate::engine::clusters::{Chunk, Clustered};
use crate::engine::plan::Band;
use crate::gpu::Gpu;
use crate::gpu::buffers::Buffers;
use crate::gpu::kernels::SurfaceKind;
use crate::input::Result;
use std::sync::Arc;
use wgpu::BufferUsages;

/// Uploads a chunk, into `buffers` where they are as large.
pub(super) fn chunk_on_device(
    gpu: &Gpu,
    chunk: &Chunk,
    triangles: Triangles,
    mut buffers: Buffers,
) -> Result<ChunkOnDevice> {
    let (clustered, all) = triangles;
    let mesh = all.mesh;
    let with_vertices = clustered.placed.is_none().then(|| chunk.with_vertices(all, clustered.anchor));
    place(gpu, &mut buffers, with_vertices.as_ref().unwrap_or(chunk), clustered)?;
    drop(with_vertices);
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

/// Uploads the tables of a chunk, which has its vertices, that are relative to the anchor.
pub(super) fn place(gpu: &Gpu, buffers: &mut Buffers, chunk: &Chunk, clustered: &Clustered) -> Result<()> {
    if let Some(placed) = &clustered.placed {
        // no kernel reads boxes of clusters
        return buffers.upload_texels(gpu, "vertices", &placed.vertices());
    }
    buffers.upload_texels(gpu, "vertices", &chunk.vertices)?;
    buffers.upload_texels(gpu, "clusters", &chunk.clusters(clustered.anchor))?;
    buffers.upload(gpu, "triangle_groups", &chunk.triangle_groups(clustered.anchor))
}

/// Bytes of a ray in each of its two tables.
const RAY_BYTES: u64 = 24;

/// A band's tables. With `keeps_lens` those of its lens are there already.
pub(super) fn upload_band(gpu: &Gpu, band: &Band, keeps_lens: bool, buffers: &mut Buffers) -> Result<()> {
    if !band.moments.is_empty() {
        buffers.upload(gpu, "moments", &band.moments)?;
    }
    if let Some(turned) = &band.turned {
        buffers.upload_uniform(gpu, "viewer", &turned.pose())?;
    }
    // cells and pieces hold rays of this pose; those of a field hold none
    let keeps_cells = keeps_lens && band.turned.as_ref().is_some_and(|own| Arc::ptr_eq(&own.lens.tiles, &band.tiles));
    if !keeps_cells {
        buffers.upload(gpu, "cells", &band.tiles.cells)?;
        buffers.upload_texels(gpu, "pieces", &band.tiles.pieces)?;
    }
    if keeps_lens {
        return Ok(());
    }
    let nodes = &band.nodes.nodes;
    if let Some(turned) = &band.turned {
        buffers.upload(gpu, "lens_nodes", nodes)?;
        buffers.create(gpu, "nodes", size_of_val(&nodes[..]) as u64, BufferUsages::empty())?;
        if turned.ray_count() > 0 {
            buffers.upload(gpu, "lens_hi", &turned.lens.table.hi)?;
            buffers.upload(gpu, "lens_lo", &turned.lens.table.lo)?;
            let bytes = RAY_BYTES * u64::from(turned.ray_count());
            buffers.create(gpu, "rays_hi", bytes, BufferUsages::empty())?;
            buffers.create(gpu, "rays_lo", bytes, BufferUsages::empty())?;
        }
    } else {
        buffers.upload(gpu, "nodes", nodes)?;
    }
    buffers.upload(gpu, "tile_start", &band.tiles.start)?;
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

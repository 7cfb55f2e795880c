//! What lies on the device for rays that a mirror or a lens bounces: the surface, and for every bounce the rays behind it.

use super::bounces::Bounce;
use super::surface::OpticsSurface;
use super::tables;
use crate::camera::optics::{Optics, Surface};
use crate::camera::{Camera, TILE};
use crate::engine::plan::nodes::above_cells;
use crate::engine::plan::{Band, Plan};
use crate::gpu::Gpu;
use crate::gpu::buffers::Buffers;
use crate::gpu::layout::{self, NONE};
use crate::input::Result;
use crate::scene::Scene;
use glam::DVec3;
use std::sync::Arc;
use wgpu::BufferUsages;

/// The optics' buffers. If rays are split, the rays after k bounces are in table k - 1. Otherwise two tables alternate: the first holds
/// the rays after an odd number of bounces, the second those after an even number.
pub struct BounceTables {
    /// Of each bounce the uniform `optic`.
    bounces: Vec<Buffers>,
    /// Of rays before any bounce: `paths`, with nothing behind them, 32 bytes a pixel of the largest band, written by the host; and `live`,
    /// the list of tiles that may meet the optics, written by reach.
    untouched: Buffers,
    /// `rays_hi` and `rays_lo`, 24 bytes each a pixel of the largest band with a column and a row more, and `paths`; written
    /// by bounce, read by all others; and `live`, the list of tiles with a ray, 8 bytes a tile. Where rays are split, also `visibility`, 8 bytes a pixel, for the other branches.
    tables: Vec<Buffers>,
    /// The same under the names by which bounce writes them.
    targets: Vec<Buffers>,
    /// Of each band: `nodes` and `cells`, one a tile, written by fit; `tile_start`, written by the host.
    bands: Vec<Buffers>,
    /// As [`OpticsSurface::upload`] says; written by the host.
    surface: Buffers,
    /// The optics whose surface is uploaded, and the anchor that the surface is relative to.
    surface_of: (Arc<Optics>, DVec3),
}

impl BounceTables {
    pub fn new(
        gpu: &Gpu,
        scene: &Scene,
        camera: &Camera,
        optics: &Arc<Optics>,
        plan: &Plan,
        bounces: &[Bounce],
    ) -> Result<BounceTables> {
        let depth = bounces.iter().map(|b| b.count).max().unwrap_or(0);
        // unless rays are split, there is one entry for each number of bounces
        let is_split = bounces.len() > depth as usize + 1;
        let rows = plan.bands.iter().map(|b| b.rows).max().unwrap_or(0) as usize;
        let pixels = rows * camera.width as usize;
        let tiles = rows.div_ceil(TILE as usize) * (camera.width as usize).div_ceil(TILE as usize);
        let mut surface = Buffers::default();
        OpticsSurface::new(&optics.surface, plan.anchor).upload(gpu, &mut surface)?;
        let mut untouched = Buffers::default();
        let nothing = layout::PathState { light: [1.0; 3], length: 0.0, first: NONE, last: NONE, piece: 0, pad0: 0 };
        untouched.upload(gpu, "paths", &vec![nothing; pixels])?;
        untouched.upload(gpu, "live", &vec![0u32; 1 + 2 * tiles])?;
        if is_split {
            untouched.create(gpu, "visibility", 8 * pixels as u64, BufferUsages::empty())?;
        }
        let table = |_| {
            let bytes = 24 * (camera.width as u64 + 1) * (rows as u64 + 1);
            let mut table = Buffers::default();
            table.create(gpu, "rays_hi", bytes, BufferUsages::empty())?;
            table.create(gpu, "rays_lo", bytes, BufferUsages::empty())?;
            // no ray: bounce leaves the pixels of many tiles as they are
            table.upload(
                gpu,
                "paths",
                &vec![layout::PathState { last: NONE, ..bytemuck::Zeroable::zeroed() }; pixels],
            )?;
            table.upload(gpu, "live", &vec![0u32; 1 + 2 * tiles])?;
            if is_split {
                table.create(gpu, "visibility", 8 * pixels as u64, BufferUsages::empty())?;
            }
            Ok(table)
        };
        let count = if is_split { depth } else { depth.min(2) };
        let tables: Vec<Buffers> = (0..count).map(table).collect::<Result<_>>()?;
        let target = |table: &Buffers| {
            let mut target = Buffers::default();
            target.share("bounced_hi", table, "rays_hi");
            target.share("bounced_lo", table, "rays_lo");
            target.share("bounced_paths", table, "paths");
            target.share("bounced_live", table, "live");
            target
        };
        let mut own: Vec<Buffers> = bounces.iter().map(|_| Buffers::default()).collect();
        upload_bounces(gpu, &mut own, (scene, camera, optics, plan), bounces)?;
        Ok(BounceTables {
            bounces: own,
            untouched,
            targets: tables.iter().map(target).collect(),
            tables,
            bands: plan.bands.iter().map(|b| band_buffers(gpu, b)).collect::<Result<_>>()?,
            surface,
            surface_of: (optics.clone(), plan.anchor),
        })
    }

    /// Uploads the optics of another camera with the same bounces, for a plan whose bands have the same sizes.
    pub fn aim(
        &mut self,
        gpu: &Gpu,
        scene: &Scene,
        camera: &Camera,
        optics: &Arc<Optics>,
        plan: &Plan,
        bounces: &[Bounce],
    ) -> Result<()> {
        let (uploaded, anchor) = &self.surface_of;
        if !is_same_surface(&uploaded.surface, &optics.surface) || *anchor != plan.anchor {
            OpticsSurface::new(&optics.surface, plan.anchor).upload(gpu, &mut self.surface)?;
        }
        self.surface_of = (optics.clone(), plan.anchor);
        upload_bounces(gpu, &mut self.bounces, (scene, camera, optics, plan), bounces)
    }

    /// Where kernels find what a band has of its own for rays after so many bounces.
    pub fn scopes(&self, bounces: u32, band: usize) -> Vec<&Buffers> {
        match bounces {
            0 => vec![&self.surface, &self.untouched],
            n => vec![&self.surface, &self.tables[self.table(n)], &self.bands[band]],
        }
    }

    /// The uniform of a bounce, by its number.
    pub fn uniforms(&self, bounce: usize) -> &Buffers {
        &self.bounces[bounce]
    }

    /// Where bounce writes the rays after so many bounces.
    pub fn target(&self, bounces: u32) -> &Buffers {
        &self.targets[self.table(bounces)]
    }

    fn table(&self, bounces: u32) -> usize {
        (bounces as usize - 1) % self.tables.len()
    }

    pub fn bytes(&self) -> u64 {
        let own = [&self.untouched, &self.surface];
        self.bounces.iter().chain(&self.tables).chain(&self.bands).chain(own).map(Buffers::bytes).sum()
    }
}

/// Whether two surfaces have the same tables. The law by which facets bounce rays is no part of them.
fn is_same_surface(a: &Surface, b: &Surface) -> bool {
    match (a, b) {
        (Surface::Facets { facets: a, .. }, Surface::Facets { facets: b, .. }) => a == b,
        _ => a == b,
    }
}

/// Uploads the uniform of each bounce.
fn upload_bounces(
    gpu: &Gpu,
    uniforms: &mut [Buffers],
    (scene, camera, optics, plan): (&Scene, &Camera, &Optics, &Plan),
    bounces: &[Bounce],
) -> Result<()> {
    uniforms.iter_mut().zip(bounces).try_for_each(|(own, bounce)| {
        own.upload_uniform(gpu, "optic", &tables::optic(scene, camera, optics, plan, bounce))
    })
}

/// One cell a tile, whose pixels fit names, and space for the nodes.
fn band_buffers(gpu: &Gpu, band: &Band) -> Result<Buffers> {
    let tiles = band.tiles.tiles_x * band.tiles.tiles_y;
    let cell = |tile: u32| layout::Cell { tile, node: tile, ..bytemuck::Zeroable::zeroed() };
    let nodes = above_cells(band.tiles.tiles_x, band.tiles.tiles_y) as u64;
    let mut buffers = Buffers::default();
    buffers.create(gpu, "nodes", nodes * size_of::<layout::Node>() as u64, BufferUsages::empty())?;
    buffers.upload(gpu, "cells", &(0..tiles).map(cell).collect::<Vec<_>>())?;
    buffers.upload(gpu, "tile_start", &(0..=tiles).collect::<Vec<_>>())?;
    Ok(buffers)
}

//! Ray tracing in a compute kernel: what a user would pick instead. A ray a pixel, or the segments of a curved projector, through a
//! bounding volume hierarchy, or against every triangle.

use super::{kernels, with};
use anamorph::internals::camera::TILE;
use anamorph::internals::engine::plan::hierarchy::{Hierarchy, leaf_triangle};
use anamorph::internals::engine::rival::{Rival, Setup, Target};
use anamorph::internals::engine::stage::dispatch_items;
use anamorph::internals::gpu::Gpu;
use anamorph::internals::gpu::buffers::{Buffers, Pipeline};
use anamorph::internals::gpu::recorder::Recorder;
use anamorph::internals::input::{Error, Result};
use anamorph::internals::scene::Scene;
use glam::DVec3;
use rayon::prelude::*;

/// What follows triangles that move.
#[derive(Clone, Copy, PartialEq)]
enum Search {
    Rebuilt,
    Refitted,
    Brute,
}

struct Trace {
    pipeline: Pipeline,
    search: Search,
    anchor: DVec3,
    hierarchy: Option<Hierarchy>,
    /// `bvh`, 32 bytes a node, and `leaves`, 48 bytes a triangle; written by the host.
    own: Buffers,
    tiles_x: u32,
}

pub fn rebuilt(gpu: &Gpu, setup: &Setup) -> Result<Box<dyn Rival>> {
    straight(gpu, setup, Search::Rebuilt)
}

pub fn refitted(gpu: &Gpu, setup: &Setup) -> Result<Box<dyn Rival>> {
    straight(gpu, setup, Search::Refitted)
}

pub fn brute(gpu: &Gpu, setup: &Setup) -> Result<Box<dyn Rival>> {
    straight(gpu, setup, Search::Brute)
}

pub fn segments(gpu: &Gpu, setup: &Setup) -> Result<Box<dyn Rival>> {
    if !setup.camera.is_curved() {
        return Err(Error::input("the rays of this camera are straight; use raytrace"));
    }
    trace(gpu, setup, Search::Rebuilt, setup.parameter)
}

fn straight(gpu: &Gpu, setup: &Setup, search: Search) -> Result<Box<dyn Rival>> {
    if setup.camera.is_curved() {
        return Err(Error::input("the rays of this camera are curved; use raymarch-segments"));
    }
    trace(gpu, setup, search, 1)
}

fn trace(gpu: &Gpu, setup: &Setup, search: Search, segments: u32) -> Result<Box<dyn Rival>> {
    let layers = setup.camera.layers.len() as u32;
    let kernel = kernels::trace(setup.variant, layers, segments, search == Search::Brute);
    Ok(Box::new(Trace {
        pipeline: Pipeline::new(gpu, kernel)?,
        search,
        anchor: setup.anchor,
        hierarchy: None,
        own: Buffers::default(),
        tiles_x: setup.camera.width.div_ceil(TILE),
    }))
}

impl Rival for Trace {
    fn upload(&mut self, gpu: &Gpu, scene: &Scene) -> Result<()> {
        if self.search == Search::Brute {
            let count = scene.mesh.triangles.len() as u32;
            let leaves: Vec<_> = (0..count).into_par_iter().map(|id| leaf_triangle(scene, self.anchor, id)).collect();
            return self.own.upload(gpu, "leaves", &leaves);
        }
        match &mut self.hierarchy {
            Some(tree) if self.search == Search::Refitted => tree.refit(scene),
            tree => *tree = Some(Hierarchy::build(scene, self.anchor, scene.mesh.triangles.len())?),
        }
        let Some(tree) = &self.hierarchy else { return Ok(()) };
        let (nodes, leaves) = tree.nodes_and_leaves(scene);
        self.own.upload(gpu, "bvh", &nodes)?;
        self.own.upload(gpu, "leaves", &leaves)
    }

    /// Rays are on the device anyway.
    fn aim(&mut self, _gpu: &Gpu, _setup: &Setup) -> Result<()> {
        Ok(())
    }

    fn passes(&self, _band: &Target) -> u32 {
        1
    }

    fn encode(&self, gpu: &Gpu, recorder: &mut Recorder, band: &Target) -> Result<()> {
        // its own leaves hold the triangles of all chunks
        let Some(chunk) = band.chunks.first() else { return Ok(()) };
        let group = self.pipeline.bind(gpu, &with(&chunk.scopes, &[&self.own]))?;
        let mut pass = recorder.compute("raytrace");
        pass.set_pipeline(self.pipeline.raw());
        pass.set_bind_group(0, &group, &[]);
        dispatch_items(gpu, &mut pass, self.tiles_x * band.rows.div_ceil(TILE) * TILE * TILE);
        Ok(())
    }

    fn bytes(&self) -> u64 {
        self.own.bytes()
    }
}

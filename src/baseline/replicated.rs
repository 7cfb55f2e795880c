//! `raster-pieces`: perspective pieces by their own matrices, each triangle drawn in those that may see it (Lorenz and Doellner
//! 2009, section 2), clipped at their edges. Where they replicate by geometry shaders, a compute kernel lists the replicas and one
//! indirect draw takes them. The cameras of a graph camera (Popescu et al., section 2) are such pieces.

use super::draw::{Draw, Easel};
use super::outline;
use super::{Rival, Setup, Target, kernels, with};
use crate::camera::bundle::Bundle;
use crate::error::{Error, Result};
use crate::gpu::Gpu;
use crate::gpu::buffers::{Buffers, Pipeline, read_words, readback};
use crate::gpu::recorder::Recorder;
use crate::scene::Scene;
use crate::stage::dispatch_items;
use wgpu::BufferUsages;

struct Replicated {
    replicate: Pipeline,
    draw: Draw,
    easel: Easel,
    pieces: u64,
    /// The pieces' rows; `replicas`, 8 bytes a triangle and piece that may see it, and `draw_args`, 16 bytes, both written by replicate
    /// and read by the draw; `no_draw`, the arguments before.
    own: Buffers,
}

/// Bytes of a replica.
const REPLICA_BYTES: u64 = 8;

pub fn replicated(gpu: &Gpu, setup: &Setup) -> Result<Box<dyn Rival>> {
    check_central(setup)?;
    let mut own = Buffers::default();
    let pieces = u64::from(outline::upload(gpu, setup, &mut own)?);
    own.create(gpu, "draw_args", 16, BufferUsages::INDIRECT)?;
    own.upload(gpu, "no_draw", &[0u32, 1, 0, 0])?;
    Ok(Box::new(Replicated {
        replicate: Pipeline::new(&gpu.device, kernels::replicate(setup.variant.culling)),
        draw: Draw::clipped(gpu, kernels::perspective(setup.layers(), setup.variant.culling))?,
        easel: Easel::new(gpu, setup),
        pieces,
        own,
    }))
}

fn check_central(setup: &Setup) -> Result<()> {
    if outline::pieces(setup)?.iter().all(|(_, p, k)| is_central(&p.pieces[*k as usize].bundle)) {
        return Ok(());
    }
    let kind = setup.camera.kind;
    Err(Error::input(format!("the pieces of {kind} are not all perspective; use raster-bound or raytrace")))
}

/// All rays start in one point, up to rounding.
fn is_central(b: &Bundle) -> bool {
    let eye = b.p[0] / b.h[0];
    let near = CENTRE_ROUNDING * (1.0 + eye.abs().max_element());
    (1..3).all(|k| (b.p[k] - b.h[k] * eye).abs().max_element() <= near)
}

/// How far origins may be apart a pixel that are one point, against its size: sixteen roundings.
const CENTRE_ROUNDING: f64 = 16.0 * f64::EPSILON;

impl Rival for Replicated {
    fn upload(&mut self, gpu: &Gpu, scene: &Scene) -> Result<()> {
        if self.own.get("replicas").is_some() {
            return Ok(());
        }
        let all = self.pieces * scene.mesh.triangles.len() as u64 * REPLICA_BYTES;
        self.own.create(gpu, "replicas", all.min(gpu.binding_limit()), BufferUsages::empty())
    }

    /// As many pieces as there is room for in the list of replicas.
    fn aim(&mut self, gpu: &Gpu, setup: &Setup) -> Result<()> {
        check_central(setup)?;
        self.pieces = u64::from(outline::upload(gpu, setup, &mut self.own)?);
        Ok(())
    }

    fn passes(&self, band: &Target) -> u32 {
        1 + 2 * band.chunks.len() as u32
    }

    fn encode(&self, gpu: &Gpu, recorder: &mut Recorder, band: &Target) -> Result<()> {
        let (Some(none), Some(args)) = (self.own.get("no_draw"), self.own.get("draw_args")) else { return Ok(()) };
        for (k, chunk) in band.chunks.iter().enumerate() {
            let scopes = with(&chunk.scopes, &[&self.own]);
            recorder.encoder.copy_buffer_to_buffer(none, 0, args, 0, 16);
            let group = self.replicate.bind(gpu, &scopes)?;
            let mut pass = recorder.compute("replicate");
            pass.set_pipeline(&self.replicate.pipeline);
            pass.set_bind_group(0, &group, &[]);
            dispatch_items(gpu, &mut pass, chunk.slots);
            drop(pass);
            let group = self.draw.bind(gpu, &scopes)?;
            let mut pass = self.easel.canvas.pass(recorder, "draw", k == 0);
            pass.set_pipeline(&self.draw.pipeline);
            pass.set_bind_group(0, &group, &[]);
            pass.draw_indirect(args, 0);
        }
        self.easel.take(gpu, recorder, band)
    }

    /// Replicas that did not fit are missing in the picture.
    fn check(&self, gpu: &Gpu) -> Result<()> {
        let (Some(args), Some(list)) = (self.own.get("draw_args"), self.own.get("replicas")) else { return Ok(()) };
        let copy = readback(gpu, 16);
        let mut recorder = Recorder::new(gpu, 0);
        recorder.encoder.copy_buffer_to_buffer(args, 0, &copy, 0, 16);
        recorder.submit(gpu)?;
        let (need, have) = (u64::from(read_words(gpu, &copy)?[0] / 3), list.size() / REPLICA_BYTES);
        if need <= have {
            return Ok(());
        }
        Err(Error::work(format!("{need} replicas needed, {have} fit a binding; use fewer pieces or triangles")))
    }

    fn bytes(&self) -> u64 {
        self.easel.canvas.bytes() + self.own.bytes()
    }
}

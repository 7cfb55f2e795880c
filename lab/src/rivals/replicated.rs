//! `raster-pieces`: perspective pieces by their own matrices, each triangle drawn in those that may see it (Lorenz and Doellner
//! 2009, section 2), clipped at their edges. Where they replicate by geometry shaders, a compute kernel lists the replicas and one
//! indirect draw takes them. Where they look up the cells of a camera texture that a triangle's bounds meet, it skips the pieces of a
//! cone that the triangle is not in. The cameras of a graph camera (Popescu et al., section 2) are such pieces. Four samples a pixel are the
//! rasterizer's own: a fragment leaves its triangle, and its t at the pixel's centre, at all samples that it covers.

use super::draw::{BandRaster, Draw};
use super::layout::Cone;
use super::outline;
use super::{kernels, with};
use anamorph::internals::camera::bundle::Bundle;
use anamorph::internals::camera::pieces::{Piece, Pieces};
use anamorph::internals::camera::project::tree::place_key;
use anamorph::internals::engine::rival::{Rival, Setup, Target};
use anamorph::internals::engine::stage::dispatch_items;
use anamorph::internals::gpu::Gpu;
use anamorph::internals::gpu::buffers::{Buffers, Pipeline};
use anamorph::internals::gpu::readback::{read_words, readback};
use anamorph::internals::gpu::recorder::Recorder;
use anamorph::internals::input::{Error, Result};
use anamorph::internals::scene::Scene;
use glam::{DVec2, DVec3};
use wgpu::BufferUsages;

struct Replicated {
    replicate: Pipeline,
    draw: Draw,
    band_raster: BandRaster,
    pieces: u64,
    /// The pieces, by where they lie in the image, and the cones of each [`TOGETHER`]; `replicas`, 8 bytes a triangle
    /// and piece that may see it, and `draw_args`, 16 bytes, both written by replicate and read by the draw; `no_draw`, the arguments
    /// before.
    own: Buffers,
}

/// Bytes of a replica.
const REPLICA_BYTES: u64 = 8;

pub fn replicated(gpu: &Gpu, setup: &Setup) -> Result<Box<dyn Rival>> {
    let samples = setup.variant.samples();
    let mut own = Buffers::default();
    let pieces = upload_pieces(gpu, setup, &mut own)?;
    own.create(gpu, "draw_args", 16, BufferUsages::INDIRECT)?;
    own.upload(gpu, "no_draw", &[0u32, 1, 0, 0])?;
    Ok(Box::new(Replicated {
        replicate: Pipeline::new(gpu, kernels::replicate(setup.variant.extras.culling))?,
        draw: Draw::clipped(gpu, kernels::perspective(setup.layers(), setup.variant.extras.culling, samples), samples)?,
        band_raster: BandRaster::new(gpu, setup)?,
        pieces,
        own,
    }))
}

/// Returns how many.
fn upload_pieces(gpu: &Gpu, setup: &Setup, own: &mut Buffers) -> Result<u64> {
    let all = outline::pieces(setup)?;
    if !all.iter().all(|(_, p, k)| is_central(&p.pieces[*k as usize].bundle)) {
        let kind = setup.camera.kind;
        return Err(Error::input(format!(
            "the pieces of {kind} are not all perspective; use raster-bound or raytrace"
        )));
    }
    let size = DVec2::new(setup.camera.width.into(), setup.camera.height.into());
    let mut order: Vec<u32> = (0..all.len() as u32).collect();
    order.sort_by_cached_key(|&number| {
        let (layer, pieces, k) = all[number as usize];
        let corners = pieces.pieces[k as usize].corners_px;
        (layer, corners.map(|c| place_key((c[0] + c[1] + c[2]) / 3.0, size)))
    });
    let cone = |(part, numbers): (usize, &[u32])| {
        let pieces: Vec<(&Piece, [DVec3; 3])> = numbers.iter().map(|&number| seen_by(all[number as usize])).collect();
        cone(&pieces, setup.anchor, (part * TOGETHER) as u32)
    };
    own.upload(gpu, "cones", &order.chunks(TOGETHER).enumerate().map(cone).collect::<Vec<_>>())?;
    outline::upload_in_order(gpu, setup, (&all, &order), own)?;
    Ok(all.len() as u64)
}

/// Pieces of a cone: of 32,000 pieces a triangle is tested against 500 cones and the pieces of some.
const TOGETHER: usize = 64;

/// A piece and the directions of its corners' rays; of a piece of the whole image they are 0.
fn seen_by((_, pieces, k): (u32, &Pieces, u32)) -> (&Piece, [DVec3; 3]) {
    let piece = &pieces.pieces[k as usize];
    let direction = |place_px| pieces.bundle_at_place(k, place_px).d[0].normalize_or_zero();
    (piece, piece.corners_px.map_or([DVec3::ZERO; 3], |corners| corners.map(direction)))
}

/// The cone of pieces with one eye; of others it holds everything. A cap of the sphere under a half of it that holds three corners holds
/// the triangle between them.
fn cone(pieces: &[(&Piece, [DVec3; 3])], anchor: DVec3, first: u32) -> Cone {
    let eye_of = |(piece, _): &(&Piece, [DVec3; 3])| piece.bundle.p[0] / piece.bundle.h[0];
    let eye = eye_of(&pieces[0]);
    let corners = || pieces.iter().flat_map(|(_, corners)| corners.iter());
    let axis = corners().sum::<DVec3>().normalize_or_zero();
    let angle = corners().map(|c| axis.dot(*c).clamp(-1.0, 1.0).acos()).fold(0.0, f64::max);
    let near = CENTRE_ROUNDING * (1.0 + eye.abs().max_element());
    let is_one = pieces.iter().all(|piece| (eye_of(piece) - eye).abs().max_element() <= near);
    Cone {
        eye: (eye - anchor).as_vec3().to_array(),
        first,
        axis: axis.as_vec3().to_array(),
        count: pieces.len() as u32,
        angle: if is_one && angle < WIDEST { angle as f32 } else { EVERYTHING },
        pad0: 0,
        pad1: 0,
        pad2: 0,
    }
}

/// A wider cone is taken to hold everything; radians, under a right angle, as 0 has with any.
const WIDEST: f64 = 1.5;

const EVERYTHING: f32 = 4.0;

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

    /// As many pieces as the list of replicas has space for.
    fn aim(&mut self, gpu: &Gpu, setup: &Setup) -> Result<()> {
        self.pieces = upload_pieces(gpu, setup, &mut self.own)?;
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
            pass.set_pipeline(self.replicate.raw());
            pass.set_bind_group(0, &group, &[]);
            dispatch_items(gpu, &mut pass, chunk.slots);
            drop(pass);
            let group = self.draw.bind(gpu, &scopes)?;
            let mut pass = self.band_raster.raster_target.pass(recorder, "draw", k == 0);
            pass.set_pipeline(&self.draw.pipeline);
            pass.set_bind_group(0, &group, &[]);
            pass.draw_indirect(args, 0);
        }
        self.band_raster.take(gpu, recorder, band)
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
        self.band_raster.raster_target.bytes() + self.own.bytes()
    }
}

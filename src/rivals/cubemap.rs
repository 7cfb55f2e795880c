//! `raster-cubemap`: what is usual instead of a camera that bends: an ordinary picture of all six sides, and every pixel looks up
//! the nearest texel there (Lorenz and Doellner 2009, section 1.1: image-based). For cameras whose rays start in one point.

use super::draw::{Draw, RasterTarget, run};
use super::layout::Cube;
use super::{kernels, with};
use crate::engine::rival::{Rival, Setup, Target};
use crate::gpu::Gpu;
use crate::gpu::buffers::{Buffers, Pipeline};
use crate::gpu::recorder::Recorder;
use crate::input::{Error, Result};

struct CubeMap {
    draw: Draw,
    raster_target: RasterTarget,
    unfold: Pipeline,
    own: Buffers,
    side: u32,
    width: u32,
}

/// Faces beside each other.
const COLUMNS: u32 = 3;
const FACES: u32 = 6;

/// The parameter: texels a side of a face.
pub fn cubemap(gpu: &Gpu, setup: &Setup) -> Result<Box<dyn Rival>> {
    let side = setup.parameter;
    let most = gpu.limits.max_texture_dimension_2d / COLUMNS;
    if side > most {
        return Err(Error::input(format!("a side of {side} texels is too large for this adapter; use {most} at most")));
    }
    let mut own = Buffers::default();
    own.upload_uniform(gpu, "cube", &cube(setup, side)?)?;
    Ok(Box::new(CubeMap {
        draw: Draw::new(gpu, kernels::cube()),
        raster_target: RasterTarget::new(gpu, (COLUMNS * side, FACES / COLUMNS * side)),
        unfold: Pipeline::new(gpu, kernels::unfold(setup.variant))?,
        own,
        side,
        width: setup.camera.width,
    }))
}

fn cube(setup: &Setup, side: u32) -> Result<Cube> {
    let kind = setup.camera.kind;
    let eye = setup
        .camera
        .centre()
        .ok_or_else(|| Error::input(format!("the rays of {kind} do not start in one point; use raytrace")))?;
    if setup.layers() > 1 || setup.camera.is_curved() {
        return Err(Error::input(format!("the rays of {kind} are not straight; use raytrace")));
    }
    Ok(Cube { eye: (eye - setup.anchor).as_vec3().to_array(), side })
}

impl Rival for CubeMap {
    fn aim(&mut self, gpu: &Gpu, setup: &Setup) -> Result<()> {
        self.own.upload_uniform(gpu, "cube", &cube(setup, self.side)?)
    }

    fn passes(&self, _band: &Target) -> u32 {
        2
    }

    fn encode(&self, gpu: &Gpu, recorder: &mut Recorder, band: &Target) -> Result<()> {
        let Some(first) = band.chunks.first() else { return Ok(()) };
        let groups = band.chunks.iter().map(|c| self.draw.bind(gpu, &with(&c.scopes, &[&self.own])));
        let groups = groups.collect::<Result<Vec<_>>>()?;
        let mut pass = self.raster_target.pass(recorder, "draw", true);
        pass.set_pipeline(&self.draw.pipeline);
        let side = self.side as f32;
        for (group, chunk) in groups.iter().zip(&band.chunks) {
            pass.set_bind_group(0, group, &[]);
            for face in 0..FACES {
                let (column, row) = ((face % COLUMNS) as f32, (face / COLUMNS) as f32);
                pass.set_viewport(column * side, row * side, side, side, 0.0, 1.0);
                pass.set_scissor_rect(face % COLUMNS * self.side, face / COLUMNS * self.side, self.side, self.side);
                pass.draw(0..3 * chunk.slots, face..face + 1);
            }
        }
        drop(pass);
        let scopes = with(&first.scopes, &[&self.own]);
        run(gpu, recorder, "unfold", (&self.unfold, &scopes, self.raster_target.seen()), self.width * band.rows)
    }

    fn bytes(&self) -> u64 {
        self.raster_target.bytes() + self.own.bytes()
    }
}

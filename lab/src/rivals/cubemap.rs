//! What is usual instead of a camera that bends, for cameras whose rays start in one point: an ordinary picture from there, and every
//! pixel looks up the nearest texel (Lorenz and Doellner 2009, section 1.1: image-based).
//!
//! * `raster-cubemap`: of all six sides.
//! * `raster-image`: one, of what the camera's rays hold (their section 4: for camera textures).

use super::draw::{Draw, RasterTarget, run};
use super::layout::Cube;
use super::{kernels, with};
use anamorph::internals::engine::rival::{Rival, Setup, Target};
use anamorph::internals::gpu::Gpu;
use anamorph::internals::gpu::buffers::{Buffers, Pipeline};
use anamorph::internals::gpu::recorder::Recorder;
use anamorph::internals::input::{Error, Result};
use glam::DVec3;

struct CubeMap {
    draw: Draw,
    raster_target: RasterTarget,
    unfold: Pipeline,
    own: Buffers,
    faces: Faces,
    side: u32,
    width: u32,
}

/// How many, and how many lie beside each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Faces {
    count: u32,
    columns: u32,
}

const CUBE: Faces = Faces { count: 6, columns: 3 };
const ONE: Faces = Faces { count: 1, columns: 1 };

/// The parameter: texels a side of a face.
pub fn cubemap(gpu: &Gpu, setup: &Setup) -> Result<Box<dyn Rival>> {
    looked_up(gpu, setup, CUBE)
}

/// The parameter: texels a side of the picture.
pub fn image(gpu: &Gpu, setup: &Setup) -> Result<Box<dyn Rival>> {
    looked_up(gpu, setup, ONE)
}

fn looked_up(gpu: &Gpu, setup: &Setup, faces: Faces) -> Result<Box<dyn Rival>> {
    let side = setup.parameter;
    let most = gpu.limits.max_texture_dimension_2d / faces.columns;
    if side > most {
        return Err(Error::input(format!("a side of {side} texels is too large for this adapter; use {most} at most")));
    }
    let is_cube = faces == CUBE;
    let mut own = Buffers::default();
    own.upload_uniform(gpu, "cube", &cube(setup, side, faces)?)?;
    Ok(Box::new(CubeMap {
        draw: Draw::new(gpu, kernels::cube(is_cube), 1),
        raster_target: RasterTarget::new(gpu, (faces.columns * side, faces.count / faces.columns * side), 1),
        unfold: Pipeline::new(gpu, kernels::unfold(setup.variant, is_cube))?,
        own,
        faces,
        side,
        width: setup.camera.width,
    }))
}

fn cube(setup: &Setup, side: u32, faces: Faces) -> Result<Cube> {
    let kind = setup.camera.kind;
    let eye = setup
        .camera
        .centre()
        .ok_or_else(|| Error::input(format!("the rays of {kind} do not start in one point; use raytrace")))?;
    if setup.layers() > 1 || setup.camera.is_curved() {
        return Err(Error::input(format!("the rays of {kind} are not straight; use raytrace")));
    }
    let axes = if faces == CUBE { [DVec3::ZERO; 3] } else { picture(setup)? };
    let [right, up, forward] = axes.map(|v| v.as_vec3().to_array());
    let eye = (eye - setup.anchor).as_vec3().to_array();
    Ok(Cube { eye, side, right, pad0: 0, up, pad1: 0, forward, pad2: 0 })
}

/// Right, up and forward of the picture that just holds the directions of all rays: [`Cube`].
fn picture(setup: &Setup) -> Result<[DVec3; 3]> {
    let camera = setup.camera;
    let pixels = (0..camera.height).flat_map(|j| (0..camera.width).map(move |i| (i, j)));
    let directions: Vec<DVec3> =
        pixels.filter_map(|(i, j)| camera.ray(i, j)).map(|ray| ray.direction.normalize_or_zero()).collect();
    let forward = directions.iter().sum::<DVec3>().normalize_or_zero();
    let (right, up) = forward.any_orthonormal_pair();
    let slope = |d: &DVec3, axis: DVec3| d.dot(axis).abs() / d.dot(forward);
    let is_before = |d: &DVec3| d.dot(forward) > LEAST_COSINE;
    if !directions.iter().all(is_before) {
        let kind = camera.kind;
        return Err(Error::input(format!("the rays of {kind} spread too far for one picture; use raster-cubemap")));
    }
    let widest = |axis: DVec3| directions.iter().map(|d| slope(d, axis)).fold(f64::MIN_POSITIVE, f64::max);
    Ok([right / widest(right), up / widest(up), forward])
}

/// Of the angle between a ray and the middle of the picture that may show it.
const LEAST_COSINE: f64 = 0.1;

impl Rival for CubeMap {
    fn aim(&mut self, gpu: &Gpu, setup: &Setup) -> Result<()> {
        self.own.upload_uniform(gpu, "cube", &cube(setup, self.side, self.faces)?)
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
            for face in 0..self.faces.count {
                let (column, row) = (face % self.faces.columns, face / self.faces.columns);
                pass.set_viewport(column as f32 * side, row as f32 * side, side, side, 0.0, 1.0);
                pass.set_scissor_rect(column * self.side, row * self.side, self.side, self.side);
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

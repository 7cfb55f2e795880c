//! Frames of different scenes, one after another on one engine: what the device already holds is not sent again, and the next frame
//! may be started before the last one is done.

use super::call_ms::ms_since;
use super::combinations::{Asked, Feature};
use super::planned::Planned;
use super::readback::{InFlight, Readback};
use super::{Engine, Frames, RunOptions};
use crate::camera::Camera;
use crate::engine::plan::Wanted;
use crate::gpu::kernels::Method;
use crate::input::{Error, Result};
use crate::scene::Scene;
use std::time::Instant;

/// What the device holds of the last frame of a sequence.
#[derive(Default)]
pub struct Sequence {
    frames: Option<Frames>,
    /// The options that they were uploaded with.
    run: RunOptions,
    /// Time of the uploads since the last frame, ms.
    upload_ms: f64,
}

impl Sequence {
    /// Whether one frame renders the image, and a sequence can hold that frame. Otherwise use [`Engine::render`].
    pub fn takes(scene: &Scene, camera: &Camera, wanted: &Wanted) -> bool {
        let asked = Asked::new(scene, camera, wanted);
        let alone = [Feature::Caustics, Feature::Atlas, Feature::Composed];
        !asked.is_separate() && asked.refusal().is_none() && !alone.into_iter().any(|feature| feature.is_in(&asked))
    }

    /// Sends what `planned` needs and the device does not hold yet. `false`: it needs other buffers; wait for the frames in flight, then
    /// [`Sequence::upload`] it.
    ///
    /// # Errors
    /// [`Error::Work`] if the device fails.
    pub fn show(&mut self, planned: &Planned) -> Result<bool> {
        let started = Instant::now();
        let shown = self.frames.as_mut().map_or(Ok(false), |frames| frames.show(planned));
        self.upload_ms += ms_since(started);
        shown
    }

    /// Uploads `planned` in place of what was uploaded before.
    ///
    /// # Errors
    /// Those of [`Engine::upload`].
    pub fn upload(&mut self, engine: &mut Engine, planned: &Planned, run: &RunOptions) -> Result<()> {
        let started = Instant::now();
        // its memory is free before more is taken
        self.clear();
        self.frames = Some(engine.upload(planned.clone(), run)?);
        self.upload_ms += ms_since(started);
        self.run = run.clone();
        Ok(())
    }

    /// Frees what the device holds.
    pub fn clear(&mut self) {
        self.frames = None;
    }

    /// Submits a frame of `planned`, which is shown or uploaded, and returns without waiting for it.
    ///
    /// # Errors
    /// [`Error::Work`] if the device fails.
    pub fn start(&mut self, engine: &mut Engine, mut planned: Planned) -> Result<InFlight> {
        planned.call.upload = std::mem::take(&mut self.upload_ms);
        let frames = self.frames.as_ref().ok_or_else(nothing)?;
        match frames.start(planned.clone()) {
            Err(error) if frames.is_lost() => self.start_by_raster(engine, &planned, error),
            started => started,
        }
    }

    /// Waits for a frame, even if a later one is shown by now. If the lists between the stages were too small, it runs again with larger
    /// ones; and by raster where it could not be traced.
    ///
    /// # Errors
    /// [`Error::Work`] if the device fails.
    pub fn wait_for(&mut self, engine: &mut Engine, in_flight: InFlight) -> Result<Readback> {
        let planned = in_flight.planned.clone();
        let frames = self.frames.as_mut().ok_or_else(nothing)?;
        match frames.wait_for(in_flight) {
            // another frame fell back to raster meanwhile, and the buffers of this one are gone
            Err(_) if frames.plan.variant != planned.plan.variant => {
                let run = self.run.clone();
                self.upload(engine, &planned, &run)?;
                let again = self.start(engine, planned)?;
                self.wait_for(engine, again)
            }
            Err(error) if frames.is_lost() => {
                let again = self.start_by_raster(engine, &planned, error)?;
                self.wait_for(engine, again)
            }
            done => done,
        }
    }

    /// Submits by raster what could not be traced; the error where that is not possible.
    fn start_by_raster(&mut self, engine: &mut Engine, planned: &Planned, error: Error) -> Result<InFlight> {
        let planned = engine.planner().rasterized(planned, &self.run).ok_or(error)?;
        self.clear();
        let run = RunOptions { method: Method::Raster, ..self.run.clone() };
        self.frames.insert(engine.upload(planned.clone(), &run)?).start(planned)
    }

    /// A frame from beginning to end, with no other in flight.
    ///
    /// # Errors
    /// Those of [`Engine::upload`].
    pub fn render(&mut self, engine: &mut Engine, planned: Planned, run: &RunOptions) -> Result<Readback> {
        // what fails in the middle is not there for the next frame
        let mut sequence = std::mem::take(self);
        if !sequence.show(&planned)? {
            sequence.upload(engine, &planned, run)?;
        }
        let in_flight = sequence.start(engine, planned)?;
        let readback = sequence.wait_for(engine, in_flight)?;
        *self = sequence;
        Ok(readback)
    }
}

fn nothing() -> Error {
    Error::work("no scene is on the device")
}

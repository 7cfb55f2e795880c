//! The renderers: the compute engine on an adapter, and the reference on the CPU.

use super::job::RenderJob;
use crate::camera::Camera;
use crate::engine::accumulation;
use crate::engine::call_ms::{CallMs, ms_since};
use crate::engine::combinations::Asked;
use crate::engine::left_out::LeftOut;
use crate::engine::plan::Wanted;
use crate::engine::planned::Planned;
use crate::engine::readback::{InFlight, Readback};
use crate::engine::report::Device;
use crate::engine::rival::{Choice, EngineName};
use crate::engine::sequence::Sequence;
use crate::engine::{Counts, Engine, MethodUsed, Rendered, RunOptions};
use crate::gpu::device::NO_ADAPTER;
use crate::image::frame::Channel;
use crate::image::opaque8;
use crate::input::{Error, Result};
use crate::reference;
use crate::scene::Scene;
use crate::scene::caustics::CausticsReport;
use crate::scene::style::Style;
use std::sync::Arc;
use std::time::Instant;

/// Why the reference refuses analytic coverage, and what to do instead.
pub const NO_AREAS: &str = "the reference counts samples, and measures no areas; leave out analytic coverage";

pub enum Backend<'e> {
    /// With a rival, if one is selected.
    Compute(&'e mut Engine, Option<Choice>),
    Reference,
}

impl<'e> Backend<'e> {
    /// The selected renderer on an existing engine; without an adapter, the reference.
    ///
    /// # Errors
    /// [`Error::Work`] if the render needs an adapter and there is none.
    pub fn of(engine: Option<&'e mut Engine>, job: &RenderJob) -> Result<Backend<'e>> {
        if matches!(job.engine, Some(EngineName::Reference)) {
            return Ok(Backend::Reference);
        }
        if let Some(engine) = engine {
            return Ok(Backend::Compute(engine, job.rival()));
        }
        let flag = match job.engine {
            Some(EngineName::Rival(choice)) => format!("--engine {}", choice.label()),
            _ if job.moving => "--moving".into(),
            _ if job.analytic => "--analytic".into(),
            _ => return Ok(Backend::Reference),
        };
        Err(Error::work(format!("{flag} needs an adapter: {NO_ADAPTER}")))
    }

    /// Refuses an image whose smallest band does not fit the adapter.
    pub fn check_size(&self, camera: &Camera, wanted: &Wanted) -> Result<()> {
        match self {
            Backend::Compute(engine, _) => engine.planner().check_size(camera, wanted),
            Backend::Reference => Ok(()),
        }
    }

    /// The renderer for these flags, on an existing engine.
    pub fn device_of(engine: Option<&Engine>, job: &RenderJob) -> Device {
        match engine.filter(|_| !matches!(job.engine, Some(EngineName::Reference))) {
            Some(engine) => {
                let info = &engine.gpu.info;
                let driver = format!("{} {}", info.driver, info.driver_info).trim().to_owned();
                let engine = job.rival().map_or(EngineName::Compute, EngineName::Rival);
                Device { adapter: info.name.clone(), driver, engine }
            }
            None => Device { adapter: "cpu".into(), driver: String::new(), engine: EngineName::Reference },
        }
    }

    /// Renders an image, and hands the triangle ids of each sample to `ids`, if these are wanted.
    pub fn render(
        &mut self,
        scene: &Scene,
        camera: &Arc<Camera>,
        wanted: &Wanted,
        run: &RunOptions,
        ids: &mut dyn FnMut(Vec<u32>),
    ) -> Result<Rendered> {
        match self {
            Backend::Compute(engine, rival) => {
                let run = &RunOptions { rival: *rival, ..run.clone() };
                engine.render_with_ids(scene, camera.clone(), wanted, run, ids)
            }
            Backend::Reference if wanted.channels.contains(&Channel::Certified) => {
                Err(Error::input("certified needs --engine compute; for the reference use --check or --pixel"))
            }
            Backend::Reference if wanted.analytic => Err(Error::input(NO_AREAS)),
            Backend::Reference => {
                scene.check_depth(&wanted.channels)?;
                scene.check_volume(camera)?;
                if camera.layered().is_some() {
                    Asked::new(scene, camera, wanted).check()?;
                }
                if let Some(composition) = &camera.composition {
                    composition.check(&scene.objects)?;
                }
                if wanted.samples > 1 {
                    let frame = |camera: &Arc<Camera>, wanted: &Wanted, run: &RunOptions| {
                        Ok(by_reference(scene, camera, wanted, run))
                    };
                    return accumulation::render((camera, wanted, scene.tone), run, frame, ids);
                }
                let mut rendered = by_reference(scene, camera, wanted, run);
                rendered.sample_ids.drain(..).for_each(ids);
                Ok(rendered)
            }
        }
    }
}

/// The contents of a device, and the plan of its last image: what the next image needs of it is not sent again.
#[derive(Default)]
pub struct Kept {
    pub sequence: Sequence,
    pub last: Option<Planned>,
}

impl Kept {
    /// Renders an image on an engine; without an adapter by the reference.
    pub fn render(
        &mut self,
        mut engine: Option<&mut Engine>,
        scene: &Scene,
        camera: &Arc<Camera>,
        wanted: &Wanted,
    ) -> Result<Rendered> {
        let run = RunOptions::default();
        if let Some(engine) = engine.as_mut().filter(|_| Sequence::takes(scene, camera, wanted)) {
            let planner = engine.planner();
            planner.check_size(camera, wanted)?;
            let planned = planner.plan(scene, camera.clone(), wanted, &run, self.last.as_ref())?;
            self.last = Some(planned.clone());
            return Ok(self.sequence.render(engine, planned, &run)?.rendered());
        }
        let mut backend = Backend::of(engine, &RenderJob::of(""))?;
        backend.render(scene, camera, wanted, &run, &mut |_| {})
    }
}

/// Renders frames one after another; each is planned while the device renders the one before. `take` receives each result, with the value
/// beside its plan, and says whether to go on.
pub fn render_each<T>(
    (engine, sequence): (&mut Engine, &mut Sequence),
    run: &RunOptions,
    frames: impl Iterator<Item = Result<(T, Planned)>>,
    mut take: impl FnMut(T, Readback) -> Result<bool>,
) -> Result<()> {
    let mut finish = |engine: &mut Engine, sequence: &mut Sequence, rendered: Option<(T, InFlight)>| match rendered {
        Some((of, in_flight)) => take(of, sequence.wait_for(engine, in_flight)?),
        None => Ok(true),
    };
    let mut before = None;
    for frame in frames {
        let (of, planned) = frame?;
        if !sequence.show(&planned)? {
            // the frame in flight uses the present contents
            if !finish(engine, sequence, before.take())? {
                return Ok(());
            }
            sequence.upload(engine, &planned, run)?;
        }
        let next = (of, sequence.start(engine, planned)?);
        if !finish(engine, sequence, before.replace(next))? {
            return Ok(());
        }
    }
    finish(engine, sequence, before).map(drop)
}

/// A frame by the reference, in the engine's form.
fn by_reference(scene: &Scene, camera: &Camera, wanted: &Wanted, run: &RunOptions) -> Rendered {
    let colours = [Channel::R, Channel::G, Channel::B].into_iter().filter(|_| wanted.srgb8);
    let ids = wanted.sample_ids.then_some(Channel::TriangleId);
    let channels = Channel::in_order(wanted.channels.iter().copied().chain(colours).chain(ids));
    let started = Instant::now();
    let maps = if wanted.has_colour() { reference::caustics::caustics(scene) } else { None };
    let ms = ms_since(started);
    let share = run.share.part_of(1 + run.repeat as usize);
    let timed = || {
        let started = Instant::now();
        let frame = reference::image::rows_with_caustics(scene, camera, &channels, maps.as_ref(), (1, &share));
        (frame, ms_since(started))
    };
    let (mut frame, first_ms) = timed();
    let frame_ms = match run.repeat {
        0 => vec![first_ms],
        n => (0..n).map(|_| timed().1).collect(),
    };
    let srgb8 = if wanted.srgb8 { opaque8(&frame, scene.tone) } else { None };
    let ids = frame.u32(Channel::TriangleId).filter(|_| wanted.sample_ids);
    let sample_ids = ids.map(<[u32]>::to_vec).into_iter().collect();
    frame.planes.retain(|(c, _)| wanted.channels.contains(c));
    Rendered {
        frame,
        sample_ids,
        srgb8,
        frame_ms,
        call: CallMs { wait: first_ms, ..CallMs::default() },
        stages: Vec::new(),
        counts: Counts::default(),
        draws: None,
        bytes: 0,
        method: MethodUsed::default(),
        // it does not draw a scene's style
        left_out: Vec::from_iter((scene.style != Style::default() && wanted.has_colour()).then_some(LeftOut::Style)),
        grown: 0,
        passes: Default::default(),
        caustics: maps.map(|maps| CausticsReport { budget: maps.budget, ms }),
    }
}

//! What renders: the compute engine on an adapter, or the reference on the CPU.

use crate::baseline::Choice;
use crate::camera::{Camera, Rays};
use crate::caustics::Account;
use crate::cli::args::{EngineName, RenderArgs};
use crate::engine::{Counts, Engine, Rendered, RunOptions};
use crate::error::{Error, Result};
use crate::frame::{Channel, Frame};
use crate::gpu::Gpu;
use crate::gpu::device::{GpuOptions, NO_ADAPTER};
use crate::output::toned8;
use crate::plan::Wanted;
use crate::reference;
use crate::report::Device;
use crate::scene::Scene;
use crate::scene::tone::Tone;
use std::io::Write;
use std::time::Instant;

pub enum Backend {
    /// With what a rival is asked for.
    Compute(Box<Engine>, Option<Choice>),
    Reference,
}

/// Bytes that the widest table of a band has a pixel and sample: a ray of a ray map, hi or lo, or by what it differs.
const FIELD_BYTES: u64 = 24;

/// And a row of samples for each of them, and one more.
const KEY_BYTES: u64 = 8;

impl Backend {
    /// The engine asked for; without any adapter the reference, and a line on stderr that says so.
    pub fn open(args: &RenderArgs) -> Result<Backend> {
        if matches!(args.engine, Some(EngineName::Reference)) {
            return Ok(Backend::Reference);
        }
        let options = GpuOptions { adapter: args.adapter.clone(), no_int64: args.no_int64, no_f64: args.no_f64 };
        if let Some(gpu) = Gpu::open(&options)? {
            let by = match args.engine {
                Some(EngineName::Rival(choice)) => Some(choice),
                _ => None,
            };
            return Ok(Backend::Compute(Box::new(Engine::new(gpu)), by));
        }
        if let Some(EngineName::Rival(choice)) = args.engine {
            return Err(Error::work(format!("--engine {} needs an adapter: {NO_ADAPTER}", choice.label())));
        }
        if args.moving {
            return Err(Error::work(format!("--moving needs an adapter: {NO_ADAPTER}")));
        }
        if args.analytic {
            return Err(Error::work(format!("--analytic needs an adapter: {NO_ADAPTER}")));
        }
        // a closed stderr is no reason not to render
        let _ = writeln!(std::io::stderr(), "{NO_ADAPTER}; rendering on the CPU as --engine reference does");
        Ok(Backend::Reference)
    }

    /// Refuses an image whose smallest band does not fit the adapter.
    pub fn check_size(&self, camera: &Camera, wanted: &Wanted) -> Result<()> {
        let Backend::Compute(engine, _) = self else { return Ok(()) };
        let limit = engine.gpu.binding_limit();
        let is_field = camera.layers.iter().any(|l| matches!(l, Rays::Field(_)));
        let samples = match u64::from(wanted.samples) {
            1 => 0,
            n if is_field => FIELD_BYTES * n,
            n => KEY_BYTES * (n + 1),
        };
        let pixel = (4 * (wanted.channels.len() as u64 + 3)).max(FIELD_BYTES).max(samples);
        // one tile's rows and one more, one column more
        let row = u64::from(crate::TILE + 1) * pixel;
        let widest = (limit / row).saturating_sub(1);
        if u64::from(camera.width) <= widest {
            return Ok(());
        }
        let (width, name) = (camera.width, &engine.gpu.info.name);
        Err(Error::input(format!(
            "the image is {width} pixels wide; adapter {name} binds at most {limit} bytes of storage \
             (max_storage_buffer_binding_size), which holds {widest}; make it narrower or use --engine reference"
        )))
    }

    pub fn device(&self) -> Device {
        match self {
            Backend::Compute(engine, by) => {
                let info = &engine.gpu.info;
                let driver = format!("{} {}", info.driver, info.driver_info).trim().to_owned();
                let engine = by.map_or("compute".into(), |choice| choice.label());
                Device { adapter: info.name.clone(), driver, engine }
            }
            Backend::Reference => Device { adapter: "cpu".into(), driver: String::new(), engine: "reference".into() },
        }
    }

    pub fn render(&mut self, scene: &Scene, camera: &Camera, wanted: &Wanted, run: &RunOptions) -> Result<Rendered> {
        match self {
            Backend::Compute(engine, by) => {
                engine.render(scene, camera, wanted, &RunOptions { by: *by, ..run.clone() })
            }
            Backend::Reference if wanted.channels.contains(&Channel::Certified) => Err(Error::input(
                "certified is a channel of --engine compute; the reference has margins: see --check and --pixel",
            )),
            Backend::Reference => {
                if wanted.has_colour() {
                    scene.check_shadows()?;
                }
                Ok(by_reference(scene, camera, wanted, run))
            }
        }
    }
}

/// A frame as the engine gives it, by the reference.
fn by_reference(scene: &Scene, camera: &Camera, wanted: &Wanted, run: &RunOptions) -> Rendered {
    let mut channels = wanted.channels.clone();
    if wanted.srgb8 {
        channels.extend([Channel::R, Channel::G, Channel::B]);
    }
    channels.sort_unstable();
    channels.dedup();
    let started = Instant::now();
    let lit = if wanted.has_colour() { reference::caustics::caustics(scene) } else { None };
    let ms = started.elapsed().as_secs_f64() * 1e3;
    let timed = || {
        let started = Instant::now();
        let frame = reference::image::image_lit(scene, camera, &channels, lit.as_ref());
        (frame, started.elapsed().as_secs_f64() * 1e3)
    };
    let (mut frame, first_ms) = timed();
    let frame_ms = match run.repeat {
        0 => vec![first_ms],
        n => (0..n).map(|_| timed().1).collect(),
    };
    let srgb8 = if wanted.srgb8 { picture(&frame, scene.tone) } else { None };
    frame.planes.retain(|(c, _)| wanted.channels.contains(c));
    Rendered {
        frame,
        sample_ids: Vec::new(),
        srgb8,
        frame_ms,
        stages: Vec::new(),
        counts: Counts::default(),
        bytes: 0,
        left_out: Vec::new(),
        grown: 0,
        passes: 0,
        caustics: lit.map(|lit| Account { budget: lit.budget, ms }),
    }
}

/// The frame's colour as opaque 8-bit sRGB, four bytes a pixel; `None` without colour.
pub fn picture(frame: &Frame, tone: Tone) -> Option<Vec<u8>> {
    let (r, g, b) = (frame.f32(Channel::R)?, frame.f32(Channel::G)?, frame.f32(Channel::B)?);
    let pixels = r.iter().zip(g).zip(b);
    let byte = |linear: &f32| toned8(tone, *linear);
    Some(pixels.flat_map(|((r, g), b)| [byte(r), byte(g), byte(b), u8::MAX]).collect())
}

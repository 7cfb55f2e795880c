//! A render in three steps: read and check, render on a device, write. Only the second step needs the device.

use super::backend::{Backend, NO_AREAS};
use super::files;
use super::gradients::gradients_of;
use super::job::{Change, RenderJob, load_from};
#[cfg(feature = "cli")]
use super::notes;
use super::options::{Gradients, Named};
use super::strips::{Strips, WHOLE_MAX};
use super::{judged, memory, points};
use crate::arrays::MapEach;
use crate::camera::{Camera, Rays};
use crate::engine::call_ms::{CallMs, ms_since};
use crate::engine::combinations::Asked;
use crate::engine::left_out::LeftOut;
use crate::engine::plan::{Rows, Wanted};
use crate::engine::planned::{Planned, Planner};
use crate::engine::report::{Device, FrameMs, Judged, Report};
use crate::engine::rival::EngineName;
use crate::engine::sequence::Sequence;
use crate::engine::{Rendered, RunOptions};
use crate::geometry::mesh::{Mesh, Missing};
use crate::geometry::texture::ImagesRead;
use crate::image::cryptomatte::{Matte, MatteKind};
use crate::image::frame::Channel;
use crate::input::files::Inputs;
use crate::input::{Error, Loading, Result};
use crate::parallel::share::Share;
use crate::scene::Scene;
use crate::scene::file::OutputSpec;
use crate::scene::gradients;
use crate::scene::labels::Labels;
use crate::scene::library::Library;
use crate::scene::motion;
use std::sync::Arc;
use std::time::Instant;

/// A render, read and checked.
pub struct Work {
    pub job: RenderJob,
    scene: Scene,
    pub camera: Arc<Camera>,
    /// The channels to write.
    asked: Vec<Channel>,
    /// The render options for them.
    wanted: Wanted,
    matte_kinds: Vec<MatteKind>,
    /// Scene and camera of the frame that motion points to.
    next: Option<(Scene, Arc<Camera>)>,
    /// Approximate memory until it is written.
    pub bytes: u64,
    /// Set if the image is rendered in strips because it does not fit the memory: bytes per row.
    strips: Option<u64>,
    /// The result of [`sample_bytes`].
    sample_bytes: u64,
    /// How much of [`Work::render`] is done.
    pub share: Share,
    /// Time that reading and checking took, ms.
    read_ms: f64,
}

/// The rendered result.
pub struct Seen {
    rendered: Rendered,
    /// An extra, untimed frame for counts and checks.
    extra: Option<Rendered>,
    /// Time of the extra frame and of repeated frames, ms; not counted in the call.
    excluded_ms: f64,
    mattes: Vec<Matte>,
    gradients: Option<gradients::Gradients>,
    /// The image file is already written.
    is_written: bool,
}

impl Seen {
    fn of(rendered: Rendered, mattes: Vec<Matte>) -> Seen {
        Seen { rendered, extra: None, excluded_ms: 0.0, mattes, gradients: None, is_written: false }
    }
}

/// The result once all files are written.
#[derive(Debug, Clone)]
pub struct Written {
    /// Time from the start of reading, or of the program, until the files were written, without repeated frames and checks, ms.
    pub call_ms: f64,
    pub frame_ms: FrameMs,
    /// Device times of the stages, ms; empty without timestamps.
    pub stages: Vec<(&'static str, f64)>,
    pub error: Option<Judged>,
    pub triangles: usize,
    pub pieces: usize,
    pub adapter: String,
    /// Features of the scene that the engine leaves out.
    pub left_out: Vec<LeftOut>,
}

/// Approximate memory per vertex and per triangle, scene and device tables together.
const VERTEX_BYTES: u64 = 64;
const TRIANGLE_BYTES: u64 = 128;

impl Work {
    /// Reads the scene, with cached parts from the library, and checks everything that needs no device.
    ///
    /// # Errors
    /// [`Error::Input`] if the scene or the flags are wrong; [`Error::Write`] if a file cannot be written.
    pub fn read(job: RenderJob, library: &Library) -> Result<Work> {
        Ok(Work::read_with(job, library, true)?.0)
    }

    /// The same, ignoring the output files that the scene names. Also returns the files that it was read from.
    pub fn read_of_many(job: RenderJob, library: &Library) -> Result<(Work, Inputs)> {
        Work::read_with(job, library, false)
    }

    fn read_with(job: RenderJob, library: &Library, has_scene_outputs: bool) -> Result<(Work, Inputs)> {
        let started = Instant::now();
        job.check_options()?;
        let loading = Loading::new(job.limits);
        let outputs = |own: &OutputSpec| if has_scene_outputs { own.clone() } else { OutputSpec::default() };
        let images = |own: &OutputSpec| images_read(&job, &outputs(own));
        let (scene, camera) = load_from(library, &job.scene, &job.change, images, &loading)?;
        let scene = Scene { output: outputs(&scene.output), ..scene };
        let work = Work::of(started, job, (scene, camera), library, &loading)?;
        Ok((work, loading.into_inputs()))
    }

    /// The work for a scene that `loading` has read, since `started`.
    fn of(
        started: Instant,
        mut job: RenderJob,
        (scene, camera): (Scene, Arc<Camera>),
        library: &Library,
        loading: &Loading,
    ) -> Result<Work> {
        if job.strict {
            refuse_missing(&scene)?;
        }
        if let Some(Gradients { asked, .. }) = job.gradients() {
            check_gradients(&job, &asked, (&scene, &camera), loading)?;
        }
        if let Some(composition) = &camera.composition {
            composition.check(&scene.objects)?;
        }
        job.take_outputs(&scene, &loading.inputs())?;
        let asked = asked(&job, &scene, &camera);
        let matte_kinds: Vec<MatteKind> = matte_kinds(&job).collect();
        if !matte_kinds.is_empty() && job.exr.is_none() {
            return Err(Error::input("--channels: cryptomattes are layers of an EXR; add --exr OUT.exr"));
        }
        if job.moving && asks_for_motion(&job) {
            return Err(Error::input(
                "--moving: the channel motion compares frames of the scene file; leave out --moving or motion",
            ));
        }
        let next = match asks_for_motion(&job) {
            true => Some(next_frame(&job, library, loading)?),
            false => None,
        };
        let mut wanted = wanted(&asked, &job, matte_kinds.is_empty() && next.is_none());
        if next.is_some() {
            wanted.channels = Channel::in_order(wanted.channels.into_iter().chain(motion::NEEDED));
        }
        points::check(job.points.as_deref(), &camera)?;
        let is_compute = matches!(job.engine, None | Some(EngineName::Compute));
        let is_reference = matches!(job.engine, Some(EngineName::Reference));
        let mut wanted =
            Wanted { samples: job.samples, sample_ids: !matte_kinds.is_empty(), analytic: job.analytic, ..wanted };
        if !matte_kinds.is_empty() && samples_at_once(&job, &scene, &camera, &wanted) == job.samples {
            // costs nothing, and notes look at it
            wanted.channels = Channel::in_order(wanted.channels.into_iter().chain([Channel::TriangleId]));
        }
        if job.analytic {
            if is_reference {
                return Err(Error::input(NO_AREAS));
            }
            Asked { rival: job.rival(), ..Asked::new(&scene, &camera, &wanted) }.check()?;
        }
        let (size, channels) = ((camera.width, camera.height), wanted.channels.len() + 3);
        let samples = if is_reference { 1 } else { samples_at_once(&job, &scene, &camera, &wanted) };
        let more = sample_bytes(&camera, samples, !matte_kinds.is_empty());
        let mesh = scene.mesh.base();
        let mut bytes = memory::need(size, channels, more);
        let is_plain = (job.exr.is_some() || job.color.is_some()) && job.points.is_none();
        let is_alone =
            matte_kinds.is_empty() && next.is_none() && job.gradients.is_none() && !job.check && job.repeat.is_none();
        let of_rows = Wanted { rows: Some(Rows { first: 0, count: camera.height }), ..wanted.clone() };
        let is_in_strips =
            bytes > WHOLE_MAX && (is_compute && is_plain && is_alone) && Sequence::takes(&scene, &camera, &of_rows);
        if is_in_strips {
            bytes = WHOLE_MAX;
        }
        bytes += mesh_bytes(mesh);
        let strips = is_in_strips.then(|| memory::need((camera.width, 1), channels, more));
        Ok(Work {
            job,
            scene,
            camera,
            asked,
            wanted,
            matte_kinds,
            next,
            bytes,
            strips,
            sample_bytes: more,
            share: Share::default(),
            read_ms: ms_since(started),
        })
    }

    /// Whether channels are asked for that nothing is written with.
    #[cfg(feature = "cli")]
    pub fn loses_channels(&self) -> bool {
        self.job.channels.is_some() && self.job.exr.is_none()
    }

    /// Notes for the user about a frame, a line each: nothing is hit, positions are coarse, or blending lacks samples.
    #[cfg(feature = "cli")]
    pub fn notes(&self, seen: &Seen) -> Vec<String> {
        let Rendered { frame, srgb8, .. } = &seen.rendered;
        let has_positions = self.job.exr.is_some() && self.asked.iter().any(|c| Channel::named("P").contains(c));
        let coarse = has_positions.then(|| notes::coarse_positions(&self.scene)).flatten();
        let is_colored = srgb8.is_some() || self.asked.iter().any(|c| [Channel::R, Channel::G, Channel::B].contains(c));
        let unblended = is_colored.then(|| notes::unblended(&self.scene, self.job.samples)).flatten();
        let empty = notes::nothing_hit(&self.scene, &self.camera, frame, srgb8.as_deref());
        empty.into_iter().chain(coarse).chain(unblended).collect()
    }

    /// Missing files and attributes that mesh files refer to.
    pub fn missing(&self) -> &[Missing] {
        &self.scene.mesh.base().missing
    }

    /// Refuses an image or a mesh that does not fit the free memory.
    ///
    /// # Errors
    /// [`Error::Work`] that names the limit.
    pub fn check_memory(&self) -> Result<()> {
        let mesh = self.scene.mesh.base();
        let what = format_args!("rendering {} triangles and spheres", mesh.triangles.len());
        self.job.limits.check_memory(mesh_bytes(mesh), what, "simplify the meshes")?;
        if self.camera.optics.is_some() || self.camera.layered().is_some() {
            // facets are appended to one mesh, and objects hidden in it
            self.scene.mesh.check_copies(self.job.limits)?;
        }
        if self.strips.is_some() { Ok(()) } else { self.check_whole() }
    }

    fn check_whole(&self) -> Result<()> {
        let Camera { width, height, .. } = *self.camera;
        memory::check((width, height), self.wanted.channels.len() + 3, self.sample_bytes, self.job.limits)
    }

    /// Renders it, and the extra frame that a report or a check needs.
    pub fn render(&self, backend: &mut Backend) -> Result<Seen> {
        let Work { job, scene, camera, wanted, .. } = self;
        let samples = samples_at_once(job, scene, camera, wanted);
        backend.check_size(camera, &Wanted { samples, ..wanted.clone() })?;
        if let (Some(row_bytes), Backend::Compute(engine, None)) = (self.strips, &mut *backend) {
            let run = RunOptions { share: self.share.clone(), ..job.run_options() };
            let rendered = Strips { scene, camera, wanted, run, row_bytes, job }.render(engine)?;
            return Ok(Seen { is_written: true, ..Seen::of(rendered, Vec::new()) });
        }
        if self.strips.is_some() {
            self.check_whole()?;
        }
        let mut mattes = self.mattes();
        let (repeat, share) = (job.repeat.unwrap_or(0), self.share.clone());
        let run = RunOptions { repeat, moving: job.moving, share, ..job.run_options() };
        let mut count = |ids: Vec<u32>| mattes.iter_mut().for_each(|matte| matte.add(&ids));
        let rendered = backend.render(scene, camera, wanted, &run, &mut count)?;
        let started = Instant::now();
        let extra = judged::render(job, backend, scene, camera)?;
        let repeated_ms = if repeat > 0 { rendered.frame_ms.iter().sum() } else { 0.0 };
        let excluded_ms = ms_since(started) + repeated_ms;
        let gradients = self.gradients(backend, &rendered)?;
        Ok(Seen { extra, excluded_ms, gradients, ..Seen::of(rendered, mattes) })
    }

    /// The gradients of a frame, if they are asked for.
    fn gradients(&self, backend: &Backend, rendered: &Rendered) -> Result<Option<gradients::Gradients>> {
        let Some(own) = self.job.gradients() else { return Ok(None) };
        let ids =
            rendered.frame.u32(Channel::TriangleId).ok_or_else(|| Error::work("gradients: the frame has no ids"))?;
        let of = (&self.scene, &*self.camera, &*self.scene.camera_keys);
        gradients_of(backend, of, ids, &own.asked).map(Some)
    }

    /// Plans its frame as one of a sequence; `None` if it takes several frames, or one by itself.
    pub fn plan(&self, planner: &Planner, last: Option<&Planned>) -> Result<Option<Planned>> {
        let Work { job, scene, camera, wanted, .. } = self;
        let is_compute = matches!(job.engine, None | Some(EngineName::Compute));
        let is_timed = job.repeat.is_some() || job.report.is_some() || job.check;
        if !is_compute || is_timed || self.strips.is_some() || job.gradients.is_some() {
            return Ok(None);
        }
        if !Sequence::takes(scene, camera, wanted) {
            return Ok(None);
        }
        planner.check_size(camera, wanted)?;
        let run = job.run_options();
        planner.plan(scene, camera.clone(), wanted, &run, last).map(Some)
    }

    /// The result of the frame that [`Work::plan`] planned.
    pub fn seen(&self, mut rendered: Rendered) -> Seen {
        let mut mattes = self.mattes();
        let count = |ids: Vec<u32>| mattes.iter_mut().for_each(|matte| matte.add(&ids));
        rendered.sample_ids.drain(..).for_each(count);
        Seen::of(rendered, mattes)
    }

    /// Writes all files; `say` receives progress messages.
    pub fn write(&self, seen: Seen, device: &Device, started: Instant, say: impl Fn(&str)) -> Result<Written> {
        let Work { job, scene, camera, .. } = self;
        let Seen { mut rendered, extra, mut excluded_ms, mattes, gradients, is_written } = seen;
        let checking = Instant::now();
        let error = match &extra {
            Some(extra) if job.check => {
                say("checking against the reference");
                Some(judged::judge(scene, camera, &rendered, extra, job.samples)?)
            }
            _ => None,
        };
        excluded_ms += ms_since(checking);
        let mut more = Vec::new();
        if let Some((next_scene, next_camera)) = &self.next {
            say("finding where all of it is in the next frame");
            let planes = motion::motion((scene, camera), (next_scene, next_camera), &rendered.frame)?;
            more.extend(motion::NAMES.map_each(String::from).into_iter().zip(planes));
        }
        say("writing");
        let writing = Instant::now();
        if !is_written {
            job.write(scene, camera, &rendered, &self.asked, (mattes, more))?;
        }
        if let (Some(named), Some(gradients)) = (job.gradients(), &gradients) {
            named.write(gradients)?;
        }
        let CallMs { encode, .. } = rendered.call;
        let encode = encode + ms_since(writing);
        let total = ms_since(started) - excluded_ms;
        rendered.call = CallMs { read: self.read_ms, encode, total, ..rendered.call };
        if let Some(path) = &job.report {
            if extra.is_some() {
                rendered.left_out.retain(|left| *left != LeftOut::FragmentCounters);
            }
            let counts = extra.filter(|_| matches!(device.engine, EngineName::Compute)).map(|e| e.counts);
            let mut report = Report::new(device.clone(), scene, camera, &rendered, counts);
            report.samples = job.samples;
            report.error = error.clone();
            files::write_report(path, &report)?;
        }
        Ok(Written {
            call_ms: rendered.call.total,
            frame_ms: FrameMs::of(&rendered.frame_ms),
            stages: rendered.stages,
            error,
            triangles: scene.mesh.triangle_count(),
            pieces: camera.piece_count(),
            adapter: device.adapter.clone(),
            left_out: rendered.left_out,
        })
    }

    /// The summary line.
    pub fn summary(&self, written: &Written) -> String {
        let Written { call_ms, frame_ms, error, adapter, .. } = written;
        let of_error = |e: &Judged| format!(" | check: {}, {} not near", e.comparison, e.not_near);
        let check = error.as_ref().map(of_error).unwrap_or_default();
        let (names, counted) = (self.job.output_names(), counted(&self.scene, &self.camera));
        let (width, height) = (self.camera.width, self.camera.height);
        let (call, frame) = (milliseconds(*call_ms), milliseconds(frame_ms.median));
        let unfulfilled: String = self.camera.unfulfilled.iter().map(|what| format!(" | {what}")).collect();
        format!("{names}{width}x{height} | {counted} | call {call}, frame {frame} | {adapter}{check}{unfulfilled}")
    }

    fn mattes(&self) -> Vec<Matte> {
        self.matte_kinds.iter().map(|matte_kinds| Labels::matte(&self.scene, &self.camera, *matte_kinds)).collect()
    }
}

fn mesh_bytes(mesh: &Mesh) -> u64 {
    VERTEX_BYTES * mesh.positions.len() as u64 + TRIANGLE_BYTES * mesh.triangles.len() as u64
}

/// How many samples per pixel one frame computes.
fn samples_at_once(job: &RenderJob, scene: &Scene, camera: &Camera, wanted: &Wanted) -> u32 {
    let asked = Asked { rival: job.rival(), ..Asked::new(scene, camera, wanted) };
    if asked.is_separate() { 1 } else { wanted.samples }
}

/// Bytes per pixel that multisampling adds: offsets of rays, here and on the device, and the ids that mattes count, in
/// a read-back row and on their own. The records of edge pixels are few.
fn sample_bytes(camera: &Camera, samples: u32, has_mattes: bool) -> u64 {
    let is_field = camera.layers.iter().any(|l| matches!(l, Rays::Field(_)));
    let each = if is_field { 2 * 24 } else { 0 } + if has_mattes { 8 + 4 } else { 0 };
    if samples > 1 { each * u64::from(samples) } else { 0 }
}

/// The channels to write.
fn asked(job: &RenderJob, scene: &Scene, camera: &Camera) -> Vec<Channel> {
    let of = |named: &Named| match named {
        Named::Channels(list) => list.clone(),
        Named::All => scene.channels(camera),
        Named::Matte(_) | Named::Motion => Vec::new(),
    };
    match &job.channels {
        Some(list) => list.iter().flat_map(of).collect(),
        None if job.exr.is_some() => camera.channels(),
        None => Vec::new(),
    }
}

fn asks_for_motion(job: &RenderJob) -> bool {
    job.channels.iter().flatten().any(|named| matches!(named, Named::Motion))
}

/// The scene and its camera one frame later.
fn next_frame(job: &RenderJob, library: &Library, loading: &Loading) -> Result<(Scene, Arc<Camera>)> {
    if job.exr.is_none() {
        return Err(Error::input("--channels: motion is two channels of an EXR; add --exr OUT.exr"));
    }
    let change = Change { frame: job.change.frame + 1.0, ..job.change.clone() };
    let images = |_: &OutputSpec| images_read(job, &OutputSpec::default());
    load_from(library, &job.scene, &change, images, loading)
}

/// The images that the requested outputs need: all for colour, otherwise alpha masks only. `own` are the scene's outputs.
fn images_read(job: &RenderJob, own: &OutputSpec) -> ImagesRead {
    use Channel::{AlbedoB, AlbedoG, AlbedoR, B, G, R};
    let is_colour = |c: &Channel| matches!(c, R | G | B | AlbedoR | AlbedoG | AlbedoB);
    let has_exr = job.exr.is_some() || own.exr.is_some();
    let has_colour = |named: &Named| match named {
        Named::Channels(list) => list.iter().any(is_colour),
        Named::All => true,
        Named::Matte(_) | Named::Motion => false,
    };
    let in_channels = match &job.channels {
        Some(list) => list.iter().any(has_colour),
        None => has_exr || (job.points.is_none() && job.gradients.is_none()),
    };
    match job.color.is_some() || own.color.is_some() || job.check || in_channels {
        true => ImagesRead::All,
        false => ImagesRead::Masks,
    }
}

/// The Cryptomattes asked for.
fn matte_kinds(job: &RenderJob) -> impl Iterator<Item = MatteKind> {
    [MatteKind::Objects, MatteKind::Materials].into_iter().filter(|own| {
        let is_own = |named: &Named| matches!(named, Named::Matte(kind) if kind == own);
        job.channels.iter().flatten().any(is_own)
    })
}

/// `strict`: an error if mesh files lack something.
pub fn refuse_missing(scene: &Scene) -> Result<()> {
    match &scene.mesh.base().missing[..] {
        [] => Ok(()),
        [first, rest @ ..] => {
            let more = if rest.is_empty() { String::new() } else { format!(", and {} more", rest.len()) };
            Err(Error::input(format!("{}: {}{more}; render without --strict to leave this out", first.what, first.why)))
        }
    }
}

/// Refuses gradients of this scene and camera, before anything is written.
fn check_gradients(
    job: &RenderJob,
    asked: &gradients::Asked,
    (scene, camera): (&Scene, &Camera),
    loading: &Loading,
) -> Result<()> {
    let wanted = Wanted { gradients: true, coverage_gradients: asked.has_coverage(), ..Wanted::of(Vec::new()) };
    Asked { rival: job.rival(), ..Asked::new(scene, camera, &wanted) }.check()?;
    asked.numbers().try_for_each(|key| scene.camera_keys.number(key, loading).map(|_| ()))?;
    asked.check_memory((camera.width, camera.height), job.limits)
}

/// What the outputs need: the picture unless only channels or mattes are asked for; points come from triangles.
fn wanted(asked: &[Channel], job: &RenderJob, has_no_matte: bool) -> Wanted {
    let has_ids = job.points.is_some() || job.gradients.is_some();
    let ids = has_ids.then_some(Channel::TriangleId);
    let channels = Channel::in_order(asked.iter().copied().chain(ids));
    let srgb8 = job.color.is_some() || (channels.is_empty() && has_no_matte);
    Wanted { srgb8, ..Wanted::of(channels) }
}

/// Triangles, spheres, capsules and pieces, in words.
pub fn counted(scene: &Scene, camera: &Camera) -> String {
    let of = |n: usize, what: &str| format!("{n} {what}{}", if n == 1 { "" } else { "s" });
    let [spheres, capsules] = scene.mesh.base().round_counts();
    let triangles = scene.mesh.triangle_count() - spheres - capsules;
    let counts = [(triangles, "triangle"), (spheres, "sphere"), (capsules, "capsule")];
    let shown = counts.into_iter().filter(|(n, what)| *n > 0 || *what == "triangle" && spheres + capsules == 0);
    let triangles = shown.map(|(n, what)| of(n, what)).collect::<Vec<_>>().join(", ");
    match camera.piece_count() {
        0 if camera.is_curved() => format!("{triangles}, a curve a pixel"),
        0 => format!("{triangles}, a ray a pixel"),
        n => format!("{triangles}, {}", of(n, "piece")),
    }
}

fn milliseconds(ms: f64) -> String {
    if ms < 1000.0 { format!("{ms:.1} ms") } else { format!("{:.2} s", ms / 1e3) }
}

//! Draws what pages ask for: from the scene's text to the bytes of a picture.

use super::lines;
use super::messages::{Header, Quality, Times};
use super::session::{At, Inspection, Job, Session, Work};
use crate::camera::Camera;
use crate::camera::exposure::Exposure;
use crate::engine::call_ms::ms_since;
use crate::engine::left_out::LeftOut;
use crate::engine::plan::Wanted;
use crate::engine::{Engine, Rendered, RunOptions};
use crate::geometry::load::{Object, with_unique_names};
use crate::geometry::mesh::Mesh;
use crate::geometry::place;
use crate::geometry::scene_mesh::SceneMesh;
use crate::geometry::texture::ImagesRead;
use crate::gpu::device::GpuOptions;
use crate::image::png_bytes;
use crate::image::tone::Tone;
use crate::input::{Error, Limits, Loading, Result};
use crate::jobs::{Backend, Kept, RenderJob, check_memory, options};
use crate::reference;
use crate::scene::labels::Labels;
use crate::scene::library::Library;
use crate::scene::style::Style;
use crate::scene::{Scene, file};
use image::codecs::jpeg::JpegEncoder;
use image::{ExtendedColorType, ImageEncoder};
use serde_json::json;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError, Weak};
use std::time::Instant;

/// Larger pictures are shown smaller.
const PIXELS_MAX: u64 = 1 << 24;
/// Moving pictures should take at most so long, ms: with what it takes to send and draw one, under 50.
const MOVING_MS: f64 = 36.0;
/// The first pictures of a size do not count: the scene is uploaded for them, and kernels may be compiled.
const FIRST: u32 = 2;
/// Moving pictures in a row that are too slow before smaller ones follow.
const SLOW_MAX: u32 = 3;
/// Fast pictures in a row before a larger size is tried. Doubled each time the larger size was too slow.
const FAST_MIN: u32 = 8;
/// Steps of the size of moving pictures: eighths of the size at rest.
const STEPS: u32 = 8;
/// JPEG quality, in percent.
const MOVING_QUALITY: u8 = 80;
/// The camera of a drawn volume needs few pixels.
const VOLUME_SIDE: u32 = 192;
/// Scenes of fewer triangles are kept on the device once for each quality.
const KEPT_TRIANGLES: usize = 1 << 20;

/// What loads scenes, for the painter and the inspector.
pub struct Loader {
    library: Library,
    path: PathBuf,
    limits: Limits,
    /// A scene in memory, whose text is that of the camera alone.
    base: Option<Scene>,
    /// The meshes of `base` and of the last text, and these in one.
    joined: Mutex<Option<(Arc<SceneMesh>, Joined)>>,
}

/// Meshes in one, and their objects.
type Joined = (Arc<SceneMesh>, Vec<Object>);

impl Loader {
    pub fn new(path: &Path, limits: Limits, base: Option<Scene>) -> Loader {
        Loader { library: Library::default(), path: path.to_owned(), limits, base, joined: Mutex::default() }
    }

    pub fn scene(&self, at: &At) -> Result<Scene> {
        let loading = Loading::new(self.limits);
        let file = file::of_text(&at.text, &self.path, at.frame, &loading)?;
        let scene = self.library.scene(file, ImagesRead::All, &loading).map_err(|e| e.at(self.path.display()))?;
        match &self.base {
            Some(base) => self.with_base(scene, base),
            None => Ok(scene),
        }
    }

    /// A scene of a text with the meshes of `base` before its own, and the lights and the style of `base` where it has none.
    fn with_base(&self, scene: Scene, base: &Scene) -> Result<Scene> {
        let (mesh, objects) = if scene.mesh.triangle_count() == 0 {
            (base.mesh.clone(), base.objects.clone())
        } else {
            let mut joined = self.joined.lock().unwrap_or_else(PoisonError::into_inner);
            match joined.as_ref().filter(|(own, _)| Arc::ptr_eq(own, &scene.mesh)) {
                Some((_, joined)) => joined.clone(),
                None => {
                    base.mesh.check_copies(base.limits)?;
                    scene.mesh.check_copies(scene.limits)?;
                    place::check_counts([&**base.mesh, &**scene.mesh])?;
                    let mut mesh = Mesh::clone(&base.mesh);
                    place::append_with_all(&mut mesh, Mesh::clone(&scene.mesh));
                    let objects = with_unique_names(base.objects.iter().chain(&scene.objects).cloned());
                    joined.insert((scene.mesh.clone(), (mesh.into(), objects))).1.clone()
                }
            }
        };
        let is_black = scene.background == [0.0; 3];
        // where the text moves nothing, what moves in `base` does; the text's own vertices stand still then
        let steps = match &scene.steps {
            Some(steps) => Some(Arc::new(steps.after(&base.mesh))),
            None => base.steps.clone(),
        };
        Ok(Scene {
            steps,
            mesh,
            objects,
            lights: if scene.lights.is_empty() { base.lights.clone() } else { scene.lights },
            projector_lights: match scene.projector_lights.is_empty() {
                true => base.projector_lights.clone(),
                false => scene.projector_lights,
            },
            style: if scene.style == Style::default() { base.style } else { scene.style },
            ambient_occlusion: scene.ambient_occlusion.or(base.ambient_occlusion),
            sky: scene.sky.or_else(|| base.sky.clone()),
            volume: scene.volume.or_else(|| base.volume.clone()),
            background: if is_black { base.background } else { scene.background },
            tone: if scene.tone == Tone::default() { base.tone } else { scene.tone },
            caustics: scene.caustics.or_else(|| base.caustics.clone()),
            exposure: if scene.exposure == Exposure::default() { base.exposure.clone() } else { scene.exposure },
            ..scene
        })
    }

    pub fn camera(&self, scene: &Scene, size: Option<(u32, u32)>) -> Result<Arc<Camera>> {
        self.library.camera(scene, size, &Loading::new(self.limits)).map_err(|e| e.at(self.path.display()))
    }

    /// A camera for pictures `eighths` / 8 as large as `scene`'s own, or of its own size where the camera has only that.
    fn scaled(&self, scene: &Scene, eighths: u32) -> Result<Arc<Camera>> {
        let shrunk = |side: u32| (side * eighths).div_ceil(STEPS).max(1);
        match scene.size.filter(|_| eighths < STEPS) {
            Some((w, h)) => self.camera(scene, Some((shrunk(w), shrunk(h)))).or_else(|_| self.camera(scene, None)),
            None => self.camera(scene, None),
        }
    }
}

/// Draws pictures, one after another.
struct Painter {
    loader: Arc<Loader>,
    options: GpuOptions,
    engine: Option<Engine>,
    is_open: bool,
    /// The scene on the device, as of the last picture of each quality.
    kept: [Kept; 3],
    pace: Pace,
    /// The meshes whose lines were sent, and their number.
    wires: (Weak<SceneMesh>, u64),
}

/// The size of moving pictures.
#[derive(Debug)]
struct Pace {
    /// In eighths of the size at rest.
    eighths: u32,
    /// Pictures in a row that were too slow, or fast enough for a larger size.
    slow: u32,
    fast: u32,
    /// Fast pictures before a larger size is tried.
    patience: u32,
    /// The last change was to a larger size.
    has_grown: bool,
    /// Pictures of this size so far.
    count: u32,
}

impl Pace {
    fn new() -> Pace {
        Pace { eighths: STEPS, slow: 0, fast: 0, patience: FAST_MIN, has_grown: false, count: 0 }
    }

    /// Adapts the size to what a picture of it took; `most` eighths are the most.
    fn took(&mut self, ms: f64, most: u32) {
        self.count += 1;
        if self.count <= FIRST {
            return;
        }
        let area = |to: u32| f64::from(to * to) / f64::from(self.eighths * self.eighths);
        // half of the time at least does not depend on the size
        let larger_ms = ms * (1.0 + area(self.eighths + 1)) / 2.0;
        (self.slow, self.fast) = match ms {
            ms if ms > MOVING_MS => (self.slow + 1, 0),
            _ if larger_ms < MOVING_MS => (0, self.fast + 1),
            _ => (0, 0),
        };
        if self.slow >= SLOW_MAX && self.eighths > 1 {
            let fitting = (1..self.eighths).rev().find(|k| ms * area(*k) <= MOVING_MS).unwrap_or(1);
            self.patience = if self.has_grown { self.patience.saturating_mul(2) } else { self.patience };
            *self = Pace { eighths: fitting, patience: self.patience, ..Pace::new() };
        } else if self.fast >= self.patience && self.eighths < most {
            *self = Pace { eighths: self.eighths + 1, patience: self.patience, has_grown: true, ..Pace::new() };
        }
    }
}

/// Works for a session until it ends. `engine` is open; `options` open it again after it was lost.
pub fn paint(session: &Session, loader: Arc<Loader>, engine: Option<Engine>, options: GpuOptions) {
    let mut painter = Painter {
        loader,
        options,
        engine,
        is_open: true,
        kept: Default::default(),
        pace: Pace::new(),
        wires: (Weak::new(), 0),
    };
    while let Some(work) = session.next_work() {
        match work {
            Work::Picture(job) => session.drawn(&job, painter.guarded(|painter| painter.picture(&job))),
            Work::Beside(job) => session.drawn_beside(&job, painter.guarded(|painter| painter.beside(&job))),
            Work::Lines(at) => {
                let drawn = painter.guarded(|painter| painter.lines(session, &at));
                // what is wrong with the camera is said of its picture
                if drawn.is_err() {
                    session.lined(&at, json!({}));
                }
            }
        }
    }
}

/// Answers what takes long on the CPU, until the session ends.
pub fn inspect(session: &Session, loader: &Loader) {
    while let Some(inspection) = session.next_inspection() {
        match inspection {
            Inspection::Pixel { page, x, y, tag, scene } => {
                let answer = caught(|| pixel(loader, &scene, x, y));
                let mut answer = answer.unwrap_or_else(|why| json!({ "why": why.to_string() }));
                (answer["is"], answer["tag"], answer["x"], answer["y"]) =
                    ("pixel".into(), tag.into(), x.into(), y.into());
                session.state().answer(page, &answer);
            }
            Inspection::Beside(job) => {
                session.drawn_beside(&job, caught(|| beside(loader, &job, None)).map_err(|e| e.to_string()))
            }
        }
    }
}

/// The result of some work; a panic is a defect of the program, and an error for the user.
fn caught<T>(work: impl FnOnce() -> Result<T>) -> Result<T> {
    let defect = |_| Err(Error::work("internal error; please report it with the scene's text"));
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(defect)
}

impl Painter {
    fn guarded<T>(&mut self, work: impl FnOnce(&mut Painter) -> Result<T>) -> std::result::Result<T, String> {
        let result = caught(|| work(self));
        if !matches!(result, Ok(_) | Err(Error::Input(_))) {
            // what failed may be half done, and the device lost
            self.kept = Default::default();
            (self.engine, self.is_open) = (None, false);
        }
        result.map_err(|e| e.to_string())
    }

    fn open(&mut self) -> Result<()> {
        if !self.is_open {
            self.engine = Engine::open(&self.options)?;
            self.is_open = true;
        }
        Ok(())
    }

    fn picture(&mut self, job: &Job) -> Result<(Header, Arc<Vec<u8>>)> {
        self.open()?;
        let started = Instant::now();
        let scene = self.loader.scene(&job.scene)?;
        let quality = job.asked.quality;
        let fits = |(w, h): (u32, u32), eighths: u32| {
            u64::from(w) * u64::from(h) * u64::from(eighths * eighths) <= PIXELS_MAX * u64::from(STEPS * STEPS)
        };
        let most = (1..=STEPS).rev().find(|k| scene.size.is_none_or(|size| fits(size, *k))).unwrap_or(1);
        let eighths = if quality == Quality::Moving { self.pace.eighths.min(most) } else { most };
        let camera = self.loader.scaled(&scene, eighths)?;
        let read = ms_since(started);
        let (mut header, rgb) = self.pixels(job, &scene, &camera)?;
        header.whole = scene.size.map_or(header.whole, |(width, height)| [width, height]);
        header.times.read = read;
        if most < STEPS {
            header.notes.push(format!("shown at {most}/8 of its width and height"));
        }
        let encoded = encoded(job, header, &rgb)?;
        if quality == Quality::Moving {
            self.pace.took(ms_since(started), most);
        }
        Ok(encoded)
    }

    fn pixels(&mut self, job: &Job, scene: &Scene, camera: &Arc<Camera>) -> Result<(Header, Vec<u8>)> {
        let started = Instant::now();
        let shown = job.asked.look.shown;
        let count = if job.asked.quality == Quality::Rest { job.asked.look.samples } else { 1 };
        let wanted = Wanted { samples: count, ..shown.wanted() };
        check_memory((camera.width, camera.height), wanted.channels.len() + 3, 0, scene.limits)?;
        let kept = match job.asked.quality {
            _ if scene.mesh.triangle_count() >= KEPT_TRIANGLES => 0,
            quality => quality as usize,
        };
        let rendered = self.kept[kept].render(self.engine.as_mut(), scene, camera, &wanted)?;
        let (mut header, rgb) = coloured(job, scene, camera, &rendered)?;
        header.times.render = ms_since(started);
        Ok((header, rgb))
    }

    /// The same picture by a rival.
    fn beside(&mut self, job: &Job) -> Result<(Header, Arc<Vec<u8>>)> {
        self.open()?;
        beside(&self.loader, job, self.engine.as_mut())
    }

    fn lines(&mut self, session: &Session, at: &At) -> Result<()> {
        let scene = self.loader.scene(at)?;
        scene.mesh.check_copies(scene.limits)?;
        if self.wires.0.as_ptr() != Arc::as_ptr(&scene.mesh) {
            self.wires = (Arc::downgrade(&scene.mesh), self.wires.1 + 1);
            session.wired(self.wires.1, lines::of_scene(&scene.mesh));
        }
        let side = scene.size.map_or(0, |(w, h)| w.max(h));
        let eighths = (1..=STEPS).rev().find(|k| side * k <= VOLUME_SIDE * STEPS).unwrap_or(1);
        let camera = self.loader.scaled(&scene, eighths)?;
        session.lined(at, lines::of_camera(&camera, &scene.mesh));
        Ok(())
    }
}

/// A second picture, by the engine that is asked for.
fn beside(loader: &Loader, job: &Job, engine: Option<&mut Engine>) -> Result<(Header, Arc<Vec<u8>>)> {
    let name = job.asked.look.beside.as_deref().unwrap_or("reference");
    let render_job = RenderJob { engine: Some(options::engine(name).map_err(Error::Input)?), ..RenderJob::of("") };
    let scene = loader.scene(&job.scene)?;
    let camera = loader.camera(&scene, None)?;
    if u64::from(camera.width) * u64::from(camera.height) > PIXELS_MAX {
        return Err(Error::input("the picture is too large for a second one beside it; make it smaller"));
    }
    let (started, shown) = (Instant::now(), job.asked.look.shown);
    let mut backend = Backend::of(engine, &render_job)?;
    let rendered = backend.render(&scene, &camera, &shown.wanted(), &RunOptions::default(), &mut |_| {})?;
    let (mut header, rgb) = coloured(job, &scene, &camera, &rendered)?;
    header.times.render = ms_since(started);
    encoded(job, header, &rgb)
}

/// The pixels of a picture, 8-bit sRGB, and its header but for the encoding.
fn coloured(job: &Job, scene: &Scene, camera: &Camera, rendered: &Rendered) -> Result<(Header, Vec<u8>)> {
    let colours = job.asked.look.shown.colours(scene, camera, &rendered.frame, rendered.srgb8.as_deref())?;
    let stages = rendered.stages.iter().map(|(name, ms)| ((*name).to_owned(), *ms)).collect();
    // what the engine leaves out is nothing that this picture lacks, but for a style
    let left_out = rendered.left_out.iter().filter(|left| **left == LeftOut::Style).map(LeftOut::to_string);
    let notes = left_out.chain(camera.notes.iter().chain(&camera.unfulfilled).cloned()).collect();
    let parts = rendered.call.parts().into_iter().filter(|(_, ms)| *ms > 0.0).collect();
    let header = Header {
        id: 0,
        beside: false,
        revision: job.asked.revision,
        seq: job.seq,
        quality: job.asked.quality,
        width: camera.width,
        height: camera.height,
        whole: [camera.width, camera.height],
        mime: "",
        legend: colours.legend,
        times: Times { parts, stages, ..Times::default() },
        notes,
    };
    Ok((header, colours.rgb))
}

/// A picture's bytes: PNG at rest, as `anamorph render` writes it; else JPEG.
fn encoded(job: &Job, mut header: Header, rgb: &[u8]) -> Result<(Header, Arc<Vec<u8>>)> {
    let started = Instant::now();
    let Header { width, height, .. } = header;
    let rest = if job.asked.look.samples > 1 { Quality::Rest } else { Quality::Whole };
    let bytes = if job.asked.quality >= rest {
        header.mime = "image/png";
        png_bytes(width, height, rgb)?
    } else {
        header.mime = "image/jpeg";
        let mut bytes = Vec::new();
        let encoder = JpegEncoder::new_with_quality(&mut bytes, MOVING_QUALITY);
        let written = encoder.write_image(rgb, width, height, ExtendedColorType::Rgb8);
        written.map_err(|e| Error::work(format!("the picture cannot be encoded: {e}")))?;
        bytes
    };
    header.times.encode = ms_since(started);
    Ok((header, Arc::new(bytes)))
}

/// What `render --pixel` prints, with names, and where the ray and the hit are.
fn pixel(loader: &Loader, at: &At, x: u32, y: u32) -> Result<serde_json::Value> {
    let scene = loader.scene(at)?;
    let camera = loader.camera(&scene, None)?;
    if x >= camera.width || y >= camera.height {
        let (width, height) = (camera.width, camera.height);
        return Err(Error::input(format!("pixel {x},{y} is outside the image of {width}x{height}")));
    }
    let explained = reference::image::explain(&scene, &camera, x, y);
    let labels = Labels::of(&scene);
    let object = explained.triangle.and_then(|t| scene.objects.get(labels.object(t) as usize));
    let material = explained.triangle.and_then(|t| scene.mesh.base().materials.get(labels.material(t) as usize));
    let curve = camera.curve(0, x, y).map(|(_, curve)| curve.points().iter().map(|p| p.to_array()).collect::<Vec<_>>());
    Ok(json!({
        "text": explained.text.trim_end(),
        "triangle": explained.triangle,
        "point": explained.point.map(|p| p.to_array()),
        "object": object.map(|o| o.name.as_str()),
        "material": material.map(|m| m.name.as_str()),
        "ray": curve,
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The size after many pictures that take `fixed` ms and `whole` ms more at full size, and how often it changed in the last half.
    fn settled(fixed: f64, whole: f64) -> (u32, usize) {
        let mut pace = Pace::new();
        let mut sizes = Vec::new();
        for _ in 0..2000 {
            pace.took(fixed + whole * f64::from(pace.eighths * pace.eighths) / f64::from(STEPS * STEPS), STEPS);
            sizes.push(pace.eighths);
        }
        (pace.eighths, sizes[1000..].windows(2).filter(|pair| pair[0] != pair[1]).count())
    }

    #[test]
    fn moving_pictures_are_as_large_as_their_time_allows() {
        assert_eq!(settled(2.0, 10.0), (8, 0));
        // 5 + 60 (6 / 8)^2 = 39 is too slow, 5 + 60 (5 / 8)^2 = 28 is not
        let (size, changes) = settled(5.0, 60.0);
        assert!(size == 5 && changes <= 4, "{size} {changes}");
        assert_eq!(settled(5.0, 5000.0).0, 1);
        assert_eq!(settled(500.0, 0.0), (1, 0));
    }
}

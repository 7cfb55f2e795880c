//! Rendering to arrays.

use super::{Camera, Scene};
use crate::camera::Camera as Rays;
use crate::engine::call_ms::ms_since;
use crate::engine::plan::Wanted;
use crate::engine::report::Report;
use crate::engine::{self, Engine};
use crate::gpu::device::GpuOptions;
use crate::image::compare::{Comparison, compare};
use crate::image::frame::{Channel, Frame};
use crate::image::{rgb8, write_exr, write_png};
use crate::input::{Error, Limits, Result};
use crate::jobs::{Backend, EngineName, Kept, RenderJob, check_memory, options};
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

/// Options of a render.
#[derive(Debug, Clone)]
pub struct RenderOptions {
    /// The channels of [`Rendered::frame`].
    pub channels: Vec<Channel>,
    /// Also compute 8-bit sRGB colour: [`Rendered::rgba`].
    pub color: bool,
    /// Rays per pixel, 1 to 64. Colour and coverage are averaged; other channels use the pixel centre.
    pub samples: u32,
    /// Weight triangles by their visible area in the pixel, not by the number of samples that see them.
    pub analytic: bool,
    /// The limits on the image: the memory that it may take.
    pub limits: Limits,
}

impl Default for RenderOptions {
    /// No channels, one ray per pixel.
    fn default() -> RenderOptions {
        RenderOptions { channels: Vec::new(), color: false, samples: 1, analytic: false, limits: Limits::default() }
    }
}

impl RenderOptions {
    /// What they ask of a frame.
    pub(super) fn wanted(&self) -> Result<Wanted> {
        let RenderOptions { channels, color, samples, analytic, .. } = self;
        options::samples(&samples.to_string()).map_err(Error::Input)?;
        let channels = Channel::in_order(channels.iter().copied());
        if channels.is_empty() && !color {
            return Err(Error::input("nothing to compute; name channels, or ask for color"));
        }
        Ok(Wanted { srgb8: *color, samples: *samples, analytic: *analytic, ..Wanted::of(channels) })
    }
}

/// A rendered image.
#[derive(Debug, Clone)]
pub struct Rendered {
    /// The channels of [`RenderOptions::channels`].
    pub frame: Frame,
    /// 8-bit sRGB, four bytes (RGBA) per pixel, row by row from the top; `None` without [`RenderOptions::color`].
    pub rgba: Option<Vec<u8>>,
    report: Report,
}

impl Rendered {
    /// Writes the colour as PNG.
    ///
    /// # Errors
    /// [`Error::Input`] without colour, [`Error::Write`] if the file cannot be written.
    pub fn write_png(&self, path: impl AsRef<Path>) -> Result<()> {
        let Some(rgba) = &self.rgba else {
            return Err(Error::input("the image was rendered without colour; set RenderOptions::color"));
        };
        write_png(path.as_ref(), self.frame.width, self.frame.height, &rgb8(rgba))
    }

    /// Writes the channels as EXR.
    ///
    /// # Errors
    /// [`Error::Write`] if the file cannot be written.
    pub fn write_exr(&self, path: impl AsRef<Path>) -> Result<()> {
        write_exr(path.as_ref(), &self.frame, &[])
    }

    /// Wall time of the call, ms: from the start of [`Renderer::render`] until the arrays are in memory. The first call that uses a camera
    /// includes the time that the camera took to compile.
    pub fn call_ms(&self) -> f64 {
        self.report.call_ms.total
    }

    /// Wall times of the parts of the call, ms: `camera`, `place`, `plan`, `upload`, `compile`, `wait`, `read_back`
    /// (`docs/reference/commands.md`, Reports).
    pub fn call_parts_ms(&self) -> impl Iterator<Item = (&'static str, f64)> {
        self.report.call_ms.parts().into_iter().filter(|(name, _)| !matches!(*name, "read" | "encode"))
    }

    /// Wall time of the frame, ms: from its submission until its results are complete on the device.
    pub fn frame_ms(&self) -> f64 {
        self.report.frame_ms.median
    }

    /// Device times of the stages, ms; empty if the adapter has no timestamps.
    pub fn stages_ms(&self) -> impl Iterator<Item = (&str, f64)> {
        self.report.stages.iter().map(|stage| (stage.name, stage.ms))
    }

    /// All times and counts, as JSON: `docs/reference/commands.md`, Reports.
    pub fn report(&self) -> String {
        serde_json::to_string_pretty(&self.report).unwrap_or_default()
    }
}

/// Renders on a GPU adapter, or by the reference on the CPU.
///
/// Meshes, cameras and textures stay on the device between images of the same size and channels.
pub struct Renderer {
    pub(super) engine: Option<Engine>,
    /// Those that the engine was opened with.
    options: GpuOptions,
    is_reference: bool,
    pub(super) kept: Kept,
}

impl Renderer {
    /// Opens the fastest kind of adapter; on a machine without adapters, the reference on the CPU, in f64.
    ///
    /// # Errors
    /// [`Error::Work`] if the adapter cannot be used.
    pub fn new() -> Result<Renderer> {
        Renderer::open(GpuOptions::default())
    }

    /// Opens an adapter by a part of its name, ignoring case.
    ///
    /// # Errors
    /// [`Error::Input`] without such an adapter, [`Error::Work`] if it cannot be used.
    pub fn on(adapter: impl Into<String>) -> Result<Renderer> {
        let options = GpuOptions { adapter: Some(adapter.into()), ..GpuOptions::default() };
        Renderer::open(options)
    }

    /// The reference: f64 on the CPU, slow.
    pub fn reference() -> Renderer {
        Renderer { engine: None, options: GpuOptions::default(), is_reference: true, kept: Kept::default() }
    }

    fn open(options: GpuOptions) -> Result<Renderer> {
        let engine = Engine::open(&options)?;
        Ok(Renderer { engine, options, is_reference: false, kept: Kept::default() })
    }

    /// Opens the adapter again. Nothing is on it then: what the next image needs is sent anew. A renderer whose device has failed, as for want of
    /// memory, does so by itself at its next image.
    ///
    /// # Errors
    /// [`Error::Work`] if the adapter cannot be used any more.
    pub fn reopen(&mut self) -> Result<()> {
        let Some(engine) = &self.engine else { return Ok(()) };
        // its memory is free before more is taken
        self.kept = Kept::default();
        let gone = || Error::work(format!("adapter {}: it is not there any more", engine.gpu.info.name));
        let opened = Engine::open(&self.options)?.ok_or_else(gone)?;
        self.engine = Some(opened);
        Ok(())
    }

    /// Opens the adapter again if its device has failed.
    pub(super) fn recover(&mut self) -> Result<()> {
        let has_failed = self.engine.as_ref().is_some_and(|engine| engine.gpu.failure().is_err());
        if has_failed { self.reopen() } else { Ok(()) }
    }

    /// The adapter's name; `None` for the reference.
    pub fn adapter(&self) -> Option<&str> {
        self.engine.as_ref().map(|engine| engine.gpu.info.name.as_str())
    }

    /// Renders `scene` through `camera`.
    ///
    /// # Errors
    /// [`Error::Input`] if the scene, the camera and the options cannot be combined (`docs/reference/limits.md`), [`Error::Work`] if memory
    /// does not suffice or the device is lost.
    pub fn render(&mut self, scene: &Scene, camera: &Camera, options: &RenderOptions) -> Result<Rendered> {
        let started = Instant::now();
        let wanted = options.wanted()?;
        let compile_ms = camera.compile_ms.take();
        let (scene, camera) = (&scene.scene, &camera.camera);
        check_memory((camera.width, camera.height), wanted.channels.len() + 3, 0, options.limits)?;
        self.recover()?;
        let mut rendered = self.render_frame(scene, camera, &wanted)?;
        rendered.call.camera = compile_ms;
        rendered.call.total = compile_ms + ms_since(started);
        let device = Backend::device_of(self.engine.as_ref(), &RenderJob::of(""));
        let mut report = Report::new(device, scene, camera, &rendered, None);
        report.samples = options.samples;
        Ok(Rendered { frame: rendered.frame, rgba: rendered.srgb8, report })
    }

    /// Renders an image.
    pub(super) fn render_frame(
        &mut self,
        scene: &crate::scene::Scene,
        camera: &Arc<Rays>,
        wanted: &Wanted,
    ) -> Result<engine::Rendered> {
        self.kept.render(self.engine.as_mut(), scene, camera, wanted)
    }

    pub(super) fn backend(&mut self, job: &RenderJob) -> Result<Backend<'_>> {
        if self.is_reference && !matches!(job.engine, None | Some(EngineName::Reference)) {
            return Err(Error::input("the renderer is the reference; open one on an adapter for other engines"));
        }
        Backend::of(self.engine.as_mut(), job)
    }
}

/// Renders by the reference, in f64 on the CPU: slow, and correct by definition.
pub fn reference(scene: &Scene, camera: &Camera, channels: &[Channel]) -> Frame {
    crate::reference::image::image(&scene.scene, &camera.camera, channels)
}

/// Compares a frame with the reference. [`Comparison::wrong_safe`] counts the wrong pixels among the safe ones, whose answer is the same
/// within 1/16 px of their centre.
///
/// # Errors
/// [`Error::Input`] if the frame and the camera differ in size.
pub fn check(scene: &Scene, camera: &Camera, frame: &Frame) -> Result<Comparison> {
    let (width, height) = (camera.width(), camera.height());
    if (frame.width, frame.height) != (width, height) {
        let of_frame = format!("{}x{}", frame.width, frame.height);
        return Err(Error::input(format!("the frame has {of_frame} pixels, the camera {width}x{height}")));
    }
    let truth = crate::reference::image::judge(&scene.scene, &camera.camera, frame);
    compare(frame, &truth.truth, Some(&truth.safe), Some(&truth.scales))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_device_that_failed_is_opened_again() {
        let scene = "image = { width = 8, height = 6 }\nmesh = [{ builtin = \"box\" }]\n\
                     camera = { kind = \"pinhole\", eye = [0, 0, 4], target = [0, 0, 0], vfov = 40 }";
        let scene = Scene::parse(scene, ".").unwrap();
        let camera = scene.camera().unwrap();
        let mut renderer = Renderer::new().unwrap();
        let options = RenderOptions { channels: vec![Channel::T], ..RenderOptions::default() };
        let first = renderer.render(&scene, &camera, &options).unwrap().frame;
        let Some(engine) = &renderer.engine else { return };
        engine.gpu.failed("its memory is full".into());
        assert!(engine.gpu.failure().is_err());
        assert_eq!(renderer.render(&scene, &camera, &options).unwrap().frame, first);
        assert!(renderer.engine.as_ref().is_some_and(|engine| engine.gpu.failure().is_ok()));
        renderer.reopen().unwrap();
        assert_eq!(renderer.render_many(&scene, &[camera], &options).unwrap().planes, first.planes);
    }
    #[test]
    fn a_call_counts_its_parts_and_each_camera_once() {
        let scene = Scene::parse(
            "mesh = [{ builtin = \"box\" }]\ncamera = { kind = \"panorama\", radius = 4, height = 3 }",
            ".",
        )
        .unwrap();
        let fisheye = "kind = 'fisheye'\nfov = 120\neye = [0, 0, 4]\ntarget = [0, 0, 0]";
        let camera = Camera::parse(fisheye, ".", &scene, Some((64, 48))).unwrap();
        let mut renderer = Renderer::new().unwrap();
        let options = RenderOptions { channels: vec![Channel::T], ..RenderOptions::default() };
        let mut call = || {
            let rendered = renderer.render(&scene, &camera, &options).unwrap();
            let parts: Vec<(&str, f64)> = rendered.call_parts_ms().collect();
            let sum: f64 = parts.iter().map(|(_, ms)| ms).sum();
            assert!(0.0 < sum && sum <= rendered.call_ms(), "{parts:?}");
            assert!(rendered.frame_ms() <= rendered.call_ms());
            move |name: &str| parts.iter().find(|part| part.0 == name).unwrap().1
        };
        let [first, again] = [call(), call()];
        assert!(first("camera") > 0.0 && first("wait") > 0.0 && again("wait") > 0.0);
        assert_eq!(again("camera"), 0.0);
    }
}

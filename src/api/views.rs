//! Many images at once.

use super::renderer::{RenderOptions, Renderer};
use super::{Camera, Scene};
use crate::camera::stacked::{can_stack, stack};
use crate::camera::{Camera as Rays, Rays as LayerRays};
use crate::engine::call_ms::{CallMs, ms_since};
use crate::engine::left_out::LeftOut;
use crate::engine::plan::Wanted;
use crate::engine::report::{FrameMs, Report};
use crate::engine::sequence::Sequence;
use crate::engine::{Rendered, RunOptions};
use crate::image::frame::{Channel, Plane};
use crate::image::size::MAX_PIXELS;
use crate::input::{Error, Result};
use crate::jobs::{Backend, RenderJob, memory_need as need, render_each};
use std::sync::Arc;
use std::time::Instant;

/// Images of one size, each by its own camera: [`Renderer::render_many`].
#[derive(Debug, Clone)]
pub struct Views {
    /// Number of images.
    pub count: usize,
    /// Of each image, pixels.
    pub width: u32,
    /// Of each image, pixels.
    pub height: u32,
    /// Of each channel the values of all images, one image after another, each row by row from the top.
    pub planes: Vec<(Channel, Plane)>,
    /// 8-bit sRGB, four bytes (RGBA) per pixel, in the same order; `None` without [`RenderOptions::color`].
    pub rgba: Option<Vec<u8>>,
    report: Report,
}

impl Views {
    /// Times and counts, as JSON: those of [`super::Rendered::report`] with the times of all frames that the images took; stages and passes are
    /// the last frame's. `left_out` says why these were not one, where they could not be.
    pub fn report(&self) -> String {
        serde_json::to_string_pretty(&self.report).unwrap_or_default()
    }
}

/// Most samples of the pixels of a frame of several images: more no longer make a frame cheaper per pixel.
const FRAME_SAMPLES_MAX: u64 = 1 << 22;

/// Most samples of an image of a ray for each pixel that shares a frame with others. The rays of such a frame are computed and sent as a table,
/// whose cost grows with the image: up to 128 x 128 pixels a frame of several fisheyes is faster than a frame for each on most scenes, above
/// that slower on small ones. Images of pieces gain at all sizes that were measured (`bench_results/lab.md`, Many images in one frame).
const FIELD_SAMPLES_MAX: u64 = 1 << 14;

/// A frame to render: one image, or several below each other.
struct Job<'a> {
    cameras: &'a [Arc<Rays>],
    /// How many images its frame has: frames of one size stay in the same buffers.
    images: usize,
    /// Rows from each to the next.
    step: u32,
}

impl Job<'_> {
    fn camera(&self) -> Arc<Rays> {
        let mut cameras = self.cameras.to_vec();
        match cameras.last().cloned() {
            Some(last) if self.images > 1 => {
                // its last camera fills the frame
                cameras.resize(self.images, last);
                stack(&cameras).camera
            }
            _ => cameras.swap_remove(0),
        }
    }
}

impl Renderer {
    /// Renders an image through each camera, all in one frame where they fit and where that is faster than a frame for each: up to
    /// four times as fast for 64 x 64 pixels, and as fast for 512 x 512.
    ///
    /// Triangles and pieces are those of [`Renderer::render`]; `t` and `Z` may differ in the last bit, and `certified` where a bound is close.
    /// Positions, normals, texture coordinates and colours are rounded relative to where the camera in the middle is: they may be off by some
    /// 2^-24 of the distance from there. Heights are rounded up to whole tiles of 8 pixels, those of cameras with a ray for each pixel after
    /// two more rows. Mirrors, lenses, curved rays, layers, different ranges of t, cameras of pieces beside cameras of a ray for each
    /// pixel, unrelated rays, caustics, lines between pixels, things that move while an image is taken, and samples that do not fit one
    /// frame take a frame for each image, as do images of more than 2^14 samples by cameras with a ray for each pixel, which are faster
    /// so; the report then says why.
    ///
    /// # Errors
    /// Those of [`Renderer::render`]; [`Error::Input`] without a camera, or if their images differ in size.
    pub fn render_many(&mut self, scene: &Scene, cameras: &[Camera], options: &RenderOptions) -> Result<Views> {
        let started = Instant::now();
        let wanted = options.wanted()?;
        let Some(first) = cameras.first() else { return Err(Error::input("there is no camera; give one or more")) };
        let (width, height) = (first.width(), first.height());
        if let Some((k, other)) = cameras.iter().enumerate().find(|(_, c)| (c.width(), c.height()) != (width, height)) {
            let sizes = format!("camera {k} is {}x{}, camera 0 {width}x{height}", other.width(), other.height());
            return Err(Error::input(format!("{sizes}; all images need one size")));
        }
        let pixels = u64::from(width) * u64::from(height) * cameras.len() as u64;
        if pixels > MAX_PIXELS {
            let count = cameras.len();
            return Err(Error::input(format!(
                "{count} images of {width}x{height} are over the limit of {MAX_PIXELS} pixels in all; render fewer at once"
            )));
        }
        let what = format!("{} images of {width} x {height}", cameras.len());
        let bytes = need((width, height), wanted.channels.len() + 3, 0) * cameras.len() as u64;
        options.limits.check_memory(bytes, what, "render fewer at once")?;
        self.recover()?;
        let camera_ms = cameras.iter().map(|camera| camera.compile_ms.take()).sum();
        let cameras: Vec<Arc<Rays>> = cameras.iter().map(|camera| camera.camera.clone()).collect();
        let (jobs, why) = match self.stacked(scene, &cameras, &wanted) {
            Ok(jobs) => (jobs, None),
            Err(why) => {
                let job = |camera| Job { cameras: camera, images: 1, step: height };
                (cameras.chunks(1).map(job).collect(), Some(why))
            }
        };
        let mut views = Gathered {
            pixels: width as usize * height as usize,
            width: width as usize,
            planes: Vec::new(),
            rgba: None,
            frame_ms: Vec::new(),
            call: CallMs::default(),
            last: None,
        };
        // one image stands for all of a frame
        if self.engine.is_some() && cameras.iter().all(|camera| Sequence::takes(&scene.scene, camera, &wanted)) {
            self.in_flight(scene, &jobs, &wanted, &mut views)?;
        } else {
            for job in &jobs {
                views.add(job, self.render_frame(&scene.scene, &job.camera(), &wanted)?);
            }
        }
        let Gathered { planes, rgba, frame_ms, call, last, .. } = views;
        let last = last.ok_or_else(|| Error::work("no frame was rendered"))?;
        let device = Backend::device_of(self.engine.as_ref(), &RenderJob::of(""));
        let mut report = Report::new(device, &scene.scene, &cameras[0], &last, None);
        report.views = Some(cameras.len());
        report.samples = options.samples;
        report.call_ms = CallMs { camera: camera_ms, total: camera_ms + ms_since(started), ..call };
        report.frame_ms = FrameMs::of(&frame_ms);
        report.left_out.extend(why.filter(|_| cameras.len() > 1).map(LeftOut::OneFrame));
        report.unmet = cameras.iter().flat_map(|camera| camera.unfulfilled.iter().cloned()).collect();
        report.unmet.sort();
        report.unmet.dedup();
        Ok(Views { count: cameras.len(), width, height, planes, rgba, report })
    }

    /// The images in as few frames as they fit; `Err`: why they need a frame each.
    fn stacked<'a>(
        &self,
        scene: &Scene,
        cameras: &'a [Arc<Rays>],
        wanted: &Wanted,
    ) -> std::result::Result<Vec<Job<'a>>, &'static str> {
        if self.engine.is_none() {
            return Err("the reference renders them");
        }
        if scene.scene.style.line_reach() > 0 && wanted.has_colour() {
            return Err("lines are drawn between pixels");
        }
        if scene.scene.steps.is_some() {
            return Err("things move while an image is taken");
        }
        can_stack(cameras)?;
        // of those that can be stacked the first stands for all
        if !Sequence::takes(&scene.scene, &cameras[0], wanted) {
            return Err("the scene or the samples need frames of their own");
        }
        let in_image = u64::from(cameras[0].width) * u64::from(cameras[0].height) * u64::from(wanted.samples.max(1));
        if in_image > FIELD_SAMPLES_MAX && matches!(cameras[0].layers[..], [LayerRays::Field(_)]) {
            return Err("a frame for each is faster at this size, as each pixel has a ray of its own");
        }
        let step = stack(&cameras[..1]).step;
        let pixels = u64::from(step) * u64::from(cameras[0].width) * u64::from(wanted.samples.max(1));
        let frames = (pixels * cameras.len() as u64).div_ceil(FRAME_SAMPLES_MAX) as usize;
        let each = cameras.len().div_ceil(frames);
        Ok(cameras.chunks(each).map(|own| Job { cameras: own, images: each, step }).collect())
    }

    /// Renders frames one after another; each is planned while the device renders the one before.
    fn in_flight(&mut self, scene: &Scene, jobs: &[Job], wanted: &Wanted, views: &mut Gathered) -> Result<()> {
        // what fails in the middle is not there for the next call
        let mut sequence = std::mem::take(&mut self.kept.sequence);
        let (Some(engine), run) = (&mut self.engine, RunOptions::default()) else { return Ok(()) };
        let (planner, last) = (engine.planner(), &mut self.kept.last);
        let mut until = Instant::now();
        let frames = jobs.iter().map(|job| {
            let camera = job.camera();
            planner.check_size(&camera, wanted)?;
            let planned = planner.plan(&scene.scene, camera, wanted, &run, last.as_ref())?;
            *last = Some(planned.clone());
            Ok((job, planned))
        });
        render_each((engine, &mut sequence), &run, frames, |job, readback| {
            let rendered = readback.rendered();
            let ms = ms_since(until);
            until = Instant::now();
            views.add(job, Rendered { frame_ms: vec![ms], ..rendered });
            Ok(true)
        })?;
        self.kept.sequence = sequence;
        Ok(())
    }
}

/// The images so far.
struct Gathered {
    /// Pixels of an image, and of a row.
    pixels: usize,
    width: usize,
    planes: Vec<(Channel, Plane)>,
    rgba: Option<Vec<u8>>,
    frame_ms: Vec<f64>,
    /// Sums of the parts of all frames.
    call: CallMs,
    /// Of the last frame all but its picture.
    last: Option<Rendered>,
}

impl Gathered {
    /// Adds the images of a frame.
    fn add(&mut self, job: &Job, mut rendered: Rendered) {
        let planes = std::mem::take(&mut rendered.frame.planes);
        if self.planes.is_empty() {
            let none = |plane: &Plane| match plane {
                Plane::F32(_) => Plane::F32(Vec::new()),
                Plane::U32(_) => Plane::U32(Vec::new()),
            };
            self.planes = planes.iter().map(|(channel, plane)| (*channel, none(plane))).collect();
        }
        for ((_, all), (_, own)) in self.planes.iter_mut().zip(planes) {
            match (all, own) {
                (Plane::F32(all), Plane::F32(own)) => append(all, own, job, [self.pixels, self.width]),
                (Plane::U32(all), Plane::U32(own)) => append(all, own, job, [self.pixels, self.width]),
                _ => {}
            }
        }
        if let Some(rgba) = rendered.srgb8.take() {
            append(self.rgba.get_or_insert_default(), rgba, job, [4 * self.pixels, 4 * self.width]);
        }
        self.frame_ms.append(&mut rendered.frame_ms);
        self.call += rendered.call;
        self.last = Some(rendered);
    }
}

/// Appends a frame's images, of which one and one of its rows have so many values.
fn append<T: Copy>(all: &mut Vec<T>, frame: Vec<T>, job: &Job, [image, row]: [usize; 2]) {
    if all.is_empty() && frame.len() == job.cameras.len() * image {
        *all = frame;
        return;
    }
    for k in 0..job.cameras.len() {
        let top = k * job.step as usize * row;
        all.extend_from_slice(&frame[top..top + image]);
    }
}

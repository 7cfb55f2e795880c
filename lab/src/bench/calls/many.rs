//! Many small images by one call: of `Renderer::render_many`, and of a batch that writes them as EXR.

use super::path::Pose;
use super::{CHANNELS, City, Plan, memory};
use crate::bench::row::{Calls, Error, Row};
use crate::bench::times::Times;
use anamorph::internals::image::write_text;
use anamorph::{Batch, BatchEvent, BatchOptions, Camera, Frame, Plane, Renderer, Result, Views, check};
use std::ops::Range;
use std::path::Path;
use std::sync::Mutex;
use std::time::Instant;

/// Timed calls.
const CALLS: u32 = 3;

/// All images by `Renderer::render_many`, with the cameras' parsing in the time.
pub fn views(plan: &Plan, adapter: &str, city: &City, folder: &Path, row: Row) -> Result<Row> {
    let mut renderer = Renderer::on(adapter)?;
    let mut all = Vec::new();
    let mut frames = Vec::new();
    memory::forget_peak();
    let mut first_ms = None;
    let mut last = None;
    for _ in 0..=CALLS {
        let started = Instant::now();
        let cameras = (0..plan.poses).map(|pose| plan.camera(pose, city, folder)).collect::<Result<Vec<Camera>>>()?;
        let views = renderer.render_many(&city.scene, &cameras, &Plan::options())?;
        let ms = started.elapsed().as_secs_f64() * 1e3;
        match first_ms {
            None => first_ms = Some(ms),
            Some(_) => {
                all.push(ms);
                frames.push(frames_ms(&views));
            }
        }
        last = Some((cameras, views));
    }
    let peak_bytes = memory::peak_bytes();
    let mut errors = Vec::new();
    if let Some((cameras, views)) = &last {
        for pose in plan.checked() {
            let k = pose as usize;
            errors.push(Error::of(&check(&city.scene, &cameras[k], &image_of(views, k))?));
        }
    }
    let calls = Calls { images: plan.poses, first_ms, peak_bytes, ..Calls::of(&all, &frames) };
    Ok(Row { times: Some(Times::of(&frames)), calls: Some(calls), error: Error::over(&errors), ..row })
}

/// The time of all frames of a call, ms.
fn frames_ms(views: &Views) -> f64 {
    let report: serde_json::Value = serde_json::from_str(&views.report()).unwrap_or_default();
    let all = report["frame_ms"]["all"].as_array().cloned().unwrap_or_default();
    all.iter().filter_map(serde_json::Value::as_f64).sum()
}

/// One of several images.
fn image_of(views: &Views, k: usize) -> Frame {
    let pixels = views.width as usize * views.height as usize;
    let own: Range<usize> = k * pixels..(k + 1) * pixels;
    let plane = |plane: &Plane| match plane {
        Plane::F32(all) => Plane::F32(all[own.clone()].to_vec()),
        Plane::U32(all) => Plane::U32(all[own.clone()].to_vec()),
    };
    let planes = views.planes.iter().map(|(channel, values)| (*channel, plane(values))).collect();
    Frame { width: views.width, height: views.height, planes }
}

/// All images by a batch that opens its adapter, reads the scene of each frame and writes an EXR for each.
pub fn batch(plan: &Plan, adapter: &str, folder: &Path, row: Row) -> Result<Row> {
    write_text(&folder.join("scene.toml"), &scene(plan))?;
    let names: Vec<&str> = CHANNELS.iter().map(|channel| channel.name()).collect();
    let (width, height) = plan.size;
    let list = format!(
        "[[job]]\nscene = \"scene.toml\"\nexr = \"{{frame:04}}.exr\"\nframes = {{ first = 0, last = {} }}\n\
         size = \"{width}x{height}\"\nchannels = [\"{}\"]\n",
        plan.poses - 1,
        names.join("\", \"")
    );
    let path = folder.join("jobs.toml");
    write_text(&path, &list)?;
    let options = BatchOptions { adapters: Some(vec![adapter.to_owned()]), ..BatchOptions::default() };
    let (mut all, mut frames) = (Vec::new(), Vec::new());
    memory::forget_peak();
    for _ in 0..CALLS {
        let (done_ms, failed) = (Mutex::new(0.0), Mutex::new(None));
        let started = Instant::now();
        Batch::new(&path).run(&options, &|event, _| match event {
            BatchEvent::Done(_, ms) => *done_ms.lock().unwrap_or_else(|e| e.into_inner()) += ms,
            BatchEvent::Failed(_, why) => *failed.lock().unwrap_or_else(|e| e.into_inner()) = Some(why.clone()),
            _ => {}
        })?;
        all.push(started.elapsed().as_secs_f64() * 1e3);
        if let Some(why) = failed.into_inner().unwrap_or_else(|e| e.into_inner()) {
            return Err(why);
        }
        frames.push(done_ms.into_inner().unwrap_or_else(|e| e.into_inner()));
    }
    let calls = Calls { images: plan.poses, peak_bytes: memory::peak_bytes(), ..Calls::of(&all, &frames) };
    Ok(Row { times: Some(Times::of(&frames)), calls: Some(calls), ..row })
}

/// The scene whose camera goes along the path from frame to frame.
fn scene(plan: &Plan) -> String {
    let eyes: Vec<String> = (0..plan.poses).map(|k| Pose::of(k, plan.poses).eye_at(k)).collect();
    format!(
        "{}[camera]\nkind = \"pinhole\"\nvfov = 60\ntarget = [0, 2, 0]\neye = [{}]\n",
        super::city::meshes(plan.motion, plan.triangles),
        eyes.join(", ")
    )
}

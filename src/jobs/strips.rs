//! Images too large for memory are rendered strip by strip. While one strip is planned, the previous one is rendered and the one
//! before that is written.

use super::files::attributes;
use super::job::RenderJob;
use super::render_each;
use crate::camera::Camera;
use crate::engine::call_ms::ms_since;
use crate::engine::plan::{Rows, Wanted};
use crate::engine::planned::{Planned, Planner};
use crate::engine::readback::Readback;
use crate::engine::sequence::Sequence;
use crate::engine::{Engine, Rendered, RunOptions};
use crate::image::frame::{Channel, Frame};
use crate::image::{EXR_TILE, rgb8, write_exr_tiled, write_png_strips};
use crate::input::{Error, Result};
use crate::scene::Scene;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::time::Instant;

/// Images that take more memory are rendered in strips.
pub const WHOLE_MAX: u64 = 1 << 30;

/// Memory of one strip; about four are in flight at once.
const STRIP_BYTES: u64 = 256 << 20;

/// A render in strips, and its output files.
pub struct Strips<'a> {
    pub scene: &'a Scene,
    pub camera: &'a Arc<Camera>,
    /// The channels of the EXR, and no more.
    pub wanted: &'a Wanted,
    pub run: RunOptions,
    /// Memory of a row of the image, bytes.
    pub row_bytes: u64,
    /// Names the files of colour and of the channels.
    pub job: &'a RenderJob,
}

impl Strips<'_> {
    /// Renders and writes the files; returns times and counts, without pixels.
    ///
    /// # Errors
    /// Those of the engine, and of the files.
    pub fn render(&self, engine: &mut Engine) -> Result<Rendered> {
        let started = Instant::now();
        let planner = engine.planner();
        let took = std::thread::scope(|scope| {
            let (to_render, planned) = sync_channel(1);
            let (to_write, readback) = sync_channel(1);
            scope.spawn(move || self.plan(&planner, &to_render));
            let writer = scope.spawn(move || self.write(&readback));
            let rendered = self.draw(engine, &planned, &to_write);
            // the other threads end with these
            drop((planned, to_write));
            let written = writer.join().unwrap_or_else(|_| Err(Error::work("internal error while writing the image")));
            match (rendered, written) {
                // strips are missing from the files
                (Err(e), _) | (Ok(_), Err(e)) => Err(e),
                (Ok(took), Ok(())) => took.ok_or_else(|| Error::work("no strip was rendered")),
            }
        });
        let frame = Frame { width: self.camera.width, height: self.camera.height, planes: Vec::new() };
        let frame_ms = vec![ms_since(started)];
        Ok(Rendered { frame, frame_ms, ..took? })
    }

    fn rows(&self) -> impl Iterator<Item = Rows> {
        let tiles = (STRIP_BYTES / (self.row_bytes * u64::from(EXR_TILE))).max(1) as u32;
        let (rows, height) = (tiles.saturating_mul(EXR_TILE).min(self.camera.height), self.camera.height);
        (0..height).step_by(rows as usize).map(move |first| Rows { first, count: rows.min(height - first) })
    }

    fn plan(&self, planner: &Planner, to_render: &SyncSender<Result<Planned>>) {
        let mut last: Option<Planned> = None;
        for rows in self.rows() {
            let wanted = Wanted { rows: Some(rows), ..self.wanted.clone() };
            let planned = planner.plan(self.scene, self.camera.clone(), &wanted, &self.run, last.as_ref());
            last = planned.as_ref().ok().cloned();
            if to_render.send(planned).is_err() || last.is_none() {
                return;
            }
        }
    }

    /// `None` if the writer has stopped.
    fn draw(
        &self,
        engine: &mut Engine,
        planned: &Receiver<Result<Planned>>,
        to_write: &SyncSender<Readback>,
    ) -> Result<Option<Rendered>> {
        let strip = self.run.share.part_of(self.rows().count());
        let (mut took, mut is_written): (Option<Rendered>, bool) = (None, true);
        let frames = planned.iter().map(|planned| Ok(((), planned?)));
        render_each((engine, &mut Sequence::default()), &self.run, frames, |(), readback| {
            strip.add();
            match &mut took {
                Some(took) => took.add_costs(readback.statistics()),
                None => took = Some(readback.statistics().clone()),
            }
            is_written = to_write.send(readback).is_ok();
            Ok(is_written)
        })?;
        Ok(took.filter(|_| is_written))
    }

    fn write(&self, readback: &Receiver<Readback>) -> Result<()> {
        let size = (self.camera.width, self.camera.height);
        let missing = || Error::work("a strip of the image is missing");
        std::thread::scope(|scope| {
            let (to_color, rows) = sync_channel(1);
            let write = |path| scope.spawn(move || write_png_strips(path, size, || rows.recv().map_err(|_| missing())));
            let color = self.job.color.as_deref().map(write);
            let mut is_refused = false;
            let mut next = || {
                let Rendered { frame, srgb8, .. } = readback.recv().map_err(|_| missing())?.rendered();
                if let Some(rgba) = srgb8.filter(|_| color.is_some()) {
                    is_refused = to_color.send(rgb8(&rgba)).is_err();
                    if is_refused {
                        return Err(missing());
                    }
                }
                Ok(frame)
            };
            let channels: &[Channel] = &self.wanted.channels;
            let written = match &self.job.exr {
                Some(path) => attributes(path, self.scene, self.camera, channels)
                    .and_then(|attributes| write_exr_tiled(path, size, channels, &attributes, &mut next)),
                None => self.rows().map(|_| next()).try_for_each(|frame| frame.map(drop)),
            };
            // who writes colour ends with these
            drop(to_color);
            let colored = color.map_or(Ok(()), |color| {
                color.join().unwrap_or_else(|_| Err(Error::work("internal error while writing the image")))
            });
            // report the file that failed, not the other one, which then lacks strips
            if is_refused || written.is_ok() { colored.and(written) } else { written }
        })
    }
}

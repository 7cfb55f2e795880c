//! In-flight frames, and assembling images from what was read back.

use super::Rendered;
use super::call_ms::ms_since;
use super::planned::Planned;
use super::running::Running;
use crate::camera::Camera;
use crate::camera::ray_order::restored;
use crate::engine::plan::{Plan, Wanted};
use crate::gpu::Gpu;
use crate::gpu::draw_counts::DrawCounts;
use crate::gpu::readback::{Mapped, PendingRead, joined};
use crate::image::frame::{Channel, Frame, NO_ID, Plane, normalised_depth};
use crate::input::Result;
use crate::parallel;
use crate::scene::labels::Labels;
use std::sync::Arc;
use std::time::Instant;

/// Everything needed to turn read-back words into a `Frame`.
#[derive(Clone)]
pub(super) struct FrameLayout {
    pub camera: Arc<Camera>,
    pub plan: Arc<Plan>,
    pub wanted: Wanted,
    /// The scene's labels, if they are wanted.
    pub labels: Option<Labels>,
    /// Near and far of normalised depth.
    pub depth_range: Option<[f64; 2]>,
}

/// A frame that was given to the device. Others may be given to it before this one is done.
pub struct InFlight {
    pub(super) planned: Planned,
    pub(super) running: Running,
    pub(super) reads: PendingReads,
    pub(super) frame_layout: FrameLayout,
    pub started: Instant,
}

/// A frame as read back, before planes are unpacked.
pub struct Readback {
    pub(super) frame_layout: FrameLayout,
    pub(super) raw: RawFrame,
    /// Its statistics; no picture.
    pub(super) rest: Rendered,
}

/// Buffers that the host can read: a frame's counters by job, and its image by band where it is read.
pub(super) struct Copies {
    pub status: wgpu::Buffer,
    /// Those of [`is_read`].
    pub planes: Vec<wgpu::Buffer>,
    pub srgb8: Vec<wgpu::Buffer>,
    /// Records of the edge pixels, and what their samples see: where that is asked for.
    pub edge_of: Vec<wgpu::Buffer>,
    pub samples: Vec<wgpu::Buffer>,
}

impl Copies {
    /// No image yet.
    pub fn new(status: wgpu::Buffer) -> Copies {
        Copies { status, planes: Vec::new(), srgb8: Vec::new(), edge_of: Vec::new(), samples: Vec::new() }
    }
}

/// Everything of a frame that is being read.
pub(super) struct PendingReads {
    status: PendingRead,
    /// Those of [`is_read`].
    planes: Vec<PendingRead>,
    srgb8: Vec<PendingRead>,
    edge_of: Vec<PendingRead>,
    samples: Vec<PendingRead>,
    times: Option<PendingRead>,
    draws: Option<PendingRead>,
}

/// And what was read: counters by job, and words by band.
pub(super) struct RawFrame {
    pub status: Vec<u32>,
    pub planes: Vec<Mapped>,
    pub srgb8: Vec<Mapped>,
    pub edge_of: Vec<Vec<u32>>,
    pub samples: Vec<Vec<u32>>,
    pub stages: Vec<(&'static str, f64)>,
    /// Of a rival that draws, if that is counted.
    pub draws: Option<DrawCounts>,
}

/// A plane is brought to the host.
pub(super) fn is_read(wanted: &Wanted, channel: Channel) -> bool {
    let needs_ids = wanted.sample_ids || wanted.has_labels();
    wanted.channels.contains(&channel)
        || needs_ids && channel == Channel::TriangleId
        || wanted.has_normalised_depth() && channel == Channel::Z
}

impl PendingReads {
    /// Of a frame that runs.
    pub fn start(frame: &Running) -> PendingReads {
        let copies = &frame.copies;
        let all = |buffers: &[wgpu::Buffer]| buffers.iter().map(PendingRead::start).collect();
        PendingReads {
            status: PendingRead::start(&copies.status),
            planes: all(&copies.planes),
            srgb8: all(&copies.srgb8),
            edge_of: all(&copies.edge_of),
            samples: all(&copies.samples),
            times: frame.recorded.read(),
            draws: frame.recorded.read_draws(),
        }
    }

    /// Once it is done.
    pub fn finish(self, gpu: &Gpu, frame: &Running) -> Result<RawFrame> {
        let all = |reads: Vec<PendingRead>| reads.into_iter().map(|r| r.words(gpu)).collect::<Result<Vec<_>>>();
        let mapped = |reads: Vec<PendingRead>| reads.into_iter().map(|r| r.mapped(gpu)).collect::<Result<Vec<_>>>();
        Ok(RawFrame {
            status: self.status.words(gpu)?,
            planes: mapped(self.planes)?,
            srgb8: mapped(self.srgb8)?,
            edge_of: all(self.edge_of)?,
            samples: all(self.samples)?,
            stages: frame.recorded.stages_read(gpu, self.times)?,
            draws: frame.recorded.draws_read(gpu, self.draws)?,
        })
    }
}

impl Readback {
    /// Its statistics; no picture.
    pub fn statistics(&self) -> &Rendered {
        &self.rest
    }

    /// The frame with its picture.
    pub fn rendered(self) -> Rendered {
        let started = Instant::now();
        let Readback { frame_layout, raw, mut rest } = self;
        let srgb8 = frame_layout.wanted.srgb8.then(|| frame_layout.srgb8(&raw));
        let (frame, sample_ids) = (frame_layout.frame(&raw), frame_layout.sample_ids(&raw));
        rest.call.read_back += ms_since(started);
        Rendered { frame, sample_ids, srgb8, ..rest }
    }
}

impl FrameLayout {
    /// Joins the planes of all bands to the wanted channels of one frame, their pixels in the camera's own order.
    fn frame(&self, raw: &RawFrame) -> Frame {
        let FrameLayout { camera, plan, wanted, .. } = self;
        let mut planes = Vec::new();
        let read = plan.planes.iter().copied().filter(|channel| is_read(wanted, *channel));
        for (k, channel) in read.enumerate() {
            let is_of_labels = channel == Channel::TriangleId && self.labels.is_some();
            let is_of_depth = channel == Channel::Z && wanted.has_normalised_depth();
            if !wanted.channels.contains(&channel) && !is_of_labels && !is_of_depth {
                continue;
            }
            let plane = match channel.is_id() {
                true => {
                    let mut ids = self.restored(joined(&self.parts(&raw.planes, k)));
                    if channel == Channel::PieceId && camera.composition.is_some() {
                        self.number_pieces(&mut ids);
                    }
                    Plane::U32(ids)
                }
                false => Plane::F32(self.restored(joined(&self.parts(&raw.planes, k)))),
            };
            planes.push((channel, plane));
        }
        self.add_depths(&mut planes);
        self.label(&mut planes);
        planes.retain(|(channel, _)| wanted.channels.contains(channel));
        planes.sort_by_key(|(channel, _)| *channel);
        Frame { width: camera.width, height: plan.rows(), planes }
    }

    /// The values of every band in its `k`-th plane.
    fn parts<'a, T: bytemuck::Pod>(&self, bands: &'a [Mapped], k: usize) -> Vec<&'a [T]> {
        let width = self.camera.width;
        let shown = self.plan.bands.iter().map(|band| band.shown_in_plane(k, width));
        bands.iter().zip(shown).map(|(band, pixels)| band.values(pixels)).collect()
    }

    /// Pieces of a composite are its cameras.
    fn number_pieces(&self, pieces: &mut [u32]) {
        let (width, first) = (self.camera.width, self.wanted.rows.map_or(0, |rows| rows.first));
        parallel::for_each_mut(pieces, |k, piece| {
            // an image has fewer than 2^32 pixels
            let k = k as u32;
            *piece = self.camera.piece_number(*piece, (k % width, first + k / width));
        });
    }

    /// Adds the label planes, computed from the triangle ids.
    fn label(&self, planes: &mut Vec<(Channel, Plane)>) {
        let ids = planes.iter().find(|(channel, _)| *channel == Channel::TriangleId);
        let (Some(labels), Some((_, Plane::U32(ids)))) = (&self.labels, ids) else { return };
        let of = |channel: &Channel| Some((*channel, Plane::U32(labels.plane(*channel, ids)?)));
        let more: Vec<_> = self.wanted.channels.iter().filter_map(of).collect();
        planes.extend(more);
    }

    /// Adds the planes that follow from Z.
    fn add_depths(&self, planes: &mut Vec<(Channel, Plane)>) {
        let z = planes.iter().find(|(channel, _)| *channel == Channel::Z);
        let (Some(range), Some((_, Plane::F32(z)))) = (self.depth_range, z) else { return };
        let depth = |z: &f32, k: usize| normalised_depth(f64::from(*z), range)[k] as f32;
        let plane = |k: usize| Plane::F32(parallel::map(z.as_slice(), |z| depth(z, k)));
        let wanted = |channel: &Channel| self.wanted.channels.contains(channel);
        let both = [Channel::DepthLinear, Channel::DepthPerspective];
        let more: Vec<_> = both.into_iter().zip(0..).filter(|(c, _)| wanted(c)).map(|(c, k)| (c, plane(k))).collect();
        planes.extend(more);
    }

    /// Four bytes a pixel.
    fn srgb8(&self, raw: &RawFrame) -> Vec<u8> {
        let colors: Vec<[u8; 4]> = joined(&self.parts(&raw.srgb8, 0));
        self.restored(colors).into_flattened()
    }

    /// Triangle ids, one plane per sample. A pixel that is not an edge pixel has the id at its centre in every plane.
    fn sample_ids(&self, raw: &RawFrame) -> Vec<Vec<u32>> {
        let FrameLayout { camera, plan, wanted, .. } = self;
        if !wanted.sample_ids {
            return Vec::new();
        }
        let samples = plan.variant.samples() as usize;
        let mut all = vec![Vec::new(); samples];
        let mut read = plan.planes.iter().filter(|channel| is_read(wanted, **channel));
        let plane = read.position(|c| *c == Channel::TriangleId).unwrap_or_default();
        let id_mask = (1 << plan.id_bits) - 1;
        for (k, (band, planes)) in plan.bands.iter().zip(&raw.planes).enumerate() {
            let centres: &[u32] = planes.values(band.shown_in_plane(plane, camera.width));
            let (Some(edge_of), Some(records)) = (raw.edge_of.get(k), raw.samples.get(k)) else {
                all.iter_mut().for_each(|ids| ids.extend_from_slice(centres));
                continue;
            };
            for (n, ids) in all.iter_mut().enumerate() {
                let id = |(centre, record): (&u32, &u32)| {
                    if *record == 0 {
                        return *centre;
                    }
                    let at = 2 * ((*record as usize - 1) * (samples + 1) + 1 + n);
                    if records[at] == 0 && records[at + 1] == 0 { NO_ID } else { !records[at] & id_mask }
                };
                ids.extend(centres.iter().zip(&edge_of[band.shown_in_plane(0, camera.width)]).map(id));
            }
        }
        all.into_iter().map(|ids| self.restored(ids)).collect()
    }

    fn restored<T: Copy + Default>(&self, values: Vec<T>) -> Vec<T> {
        match &self.camera.pixel_order {
            Some(order) => restored(order, &values),
            None => values,
        }
    }
}

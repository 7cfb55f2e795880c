//! solve: the images of points in the leaves that sift listed, in f32 with bounds.
//!
//! A candidate is proven to hold no image, or images that are each the only one within its bounds; or nothing of it is proven. Pieces are
//! solved, and curves between control surfaces if asked for ([`Solve::with_curves`]); of a layer of other rays nothing is.

use super::dispatch_items;
use super::sift::{Sift, Sifted, Started};
use crate::arrays::MapEach;
use crate::camera::Rays;
use crate::camera::project::Projector;
use crate::engine::plan::solve::SolveTable;
use crate::engine::plan::solve::cells::CellTable;
use crate::gpu::Gpu;
use crate::gpu::buffers::{Buffers, Pipeline};
use crate::gpu::kernels::{Files, Kernel};
use crate::gpu::layout::{NONE, SolveImage, SolveParams, SolvePoint};
use crate::gpu::readback::{read_words, readback};
use crate::input::Result;
use crate::parallel;
use glam::{DVec2, DVec3};
use wgpu::BufferUsages;

/// Implementations of `project/solved`: the images of points are found in pieces or in curves.
pub const PIECES: &[&str] = &["pieces"];
pub const CURVES: &[&str] = &["curves"];

/// Candidates of points in a layer of pieces or curves; no part of a frame.
pub fn kernel(solved: &'static [&'static str]) -> Kernel {
    let implementations = |interface: &str| if interface == "project/solved" { solved } else { &[] };
    Kernel::of(Files::own(), "solve.wgsl", &implementations, &|_| None)
}

/// The kernels, compiled, and a camera's trees and pieces or cells on the device.
pub struct Solve<'g> {
    pub(super) gpu: &'g Gpu,
    pub(super) sift: Sift<'g>,
    /// `None`: not solved.
    layers: Vec<Option<Layer>>,
    size: [u32; 2],
}

struct Layer {
    table: Table,
    pipeline: Pipeline,
    /// `pieces` or `cells`, and `leaves`: written by the host, read by the kernel.
    tables: Buffers,
}

/// What the kernel knows of a layer.
enum Table {
    Pieces(SolveTable),
    Cells(CellTable),
}

/// A chunk that the device is at work on.
pub struct SolveStarted {
    sifted: Started,
    /// Of each layer that is solved: what `solved`, `images` and `counts` come to.
    lists: Vec<Option<[wgpu::Buffer; 3]>>,
}

/// What was found for the points of a chunk.
pub struct Solved {
    sifted: Sifted,
    /// Of each layer that is solved: the status of each slot, and images by point.
    layers: Vec<Option<(Vec<u32>, Vec<SolveImage>)>>,
}

/// Points that tell how many candidates the others have.
const SAMPLE: usize = 2048;

/// Bytes of an image.
const IMAGE_BYTES: u64 = size_of::<SolveImage>() as u64;

impl<'g> Solve<'g> {
    /// For the points of one camera, in pieces; the device holds 64 bytes a node of its trees, and 240 a piece.
    pub fn new(gpu: &'g Gpu, projector: &Projector) -> Result<Solve<'g>> {
        Solve::of(gpu, projector, false)
    }

    /// The same in curves too, for images with errors; 464 bytes for 8 x 8 px and an eighth of t. To the host's own images that is no help:
    /// nearly all of its search is in the leaves that hold them.
    pub fn with_curves(gpu: &'g Gpu, projector: &Projector) -> Result<Solve<'g>> {
        Solve::of(gpu, projector, true)
    }

    fn of(gpu: &'g Gpu, projector: &Projector, has_curves: bool) -> Result<Solve<'g>> {
        let sift = Sift::new(gpu, projector)?;
        let camera = projector.camera();
        let layer = |(rays, tree): (&Rays, _)| {
            let table = match rays {
                Rays::Pieces(pieces) => Table::Pieces(SolveTable::new(camera, pieces, tree)),
                Rays::Curves(curves) if has_curves => Table::Cells(CellTable::new(camera, curves, tree)),
                _ => return Ok(None),
            };
            // a list that no binding holds is the host's
            if table.bytes() as u64 > gpu.binding_limit() || table.is_empty() {
                return Ok(None);
            }
            let mut tables = Buffers::default();
            let (kernel, leaves) = match &table {
                Table::Pieces(table) => {
                    tables.upload(gpu, "pieces", &table.pieces)?;
                    (kernel(PIECES), &table.leaves)
                }
                Table::Cells(table) => {
                    tables.upload(gpu, "cells", &table.cells)?;
                    (kernel(CURVES), &table.leaves)
                }
            };
            tables.upload(gpu, "leaves", leaves)?;
            Ok(Some(Layer { table, pipeline: Pipeline::new(gpu, kernel)?, tables }))
        };
        let layers = camera.layers.iter().zip(projector.trees()).map(layer).collect::<Result<_>>()?;
        Ok(Solve { gpu, sift, layers, size: [camera.width, camera.height] })
    }

    /// Points of a chunk at most.
    pub fn points_most(&self) -> usize {
        self.sift.points_most()
    }

    /// Gives lists as many slots as some of the points need.
    pub fn adapt(&mut self, points: &[DVec3]) -> Result<()> {
        let some: Vec<DVec3> = points.iter().step_by(points.len() / SAMPLE + 1).copied().collect();
        if !some.is_empty() {
            let started = self.sift.start(&some)?;
            self.sift.finish(started)?;
        }
        Ok(())
    }

    /// Sends a chunk of at most [`Solve::points_most`] points on its way.
    pub fn start(&self, points: &[DVec3]) -> Result<SolveStarted> {
        let gpu = self.gpu;
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let mut started = Started { points: points.len(), layers: Vec::new() };
        let mut lists = Vec::new();
        for (layer, (slots, sifted)) in self.sift.encode(&mut encoder, points)?.into_iter().enumerate() {
            started.layers.push((slots, self.sift.copied(&mut encoder, points.len(), slots, &sifted)));
            let chunk = self.encode(&mut encoder, layer, points, slots, &sifted)?;
            let copied = chunk.map(|chunk| {
                ["solved", "images", "counts"].map_each(|name| {
                    // every one of them has been made
                    let bytes = chunk.get(name).map_or(0, wgpu::Buffer::size);
                    let to = readback(gpu, bytes);
                    chunk.get(name).into_iter().for_each(|from| encoder.copy_buffer_to_buffer(from, 0, &to, 0, bytes));
                    to
                })
            });
            lists.push(copied);
        }
        gpu.queue.submit([encoder.finish()]);
        gpu.failure()?;
        Ok(SolveStarted { sifted: started, lists })
    }

    /// Appends the dispatch of a layer's chunk after sift's; its buffers; `None` if the layer is not solved.
    ///
    /// `solved`: a word each slot of a point. `images`: two for each point. `counts`: a word. `wanted`: a bit each point.
    pub(super) fn encode(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        layer: usize,
        points: &[DVec3],
        slots: u32,
        sifted: &Buffers,
    ) -> Result<Option<Buffers>> {
        let gpu = self.gpu;
        let Some(Layer { table, pipeline, tables }) = &self.layers[layer] else { return Ok(None) };
        let mut chunk = Buffers::default();
        let packed: Vec<_> = parallel::map(points, |p| table.point(*p));
        let [t_min, t_max] = table.t_range();
        chunk.upload(gpu, "points", &packed)?;
        let count = points.len() as u64;
        let most = u64::from(Solve::images_most(gpu, points.len()));
        chunk.create(gpu, "solved", 4 * count * u64::from(slots), BufferUsages::empty())?;
        chunk.create(gpu, "images", IMAGE_BYTES * most, BufferUsages::empty())?;
        chunk.create(gpu, "counts", 4, BufferUsages::empty())?;
        chunk.create(gpu, "wanted", 4 * count.div_ceil(32), BufferUsages::empty())?;
        chunk.upload_uniform(
            gpu,
            "solving",
            &SolveParams {
                points: count as u32,
                slots,
                images_most: most as u32,
                pad0: 0,
                t_min,
                t_max,
                width: self.size[0],
                height: self.size[1],
            },
        )?;
        let group = pipeline.bind(gpu, &[&chunk, tables, sifted])?;
        let mut pass =
            encoder.begin_compute_pass(&wgpu::ComputePassDescriptor { label: Some("solve"), timestamp_writes: None });
        pass.set_pipeline(pipeline.raw());
        pass.set_bind_group(0, &group, &[]);
        dispatch_items(gpu, &mut pass, count as u32 * slots);
        drop(pass);
        Ok(Some(chunk))
    }

    /// Images that the list of so many points holds: two each.
    pub(super) fn images_most(gpu: &Gpu, points: usize) -> u32 {
        (2 * points as u64 + 64).min(gpu.binding_limit() / IMAGE_BYTES) as u32
    }

    /// Waits for a chunk.
    pub fn finish(&mut self, started: SolveStarted) -> Result<Solved> {
        let slots: Vec<usize> = started.sifted.layers.iter().map(|(slots, _)| *slots as usize).collect();
        let points = started.sifted.points;
        let mut sifted = self.sift.finish(started.sifted)?;
        let mut layers = Vec::new();
        for (layer, lists) in started.lists.iter().enumerate() {
            let Some([solved, images, counts]) = lists else {
                layers.push(None);
                continue;
            };
            let mut status = read_words(self.gpu, solved)?;
            status.truncate(points * slots[layer]);
            let words = read_words(self.gpu, images)?;
            let count = read_words(self.gpu, counts)?[0] as usize;
            let all: &[SolveImage] = bytemuck::cast_slice(&words);
            let mut images: Vec<SolveImage> =
                all[..count.min(all.len())].iter().filter(|i| i.point < points as u32).copied().collect();
            parallel::sort_by(&mut images, |a, b| {
                (a.point, a.piece).cmp(&(b.point, b.piece)).then(a.t.total_cmp(&b.t))
            });
            // of curves the host's search in a leaf without images may end in an image of the next one, with last bits of its own
            if matches!(&self.layers[layer], Some(Layer { table: Table::Pieces(_), .. })) {
                sifted.keep(layer, |slot| status[slot] != 0);
            }
            layers.push(Some((status, images)));
        }
        Ok(Solved { sifted, layers })
    }

    /// The table of a layer of pieces.
    #[cfg(feature = "internals")]
    pub fn table(&self, layer: usize) -> Option<&SolveTable> {
        match &self.layers[layer].as_ref()?.table {
            Table::Pieces(table) => Some(table),
            Table::Cells(_) => None,
        }
    }

    /// The table of a layer of curves.
    #[cfg(feature = "internals")]
    pub fn cells(&self, layer: usize) -> Option<&CellTable> {
        match &self.layers[layer].as_ref()?.table {
            Table::Pieces(_) => None,
            Table::Cells(table) => Some(table),
        }
    }

    /// Where an image of a layer lies, px, and its piece in the layer; `None` where the layer is not solved.
    pub fn place(&self, layer: usize, image: &SolveImage) -> Option<(DVec2, u32)> {
        match &self.layers[layer].as_ref()?.table {
            Table::Pieces(table) => Some((table.place_px(image), image.piece)),
            // control surfaces in pieces are not solved
            Table::Cells(table) => Some((table.place_px(image), 0)),
        }
    }

    /// The kernels prove images in a layer.
    pub fn solves(&self, layer: usize) -> bool {
        self.layers[layer].is_some()
    }
}

impl Table {
    fn bytes(&self) -> usize {
        match self {
            Table::Pieces(table) => size_of_val(table.pieces.as_slice()),
            Table::Cells(table) => size_of_val(table.cells.as_slice()),
        }
    }

    /// Nothing in it can be solved.
    fn is_empty(&self) -> bool {
        matches!(self, Table::Cells(table) if table.solvable() == 0)
    }

    fn point(&self, point: DVec3) -> SolvePoint {
        match self {
            Table::Pieces(table) => table.point(point),
            Table::Cells(table) => table.point(point),
        }
    }

    fn t_range(&self) -> [f32; 2] {
        match self {
            Table::Pieces(table) => table.t_range,
            Table::Cells(_) => [0.0, 1.0],
        }
    }
}

impl Solved {
    /// The nodes of a layer's tree at or below which the chunk's `point` may have images: what sift listed but for what is proven to have
    /// none.
    pub fn nodes(&self, layer: usize, point: usize) -> &[u32] {
        self.sifted.nodes(layer, point)
    }

    /// The images of a layer's `point`, by piece and t; `None` where not all are proven.
    pub fn images(&self, layer: usize, point: usize) -> Option<&[SolveImage]> {
        let (status, images) = self.layers[layer].as_ref()?;
        let slots = self.sifted.slots(layer);
        if status[point * slots..][..slots].contains(&NONE) {
            return None;
        }
        let from = images.partition_point(|i| (i.point as usize) < point);
        let count = images[from..].iter().take_while(|i| i.point as usize == point).count();
        Some(&images[from..][..count])
    }
}

//! Every buffer that the kernels of a frame bind: how large it is, who writes and who reads it, and how long its contents last.

use super::Capacities;
use super::stage::KernelId;
use crate::engine::plan::Plan;
use crate::gpu::layout::{self, COUNTERS, LANES};
use crate::image::frame::Channel;

/// A buffer.
#[derive(Debug)]
pub struct BufferSpec {
    pub name: &'static str,
    pub bytes: Bytes,
    /// The kernels that write it; otherwise the host writes it, where [`BufferSpec::is_uploaded`].
    pub written_by: &'static [KernelId],
    pub read_by: &'static [KernelId],
    pub lasts: Lasts,
}

/// How large a buffer is.
#[derive(Debug, Clone, Copy)]
pub enum Bytes {
    /// The host uploads items of so many bytes each.
    Items(usize),
    /// The host allocates what kernels write; `None`: these frames do without.
    Capacity(fn(&Sizes) -> Option<u64>),
    /// The host allocates what kernels write, so many bytes for each pixel of the largest band: [`super::bounce_tables`].
    EachPixel(usize),
}

/// How long kernels find in a buffer what was written there in a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Lasts {
    /// Until another scene, camera or appearance is uploaded.
    Upload,
    /// As long as the same band is rendered.
    Band,
    /// As long as the rays of the same bounce are followed.
    Bounce,
    /// As long as the same batch of triangles is rendered.
    Job,
}

/// What the sizes of buffers follow from.
#[derive(Debug, Clone, Copy)]
pub struct Sizes<'a> {
    pub plan: &'a Plan,
    pub capacities: Capacities,
    /// As [`super::resident::Resident::raster_rounds`].
    pub raster_rounds: u32,
    /// As [`super::resident::Resident::samples_by_tile`].
    pub samples_by_tile: bool,
}

impl Sizes<'_> {
    /// Of the largest band.
    fn pixels(&self) -> u64 {
        u64::from(self.plan.rows_max()) * u64::from(self.plan.width)
    }

    /// Of the band with most, over all slabs.
    fn tiles(&self) -> u64 {
        let tiles = self.plan.bands.iter().map(|b| b.tiles.tiles_x * b.tiles.tiles_y);
        tiles.max().unwrap_or(0).into()
    }

    fn by_tile(&self, bytes: u64) -> Option<u64> {
        self.plan.variant.by_tile.then_some(bytes)
    }

    fn of_samples(&self, bytes: u64) -> Option<u64> {
        self.plan.variant.samples_edges().then_some(bytes)
    }
}

/// Bytes of an item of a list: two words.
pub const ITEM_BYTES: u64 = 8;

/// Bytes of a vec4.
pub const VEC4_BYTES: u64 = 16;

/// Blocks of [`LANES`] strips of four samples: of each tile the last one may be partly empty.
fn blocks(s: &Sizes) -> u64 {
    let strips = s.capacities.edges * u64::from(s.plan.variant.samples.div_ceil(4));
    strips.div_ceil(u64::from(LANES)) + s.tiles()
}

/// Every buffer, in the order of first use.
pub fn table() -> Vec<BufferSpec> {
    use KernelId::*;
    use Lasts::{Band, Job, Upload};
    const SAMPLED: &[KernelId] = &[Edges, Sample, EdgesByTile, SampleByTile, RecheckSamples, Resolve];
    const OF_TRIANGLES: &[KernelId] = &[
        Small,
        Bin,
        Raster,
        Trace,
        Recheck,
        Certify,
        Edges,
        Sample,
        EdgesByTile,
        SampleByTile,
        RecheckSamples,
        Shade,
        Resolve,
    ];
    let uploaded =
        |name, item, read_by| BufferSpec { name, bytes: Bytes::Items(item), written_by: &[], read_by, lasts: Upload };
    let list = |name, lasts, bytes: fn(&Sizes) -> Option<u64>, written_by, read_by| BufferSpec {
        name,
        bytes: Bytes::Capacity(bytes),
        written_by,
        read_by,
        lasts,
    };
    let each_pixel = |name, bytes, written_by| BufferSpec {
        name,
        bytes: Bytes::EachPixel(bytes),
        written_by,
        read_by: &[],
        lasts: Lasts::Bounce,
    };
    vec![
        // the scene
        uploaded("clusters", size_of::<layout::Cluster>(), &[Cull]),
        uploaded("triangle_groups", size_of::<layout::Cluster>(), &[Split, Small, Bin]),
        uploaded("triangles", 16, OF_TRIANGLES),
        uploaded("vertices", size_of::<layout::Vertex>(), OF_TRIANGLES),
        uploaded("bvh", 16, &[Trace, Certify]),
        uploaded("bvh_triangles", 16, &[Trace, Certify]),
        uploaded("slot_of_id", 4, &[Edges, Shade, Resolve]),
        uploaded("surfaces", 16, &[Raster, Recheck, Shade, Resolve]),
        uploaded("normals", 16, &[Shade, Resolve]),
        uploaded("materials", size_of::<layout::Material>(), &[Raster, Recheck, Shade, Resolve]),
        // texels
        uploaded("pages", 8, &[Raster, Recheck, Shade, Resolve]),
        uploaded("lights", 16, &[Shade, Resolve]),
        uploaded("shading", size_of::<layout::Shading>(), &[Shade, Resolve, Write]),
        uploaded("style", size_of::<layout::Style>(), &[Shade, Resolve, Outline]),
        uploaded("medium", size_of::<layout::Medium>(), &[Volume]),
        // of a volume that is not lit 4
        uploaded("voxels", 16, &[Volume]),
        uploaded("receiver_triangle_of", 4, &[Gather]),
        uploaded("receiver_triangles", size_of::<layout::ReceiverTriangle>(), &[Gather]),
        uploaded("receivers", size_of::<layout::Receiver>(), &[Gather]),
        uploaded("sums", 4, &[Gather]),
        // the camera
        uploaded("params", size_of::<layout::Params>(), &KernelId::ALL),
        uploaded(
            "sample_offsets",
            size_of::<layout::SampleOffsets>(),
            &[Sample, SampleByTile, RecheckSamples, Resolve],
        ),
        uploaded(
            "tile_start",
            4,
            &[
                Cull,
                Raster,
                Trace,
                Recheck,
                Meet,
                Certify,
                Edges,
                Sample,
                EdgesByTile,
                SampleByTile,
                RecheckSamples,
                Shade,
                Resolve,
                Volume,
                Bounce,
                Paste,
            ],
        ),
        uploaded(
            "pieces",
            size_of::<layout::Piece>(),
            &[
                Small,
                Raster,
                Trace,
                Recheck,
                Meet,
                Certify,
                Sample,
                SampleByTile,
                RecheckSamples,
                Shade,
                Resolve,
                Volume,
                Bounce,
                Paste,
            ],
        ),
        // a ray of a field; of curves 12 bytes a control point
        uploaded(
            "rays_hi",
            24,
            &[
                Raster,
                Trace,
                Recheck,
                Meet,
                Certify,
                Sample,
                SampleByTile,
                RecheckSamples,
                Shade,
                Resolve,
                Volume,
                Bounce,
                Fit,
            ],
        ),
        uploaded(
            "rays_lo",
            24,
            &[Raster, Trace, Recheck, Meet, Certify, Sample, SampleByTile, RecheckSamples, Shade, Volume, Bounce],
        ),
        uploaded("cell_samples", 8, SAMPLED),
        uploaded("sample_ray_deltas", 24, &[Sample, SampleByTile, RecheckSamples, Resolve]),
        BufferSpec {
            written_by: &[Fit],
            ..uploaded(
                "nodes",
                size_of::<layout::Node>(),
                &[Cull, Split, Small, Bin, Raster, Edges, Sample, EdgesByTile, SampleByTile, Reach, Fit],
            )
        },
        BufferSpec {
            written_by: &[Fit],
            ..uploaded(
                "cells",
                size_of::<layout::Cell>(),
                &[
                    Cull,
                    Split,
                    Small,
                    Bin,
                    Raster,
                    Trace,
                    Recheck,
                    Meet,
                    Certify,
                    Edges,
                    Sample,
                    SampleByTile,
                    RecheckSamples,
                    Shade,
                    Resolve,
                    Volume,
                    Bounce,
                    Paste,
                ],
            )
        },
        // when each pixel sees the scene
        uploaded("moments", 4, &[Trace, Recheck, Shade]),
        // its optics
        uploaded("optic", size_of::<layout::Optic>(), &[Raster, Trace, Reach, Meet, Shade, Gather, Bounce, Fit, Paste]),
        uploaded("corners", size_of::<layout::Corner>(), &[Bounce, Paste]),
        uploaded("quadrics", size_of::<layout::Quadric>(), &[Meet, Bounce]),
        uploaded("tori", size_of::<layout::Torus>(), &[Meet, Bounce]),
        uploaded("waves", size_of::<layout::Wave>(), &[Meet, Bounce]),
        uploaded("paths", size_of::<layout::PathState>(), &[Raster, Trace, Recheck, Meet, Shade, Gather, Bounce]),
        each_pixel("bounced_hi", 24, &[Forget, Bounce]),
        each_pixel("bounced_lo", 24, &[Forget, Bounce]),
        each_pixel("bounced_paths", size_of::<layout::PathState>(), &[Forget, Bounce]),
        // how many tiles have a ray, or may meet the optics, and two words a tile
        BufferSpec {
            written_by: &[Args, Reach],
            ..uploaded("live", 4, &[Args, Reach, Trace, Meet, Shade, Bounce, Fit])
        },
        BufferSpec { written_by: &[Args, Bounce], ..uploaded("bounced_live", 4, &[Args, Forget, Bounce]) },
        uploaded("atlas_layout", size_of::<layout::AtlasLayout>(), &[Paste]),
        uploaded("atlas", 4, &[Paste]),
        // what stages count, and the size of the next dispatch
        list(
            "counters",
            Lasts::Bounce,
            |_| Some(4 * u64::from(COUNTERS)),
            &[Args, Choose, Cull, Split, Small, Bin, Allot, Raster, Trace, Recheck, Edges, EdgesByTile, SampleByTile],
            &[
                Args,
                Choose,
                Cull,
                Split,
                Small,
                Bin,
                Allot,
                Sort,
                Raster,
                Trace,
                Recheck,
                Certify,
                Edges,
                Sample,
                EdgesByTile,
                SampleByTile,
                RecheckSamples,
                Resolve,
            ],
        ),
        list(
            "indirect",
            Job,
            |_| Some(12),
            &[Args],
            &[
                Cull,
                Split,
                Small,
                Bin,
                Sort,
                Raster,
                Trace,
                Recheck,
                Meet,
                Shade,
                Bounce,
                Forget,
                Certify,
                Edges,
                Sample,
                SampleByTile,
                RecheckSamples,
                Resolve,
            ],
        ),
        // lists between the stages
        list("queue_even", Job, |s| Some(ITEM_BYTES * s.capacities.queue), &[Cull], &[Cull]),
        list("queue_odd", Job, |s| Some(ITEM_BYTES * s.capacities.queue), &[Cull], &[Cull]),
        list("work", Job, |s| Some(ITEM_BYTES * s.capacities.work), &[Cull], &[Split]),
        list("tasks", Job, |s| Some(ITEM_BYTES * s.capacities.tasks), &[Split], &[Small, Bin]),
        list("large", Job, |s| s.plan.variant.small.then_some(ITEM_BYTES * s.capacities.pairs), &[Small], &[Bin]),
        list("unsorted", Job, |s| s.by_tile(ITEM_BYTES * s.capacities.pairs), &[Bin], &[Sort]),
        list("ranks", Job, |s| s.by_tile(4 * s.capacities.pairs), &[Bin], &[Sort]),
        list("starts", Job, |s| s.by_tile(4 * s.tiles()), &[Allot, Raster], &[Sort, Raster, EdgesByTile]),
        list("ends", Job, |s| s.by_tile(4 * s.tiles()), &[Bin, Allot], &[Bin, Allot, Raster, EdgesByTile]),
        list("busy", Job, |s| s.by_tile(4 * s.tiles() * u64::from(1 + s.raster_rounds)), &[Allot, Raster], &[Raster]),
        list(
            "pairs",
            Job,
            |s| Some(ITEM_BYTES * s.capacities.pairs),
            &[Bin, Sort],
            &[Raster, Certify, Edges, Sample, EdgesByTile, RecheckSamples],
        ),
        list(
            "recheck_items",
            Job,
            |s| Some(ITEM_BYTES * s.capacities.recheck_items),
            &[Small, Raster, Trace, SampleByTile],
            &[Recheck, RecheckSamples],
        ),
        // of each pixel with an edge its place, and a key a sample
        list(
            "samples",
            Lasts::Bounce,
            |s| s.of_samples(ITEM_BYTES * u64::from(s.plan.variant.samples + 1) * s.capacities.edges),
            &[Edges, Sample, EdgesByTile, SampleByTile, RecheckSamples],
            &[Sample, SampleByTile, RecheckSamples, Resolve],
        ),
        list("edge_of", Lasts::Bounce, |s| s.of_samples(4 * s.pixels()), &[Edges, EdgesByTile], &[Edges, Sample]),
        list("blocks", Job, |s| s.samples_by_tile.then(|| VEC4_BYTES * blocks(s)), &[EdgesByTile], &[SampleByTile]),
        list(
            "touches",
            Job,
            |s| s.samples_by_tile.then_some(VEC4_BYTES * s.capacities.pairs),
            &[EdgesByTile],
            &[SampleByTile],
        ),
        // the image
        list(
            "visibility",
            Lasts::Bounce,
            |s| Some(8 * s.pixels()),
            &[Small, Raster, Trace, Recheck, Meet],
            &[Small, Raster, Trace, Recheck, Meet, Certify, Edges, EdgesByTile, Shade, Gather, Volume, Bounce, Paste],
        ),
        list(
            "proofs",
            Lasts::Bounce,
            |s| s.plan.planes.contains(&Channel::Certified).then_some(8 * s.pixels()),
            &[Certify],
            &[Certify],
        ),
        list(
            "planes",
            Band,
            |s| Some(4 * s.plan.planes.len() as u64 * s.pixels()),
            &[Certify, Shade, Resolve, Gather, Paste, Outline, Volume],
            &[Shade, Resolve, Gather, Outline, Volume, Write],
        ),
        list("srgb8", Band, |s| s.plan.srgb8.then_some(4 * s.pixels()), &[Write], &[]),
    ]
}

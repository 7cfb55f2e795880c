//! The stages of a frame, one file each: the dispatches of its kernels, as data, by pure functions.
//!
//! `cull -> split -> small -> bin -> sort -> raster -> recheck -> shade -> write`, each the host's side of the kernel of that name. Where nothing
//! comes after shade, it writes what [`write`](mod@write) would.
//! [`small`] and [`sort`] are left out where raster goes pair by pair. [`trace`] takes the place of cull to raster, or of what is left of them
//! where it costs less; [`choose`] decides that before each dispatch of raster.
//!
//! The stage [`aim`] comes first where the rays are those of a viewer at a pose, once for each pose.
//!
//! Where the camera has a mirror or a lens, [`reach`] comes first, [`meet`] beside raster, and after shade `forget -> bounce -> fit` and all
//! of it again, or [`paste`] from an atlas that was rendered before. Where pixels have several samples, [`edges`] and [`sample`] follow
//! recheck and [`resolve`] follows shade; [`outline`] draws lines over what they came to, and [`volume`] puts a volume over that. Caustics are
//! added up by [`deposit`] before the first frame and shown by [`gather`] after shade. [`sift`] is not part of a frame: it finds the parts of
//! an image that may see a point, where [`solve`] finds its images and [`splat`] the nearest of each pixel; nor is [`gradient`], which follows a frame that was read back.

pub mod aim;
pub mod bin;
pub mod bounce;
pub mod certify;
pub mod cull;
pub mod deposit;
pub mod edges;
pub mod fit;
pub mod forget;
pub mod gather;
pub mod gradient;
pub mod meet;
pub mod outline;
pub mod paste;
pub mod raster;
pub mod reach;
pub mod recheck;
pub mod resolve;
pub mod sample;
pub mod shade;
pub mod sift;
pub mod small;
pub mod solve;
pub mod sort;
pub mod splat;
pub mod split;
pub mod trace;
pub mod volume;
pub mod write;

use crate::gpu::Gpu;
use crate::gpu::buffers::{BindGroups, Buffers, Pipeline};
use crate::gpu::kernels::{Kernel, Method, OpticsKind, Variant};
use crate::gpu::layout::{CULL_QUEUES, Counter, GROUP, NONE, Step};
use crate::image::frame::Channel;
use crate::input::{Error, Result};
use crate::parallel;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::OnceLock;

/// Generates the ids of kernels, their list, and the entry file of each, from one table.
macro_rules! kernels {
    ($($(#[$doc:meta])* $id:ident, $is_there:expr, $file:expr;)*) => {
        /// The kernels of frames.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum KernelId {
            $($(#[$doc])* $id,)*
        }

        impl KernelId {
            pub const ALL: [KernelId; [$(stringify!($id)),*].len()] = [$(KernelId::$id),*];

            /// The entry file of the kernel of a variant whose frames have these planes; `None`: they do without.
            fn entry_file(self, variant: Variant, planes: &[Channel]) -> Option<&'static str> {
                let (is_there, file): (fn(Variant, &[Channel]) -> bool, fn(Variant) -> &'static str) = match self {
                    $(KernelId::$id => ($is_there, $file),)*
                };
                is_there(variant, planes).then(|| file(variant))
            }
        }
    };
}

// the variants that have a kernel, and its entry file
kernels! {
    /// Lays out the dispatches of the others that follow a counter.
    Args, |_, _| true, |_| "args.wgsl";
    /// Whether trace takes over from raster.
    Choose, |v, _| v.method() == Method::Auto, |_| "choose.wgsl";
    /// The rays of a viewer that turns and moves.
    Aim, |v, _| v.rays.kind.is_field() && !v.is_bounced(), |_| "aim.wgsl";
    /// The bounds on the rays of such a viewer.
    AimNodes, |v, _| aim::turns_nodes(v), |_| "aim_nodes.wgsl";
    Cull, |v, _| v.rasters(), |_| "cull.wgsl";
    Split, |v, _| v.rasters(), |_| "split.wgsl";
    Small, |v, _| v.draws_small(), |_| "software/small.wgsl";
    Bin, |v, _| v.rasters(), |_| "bin.wgsl";
    Allot, |v, _| v.by_tile(), |_| "allot.wgsl";
    Sort, |v, _| v.by_tile(), |_| "sort.wgsl";
    Raster, |v, _| v.rasters(), |v| if v.by_tile() { "raster_by_tile.wgsl" } else { "raster.wgsl" };
    Trace, |v, _| v.traces(), |_| "trace.wgsl";
    Recheck, |v, _| v.rechecks(), |_| "recheck.wgsl";
    Meet, |v, _| v.meets(), |_| "meet.wgsl";
    Certify, |_, planes| planes.contains(&Channel::Certified), certify::entry_file;
    /// Edges and samples, pair by pair.
    Edges, |v, _| v.samples_edges(), |_| "edges.wgsl";
    Sample, |v, _| v.samples_edges(), |_| "sample.wgsl";
    /// The same tile by tile.
    EdgesByTile, |v, _| v.samples_by_tile(), |_| "edges_by_tile.wgsl";
    SampleByTile, |v, _| v.samples_by_tile(), |_| "sample_by_tile.wgsl";
    RecheckSamples, |v, _| v.samples_by_tile(), |_| "recheck_samples.wgsl";
    Shade, |_, _| true, |_| "shade.wgsl";
    Resolve, |v, _| v.samples_edges(), |_| "resolve.wgsl";
    Gather, |_, _| true, |_| "gather.wgsl";
    Reach, |v, _| v.bounces_rays(), |_| "reach.wgsl";
    Forget, |v, _| v.bounces_rays(), |_| "forget.wgsl";
    Bounce, |v, _| v.bounces_rays(), |_| "bounce.wgsl";
    Fit, |v, _| v.bounces_rays() && v.rasters(), |_| "fit.wgsl";
    Paste, |v, _| v.optics() == Some(OpticsKind::Atlas), |_| "paste.wgsl";
    Outline, |v, _| v.extras.outlined, |_| "outline.wgsl";
    Volume, |v, _| v.extras.volume.is_some(), |_| "volume.wgsl";
    Write, |v, _| !v.extras.writes, |_| "write.wgsl";
}

/// The kernels of a variant whose frames have these planes, and those that are no part of a frame but the ones of [`gradient`].
#[cfg(feature = "internals")]
pub fn all_kernels(variant: Variant, planes: &[Channel]) -> Vec<Kernel> {
    let of_frames = KernelId::ALL.into_iter().filter_map(|id| id.kernel(variant, planes));
    let solve = [solve::PIECES, solve::CURVES].map(solve::kernel);
    let others = ["mip.wgsl", "sift.wgsl", "claim.wgsl", "contend.wgsl", "deposit.wgsl"].map(Kernel::alone);
    of_frames.chain(solve).chain(others).collect()
}

impl KernelId {
    /// The kernel of a variant whose frames have these planes; `None`: they do without.
    pub fn kernel(self, variant: Variant, planes: &[Channel]) -> Option<Kernel> {
        let file = self.entry_file(variant, planes)?;
        // fit bounds the rays of the next bounce
        let variant = if self == KernelId::Fit { variant.after_bounce() } else { variant };
        Some(Kernel::new(file, variant, planes))
    }

    /// Compiled when a frame first needs it: most frames do not.
    fn is_lazy(self) -> bool {
        use KernelId::*;
        matches!(self, Aim | Edges | Sample | EdgesByTile | SampleByTile | RecheckSamples | Gather)
    }
}

/// What the uniform `step` tells a kernel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Number {
    /// Index of the dispatch among those of its kernel; to `args`: of a queue of cull.
    Index(u32),
    /// To `args`: a counter.
    Counter(Counter),
    /// To `args`: the tiles of a list.
    Tiles(&'static str),
}

/// Lists of tiles that have a ray after a bounce, and the buffers of their [`Number::Tiles`].
const TILE_LISTS: [(&str, &str); 2] = [("live", "tiles_live"), ("bounced_live", "tiles_bounced_live")];

/// Buffer names of [`Number::Index`]: levels of the tree, and rounds.
const INDEX_NAMES: [&str; CULL_QUEUES as usize] =
    ["index_0", "index_1", "index_2", "index_3", "index_4", "index_5", "index_6", "index_7"];

impl Number {
    pub fn every() -> impl Iterator<Item = Number> {
        let counters = Counter::ALL.iter().copied().map(Number::Counter);
        (0..CULL_QUEUES).map(Number::Index).chain(counters).chain(TILE_LISTS.iter().map(|list| Number::Tiles(list.0)))
    }

    /// The name of its buffer.
    pub fn name(self) -> &'static str {
        match self {
            Number::Index(n) => INDEX_NAMES[n as usize],
            Number::Counter(counter) => counter.name(),
            Number::Tiles(list) => TILE_LISTS.iter().find(|own| own.0 == list).map_or(list, |own| own.1),
        }
    }

    /// Where `args` finds the count.
    pub fn counted_in(self) -> &'static str {
        if let Number::Tiles(list) = self { list } else { "counters" }
    }

    /// What it counts is for a stage of raster, which may be left out.
    pub fn is_of_raster(self) -> bool {
        use Counter::*;
        match self {
            Number::Index(_) => true,
            Number::Counter(counter) => matches!(counter, Work | Tasks | Large | Pairs | Busy),
            Number::Tiles(_) => false,
        }
    }

    fn value(self) -> u32 {
        match self {
            Number::Index(n) => n,
            Number::Counter(counter) => counter.index(),
            Number::Tiles(_) => NONE,
        }
    }
}

/// The pixels that a stage takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pixels {
    /// All of a band, so many.
    Every(u32),
    /// Those of the tiles that have a ray after a bounce.
    Live,
}

/// How many threads a dispatch has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Threads {
    /// One for each of so many items.
    Items(u32),
    /// As many as `args` finds in a counter.
    Counted(Number),
}

/// A dispatch of a kernel.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Dispatch {
    pub kernel: KernelId,
    /// Its `step`, where it has one.
    pub step: Number,
    pub threads: Threads,
    /// What the kernel calls a buffer, and the buffer's name.
    pub renamed: Vec<(&'static str, &'static str)>,
}

impl Dispatch {
    /// Over so many items.
    pub fn over(kernel: KernelId, items: u32) -> Dispatch {
        Dispatch { kernel, step: Number::Index(0), threads: Threads::Items(items), renamed: Vec::new() }
    }

    /// Over pixels.
    pub fn of_pixels(kernel: KernelId, pixels: Pixels) -> Dispatch {
        match pixels {
            Pixels::Every(count) => Dispatch::over(kernel, count),
            Pixels::Live => Dispatch { threads: Threads::Counted(Number::Tiles("live")), ..Dispatch::over(kernel, 0) },
        }
    }

    /// Over as many items as were counted.
    pub fn counted(kernel: KernelId, counter: Counter) -> Dispatch {
        Dispatch { threads: Threads::Counted(Number::Counter(counter)), ..Dispatch::over(kernel, 0) }
    }

    /// Its `step` is this number.
    pub fn nth(self, n: u32) -> Dispatch {
        Dispatch { step: Number::Index(n), ..self }
    }

    /// With `buffer` where the kernel says `name`.
    pub fn with(mut self, name: &'static str, buffer: &'static str) -> Dispatch {
        self.renamed.push((name, buffer));
        self
    }
}

/// The kernels of a variant, compiled, and the buffers of [`Number`].
pub struct Stages {
    kernels: BTreeMap<KernelId, OnceLock<Pipeline>>,
    steps: Buffers,
    pub variant: Variant,
    /// The channels that `shade` writes.
    pub planes: Vec<Channel>,
}

/// Buffers that a dispatch binds, the innermost scope first.
pub type Scopes<'a> = &'a [&'a Buffers];

impl Stages {
    pub fn new(gpu: &Gpu, variant: Variant, planes: &[Channel]) -> Result<Stages> {
        let mut steps = Buffers::default();
        for number in Number::every() {
            steps.upload_uniform(gpu, number.name(), &Step { value: number.value() })?;
        }
        // all at once: a GPU's driver takes a tenth of a second and more for a kernel
        let kernels = parallel::try_map(&KernelId::ALL[..], |id| {
            let Some(kernel) = id.kernel(variant, planes) else { return Ok(None) };
            let pipeline = if id.is_lazy() { OnceLock::new() } else { Pipeline::new(gpu, kernel)?.into() };
            Ok(Some((*id, pipeline)))
        });
        Ok(Stages { kernels: kernels?.into_iter().flatten().collect(), steps, variant, planes: planes.to_vec() })
    }

    /// Compiles what dispatches take, where it is not yet.
    pub fn compile(&self, gpu: &Gpu, dispatches: &[Dispatch]) -> Result<()> {
        let is_left = |id: &KernelId| self.kernels.get(id).and_then(OnceLock::get).is_none();
        let left: BTreeSet<KernelId> = dispatches.iter().map(|d| d.kernel).filter(is_left).collect();
        let left: Vec<KernelId> = left.into_iter().collect();
        parallel::try_map(&left, |id| self.pipeline(gpu, *id).map(|_| ())).map(|_| ())
    }

    /// Encodes dispatches in their order.
    pub fn encode(
        &self,
        gpu: &Gpu,
        pass: &mut wgpu::ComputePass,
        scopes: Scopes,
        dispatches: &[Dispatch],
        groups: &mut BindGroups,
    ) -> Result<()> {
        let scopes: Vec<&Buffers> = scopes.iter().copied().chain([&self.steps]).collect();
        for Dispatch { kernel, step, threads, renamed } in dispatches {
            if let Threads::Counted(number) = threads {
                if self.variant.method() == Method::Auto && number.is_of_raster() {
                    let choose = self.pipeline(gpu, KernelId::Choose)?;
                    let group = groups.next(gpu, choose, &scopes, &[("step", number.name())])?;
                    pass.set_pipeline(choose.raw());
                    pass.set_bind_group(0, group, &[]);
                    pass.dispatch_workgroups(1, 1, 1);
                }
                let args = self.pipeline(gpu, KernelId::Args)?;
                let renamed = [("step", number.name()), ("counters", number.counted_in())];
                let group = groups.next(gpu, args, &scopes, &renamed)?;
                pass.set_pipeline(args.raw());
                pass.set_bind_group(0, group, &[]);
                pass.dispatch_workgroups(1, 1, 1);
            }
            let kernel = self.pipeline(gpu, *kernel)?;
            let renamed = [&[("step", step.name())][..], renamed].concat();
            let group = groups.next(gpu, kernel, &scopes, &renamed)?;
            pass.set_pipeline(kernel.raw());
            pass.set_bind_group(0, group, &[]);
            match (threads, scopes.iter().find_map(|s| s.get("indirect"))) {
                (Threads::Items(items), _) => dispatch_items(gpu, pass, *items),
                (Threads::Counted(_), Some(indirect)) => pass.dispatch_workgroups_indirect(indirect, 0),
                (Threads::Counted(_), None) => return Err(Error::work("no buffer indirect")),
            }
        }
        Ok(())
    }

    fn pipeline(&self, gpu: &Gpu, id: KernelId) -> Result<&Pipeline> {
        if let Some(pipeline) = self.kernels.get(&id).and_then(OnceLock::get) {
            return Ok(pipeline);
        }
        let Some((slot, kernel)) = self.kernels.get(&id).zip(id.kernel(self.variant, &self.planes)) else {
            return Err(Error::work(format!("a frame takes {id:?}, which its kernels lack")));
        };
        let pipeline = Pipeline::new(gpu, kernel)?;
        Ok(slot.get_or_init(|| pipeline))
    }
}

/// Workgroups for `items` threads, in two dimensions where one does not suffice.
pub fn dispatch_items(gpu: &Gpu, pass: &mut wgpu::ComputePass, items: u32) {
    let groups = items.div_ceil(GROUP);
    let rows = groups.div_ceil(gpu.limits.max_compute_workgroups_per_dimension).max(1);
    pass.dispatch_workgroups(groups.div_ceil(rows), rows, 1);
}

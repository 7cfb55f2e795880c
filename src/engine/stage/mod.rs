//! The stages of a frame, one file each: what it binds and how it is dispatched.
//!
//! `cull -> split -> bin -> sort -> raster -> recheck -> shade -> write`, each the host's side of the kernel of that name. Where a mirror or a lens turns
//! rays, [`meet`] comes beside raster, and after shade `bounce -> fit` and all of it again, or [`paste`] from an atlas that was
//! rendered before. Where pixels have several samples, [`edges`] and [`sample`] follow recheck and [`resolve`] follows shade; [`outline`] draws lines over what they came to. Caustics are added up by [`deposit`] before the first frame and shown by [`gather`] after shade. Apart
//! from these is [`sift`], which finds the parts of an image that may see a point.

pub mod bin;
pub mod bounce;
pub mod certify;
pub mod cull;
pub mod deposit;
pub mod edges;
pub mod fit;
pub mod gather;
pub mod meet;
pub mod outline;
pub mod paste;
pub mod raster;
pub mod recheck;
pub mod resolve;
pub mod sample;
pub mod shade;
pub mod sift;
pub mod sort;
pub mod split;
pub mod write;

use crate::gpu::Gpu;
use crate::gpu::buffers::{Buffers, Later, Pipeline};
use crate::gpu::kernels::{self, OpticsKind, Variant};
use crate::gpu::layout::{COUNTERS, GROUP, Step};
use crate::image::frame::Channel;
use crate::input::Result;

/// Names of the step buffers, by value: of a step, or of a counter.
const STEPS: [&str; COUNTERS as usize] = [
    "step0", "step1", "step2", "step3", "step4", "step5", "step6", "step7", "step8", "step9", "step10", "step11",
    "step12", "step13", "step14", "step15", "step16", "step17", "step18", "step19", "step20", "step21", "step22",
    "step23",
];

/// The kernels of a variant, compiled, and the step buffers that number their dispatches.
pub struct Stages {
    args: Pipeline,
    cull: Pipeline,
    split: Pipeline,
    bin: Pipeline,
    sort: Option<[Pipeline; 2]>,
    raster: Pipeline,
    recheck: Option<Pipeline>,
    certify: Option<Pipeline>,
    /// Edges and sample, pair by pair.
    by_pair: Option<[Later; 2]>,
    /// Edges, sample and recheck_samples, tile by tile.
    by_tile: Option<[Later; 3]>,
    resolve: Option<Pipeline>,
    shade: Pipeline,
    outline: Option<Pipeline>,
    write: Pipeline,
    bounce: Option<Pipeline>,
    fit: Option<Pipeline>,
    meet: Option<Pipeline>,
    paste: Option<Pipeline>,
    steps: Buffers,
    pub variant: Variant,
    /// The channels that `shade` writes.
    pub planes: Vec<Channel>,
}

/// Buffers that a dispatch binds, the innermost scope first.
pub type Scopes<'a> = &'a [&'a Buffers];

impl Stages {
    pub fn new(gpu: &Gpu, variant: Variant, planes: &[Channel]) -> Result<Stages> {
        let compile = |kernel| Pipeline::new(gpu, kernel);
        let mut steps = Buffers::default();
        for (value, name) in STEPS.iter().enumerate() {
            steps.upload_uniform(gpu, name, &Step { value: value as u32 })?;
        }
        Ok(Stages {
            args: compile(kernels::args()),
            cull: compile(kernels::cull(variant)),
            split: compile(kernels::split(variant)),
            bin: compile(kernels::bin(variant)),
            sort: variant.by_tile.then(|| [compile(kernels::allot()), compile(kernels::sort())]),
            raster: compile(kernels::raster(variant)),
            recheck: variant.rechecks().then(|| compile(kernels::recheck(variant))),
            certify: planes.contains(&Channel::Certified).then(|| compile(kernels::certify(variant, planes))),
            by_pair: variant
                .samples_edges()
                .then(|| [kernels::edges, kernels::sample].map(|kernel| Later::new(kernel, variant))),
            by_tile: variant.samples_by_tile().then(|| {
                [kernels::edges_by_tile, kernels::sample_by_tile, kernels::recheck_samples]
                    .map(|kernel| Later::new(kernel, variant))
            }),
            resolve: variant.samples_edges().then(|| compile(kernels::resolve(variant, planes))),
            shade: compile(kernels::shade(variant, planes)),
            outline: variant.outlined.then(|| compile(kernels::outline(planes))),
            write: compile(kernels::write_srgb(planes)),
            bounce: variant.bounces_rays().then(|| compile(kernels::bounce(variant))),
            fit: variant.bounces_rays().then(|| compile(kernels::fit(variant))),
            meet: variant.meets().then(|| compile(kernels::meet(variant))),
            paste: (variant.optics == Some(OpticsKind::Atlas)).then(|| compile(kernels::paste(variant, planes))),
            steps,
            variant,
            planes: planes.to_vec(),
        })
    }

    /// Turns the count with index `counter` into the arguments of the next indirect dispatch.
    fn lay_out(&self, gpu: &Gpu, pass: &mut wgpu::ComputePass, scopes: Scopes, counter: u32) -> Result<()> {
        let scopes = with(scopes, &self.steps);
        let group = self.args.bind_renamed(gpu, &scopes, &[("step", STEPS[counter as usize])])?;
        pass.set_pipeline(self.args.raw());
        pass.set_bind_group(0, &group, &[]);
        pass.dispatch_workgroups(1, 1, 1);
        Ok(())
    }

    /// Dispatches a kernel over as many items as the count with index `counter` says.
    fn dispatch_counted(
        &self,
        gpu: &Gpu,
        pass: &mut wgpu::ComputePass,
        scopes: Scopes,
        kernel: &Pipeline,
        (counter, step): (u32, u32),
    ) -> Result<()> {
        self.lay_out(gpu, pass, scopes, counter)?;
        let group = kernel.bind_renamed(gpu, &with(scopes, &self.steps), &[("step", STEPS[step as usize])])?;
        self.dispatch_laid_out(pass, scopes, kernel, &group);
        Ok(())
    }

    /// Dispatches a kernel over what was laid out last.
    fn dispatch_laid_out(
        &self,
        pass: &mut wgpu::ComputePass,
        scopes: Scopes,
        kernel: &Pipeline,
        group: &wgpu::BindGroup,
    ) {
        pass.set_pipeline(kernel.raw());
        pass.set_bind_group(0, group, &[]);
        if let Some(indirect) = scopes.iter().find_map(|s| s.get("indirect")) {
            pass.dispatch_workgroups_indirect(indirect, 0);
        }
    }
}

fn with<'a>(scopes: Scopes<'a>, more: &'a Buffers) -> Vec<&'a Buffers> {
    scopes.iter().copied().chain([more]).collect()
}

/// Workgroups for `items` threads, in two dimensions where one does not suffice.
pub(crate) fn dispatch_items(gpu: &Gpu, pass: &mut wgpu::ComputePass, items: u32) {
    let groups = items.div_ceil(GROUP);
    let rows = groups.div_ceil(gpu.limits.max_compute_workgroups_per_dimension).max(1);
    pass.dispatch_workgroups(groups.div_ceil(rows), rows, 1);
}

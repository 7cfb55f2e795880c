//! gather: the caustics of the receivers that a band's pixels show, into the colour planes.

use super::{Scopes, dispatch_items};
use crate::gpu::Gpu;
use crate::gpu::buffers::Pipeline;
use crate::gpu::kernels::{self, Variant};
use crate::image::frame::Channel;
use crate::input::Result;

/// The kernel, compiled for the planes of a plan.
pub struct Gather {
    pipeline: Pipeline,
    variant: Variant,
    planes: Vec<Channel>,
}

impl Gather {
    pub fn new(gpu: &Gpu, variant: Variant, planes: &[Channel]) -> Gather {
        let pipeline = Pipeline::new(gpu, kernels::gather(variant, planes));
        Gather { pipeline, variant, planes: planes.to_vec() }
    }

    pub fn suits(&self, variant: Variant, planes: &[Channel]) -> bool {
        self.variant == variant && self.planes == planes
    }

    pub fn run(&self, gpu: &Gpu, pass: &mut wgpu::ComputePass, scopes: Scopes, pixels: u32) -> Result<()> {
        let group = self.pipeline.bind(gpu, scopes)?;
        pass.set_pipeline(self.pipeline.raw());
        pass.set_bind_group(0, &group, &[]);
        dispatch_items(gpu, pass, pixels);
        Ok(())
    }
}

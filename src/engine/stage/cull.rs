//! cull: clusters against the tree of nodes, one dispatch a step down.

use super::{STEPS, Scopes, Stages, dispatch_items, with};
use crate::gpu::Gpu;
use crate::input::Result;

/// The two queues between the steps; step k reads the first when k is odd.
const QUEUES: [&str; 2] = ["queue_even", "queue_odd"];

impl Stages {
    /// Encodes the descent of `clusters` clusters in [`crate::engine::plan::nodes::Nodes::cull_steps`].
    pub fn cull(
        &self,
        gpu: &Gpu,
        pass: &mut wgpu::ComputePass,
        scopes: Scopes,
        clusters: u32,
        steps: u32,
    ) -> Result<()> {
        let all = with(scopes, &self.steps);
        let indirect = all.iter().find_map(|s| s.get("indirect"));
        for step in 0..steps {
            if step > 0 {
                self.lay_out(gpu, pass, scopes, step)?;
            }
            let (queue_in, queue_out) = (QUEUES[(step % 2) as usize], QUEUES[((step + 1) % 2) as usize]);
            let renamed = [("step", STEPS[step as usize]), ("queue_in", queue_in), ("queue_out", queue_out)];
            let group = self.cull.bind_renamed(gpu, &all, &renamed)?;
            pass.set_pipeline(self.cull.raw());
            pass.set_bind_group(0, &group, &[]);
            match indirect {
                Some(indirect) if step > 0 => pass.dispatch_workgroups_indirect(indirect, 0),
                _ => dispatch_items(gpu, pass, clusters),
            }
        }
        Ok(())
    }
}

//! Render passes, for techniques that draw: the engine itself only computes.

use super::Recorder;
use crate::gpu::draw_counts::DrawQueries;
use std::ops::{Deref, DerefMut};

impl Recorder {
    pub fn render(
        &mut self,
        name: &'static str,
        colours: &[Option<wgpu::RenderPassColorAttachment>],
        depth: Option<wgpu::RenderPassDepthStencilAttachment>,
    ) -> wgpu::RenderPass<'_> {
        let k = self.count(name);
        let timestamp_writes = self.times.as_ref().zip(k).map(|(t, k)| wgpu::RenderPassTimestampWrites {
            query_set: &t.queries.set,
            beginning_of_pass_write_index: Some(k),
            end_of_pass_write_index: Some(k + 1),
        });
        self.encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(name),
            color_attachments: colours,
            depth_stencil_attachment: depth,
            timestamp_writes,
            ..Default::default()
        })
    }

    /// A render pass whose work is counted, if that is asked for.
    pub fn draw(
        &mut self,
        name: &'static str,
        colours: &[Option<wgpu::RenderPassColorAttachment>],
        depth: Option<wgpu::RenderPassDepthStencilAttachment>,
    ) -> DrawPass<'_> {
        let query = self.draws.as_mut().and_then(DrawQueries::add_pass);
        let set = self.draws.as_ref().map(|draws| draws.set().clone());
        DrawPass::new(self.render(name, colours, depth), set.as_ref().zip(query))
    }
}

/// A render pass that ends its count where it ends.
pub struct DrawPass<'a> {
    pass: wgpu::RenderPass<'a>,
    is_counted: bool,
}

impl<'a> DrawPass<'a> {
    /// Counted by a query of a set, if there is one.
    fn new(mut pass: wgpu::RenderPass<'a>, query: Option<(&wgpu::QuerySet, u32)>) -> DrawPass<'a> {
        if let Some((set, query)) = query {
            pass.begin_pipeline_statistics_query(set, query);
        }
        DrawPass { pass, is_counted: query.is_some() }
    }
}

impl<'a> Deref for DrawPass<'a> {
    type Target = wgpu::RenderPass<'a>;

    fn deref(&self) -> &wgpu::RenderPass<'a> {
        &self.pass
    }
}

impl<'a> DerefMut for DrawPass<'a> {
    fn deref_mut(&mut self) -> &mut wgpu::RenderPass<'a> {
        &mut self.pass
    }
}

impl Drop for DrawPass<'_> {
    fn drop(&mut self) {
        if self.is_counted {
            self.pass.end_pipeline_statistics_query();
        }
    }
}

//! The picture of all facets, rendered before the frame that shows them.

use super::{Engine, Frames, Rendered, RunOptions, add_stages};
use crate::camera::Camera;
use crate::camera::optics::atlas::{Layout, camera as atlas_camera};
use crate::camera::optics::{Atlas, Facets, Law, Optics, Surface};
use crate::engine::plan::{SceneShape, Wanted};
use crate::gpu::Gpu;
use crate::gpu::buffers::Buffers;
use crate::gpu::layout::AtlasLayout;
use crate::image::frame::Channel;
use crate::input::Result;
use crate::scene::Scene;
use std::sync::Arc;
use wgpu::BufferUsages;

/// Renders the atlas of a camera that has one.
pub struct AtlasRenderer {
    pub frames: Box<Frames>,
    layout: Layout,
}

impl Engine {
    /// The renderer of the atlas of a camera that has one. Its planes are those of the frame, less the facets' own number, which is
    /// the last.
    pub(super) fn atlas_renderer(
        &mut self,
        scene: &Scene,
        camera: &Camera,
        wanted: &Wanted,
        run: &RunOptions,
    ) -> Result<Option<AtlasRenderer>> {
        let Some((optics, atlas, facets, law)) = camera.optics.as_deref().and_then(parts) else { return Ok(None) };
        let mut channels = wanted.channels.clone();
        if wanted.srgb8 {
            channels.extend([Channel::R, Channel::G, Channel::B]);
        }
        channels.extend(wanted.sample_ids.then_some(Channel::TriangleId));
        // the same planes in the same places as the frame's own
        let channels = Channel::in_order(channels);
        let wanted = Wanted { counting: wanted.counting, ..Wanted::of(channels) };
        let cameras = facets.copy();
        let camera = atlas_camera(optics, atlas, cameras, law)?;
        let planned =
            self.planner().plan_in_order((scene, SceneShape::of(scene)), Arc::new(camera), &wanted, run, None)?;
        let frames = Box::new(self.upload(planned, run)?);
        Ok(Some(AtlasRenderer { frames, layout: Layout::new(cameras.triangles.len(), atlas.texels) }))
    }
}

fn parts(optics: &Optics) -> Option<(&Optics, &Atlas, &Facets, Law)> {
    match &optics.surface {
        Surface::Facets { facets, law } => optics.atlas.as_ref().map(|atlas| (optics, atlas, facets, *law)),
        Surface::Smooth(_) => None,
    }
}

impl AtlasRenderer {
    /// Copies its planes to the buffer `atlas`, 4 bytes a texel and channel, which paste reads.
    pub fn render_into(&mut self, gpu: &Gpu, buffers: &mut Buffers) -> Result<()> {
        let (width, height) = self.layout.size();
        let Layout { side, columns, .. } = self.layout;
        let texel_count = width * height;
        let bytes = 4 * u64::from(texel_count) * self.frames.plan.planes.len() as u64;
        buffers.create(gpu, "atlas", bytes, BufferUsages::empty())?;
        self.frames.planes_copy = buffers.get("atlas").cloned();
        buffers.upload_uniform(gpu, "atlas_layout", &AtlasLayout { side, columns, width, texel_count })
    }

    /// The frame that shows the atlas, with the statistics of both.
    pub fn merged_into(self, frame: Rendered) -> Result<Rendered> {
        let own = self.frames.finish()?;
        let mut stages = own.stages;
        add_stages(&mut stages, &frame.stages);
        let (mut counts, mut passes) = (own.counts, own.passes);
        counts += frame.counts;
        let mut call = own.call;
        call += frame.call;
        passes.add(&frame.passes);
        let draws = own.draws.or(frame.draws);
        let (bytes, grown) = (own.bytes + frame.bytes, own.grown + frame.grown);
        Ok(Rendered { call, stages, counts, draws, bytes, grown, passes, ..frame })
    }
}

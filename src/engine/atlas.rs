//! The picture of all facets, rendered before the frame that shows them.

use super::{Engine, Rendered, RunOptions};
use crate::camera::Camera;
use crate::error::Result;
use crate::frame::{Channel, Plane};
use crate::gpu::Gpu;
use crate::gpu::buffers::Buffers;
use crate::gpu::rows::AtlasLayout;
use crate::optics::atlas::{Layout, camera as atlas_camera};
use crate::optics::{Atlas, Facets, Law, Optics, Surface};
use crate::plan::Wanted;
use crate::scene::Scene;

/// An atlas and what it took.
pub struct Painted {
    rendered: Rendered,
    layout: Layout,
}

impl Engine {
    /// The atlas of a camera that has one. Its planes are those of the frame, less the facets' own number, which is the last.
    pub(super) fn atlas(
        &mut self,
        scene: &Scene,
        camera: &Camera,
        wanted: &Wanted,
        run: &RunOptions,
    ) -> Result<Option<Painted>> {
        let Some((optics, atlas, facets, law)) = camera.optics.as_deref().and_then(parts) else { return Ok(None) };
        let mut channels = wanted.channels.clone();
        if wanted.srgb8 {
            channels.extend([Channel::R, Channel::G, Channel::B]);
        }
        channels.retain(|c| *c != Channel::MirrorId);
        channels.sort_unstable();
        channels.dedup();
        let wanted = Wanted { channels, srgb8: false, counting: wanted.counting };
        let painter = atlas_camera(optics, atlas, facets, law)?;
        let rendered = self.render(scene, &painter, &wanted, run)?;
        Ok(Some(Painted { rendered, layout: Layout::new(facets.triangles.len(), atlas.texels) }))
    }
}

fn parts(optics: &Optics) -> Option<(&Optics, &Atlas, &Facets, Law)> {
    match &optics.surface {
        Surface::Facets { facets, law } => optics.atlas.as_ref().map(|atlas| (optics, atlas, facets, *law)),
        Surface::Smooth(_) => None,
    }
}

impl Painted {
    /// `atlas`: its planes, 4 bytes a texel and channel; read by paste.
    pub fn upload(&self, gpu: &Gpu, buffers: &mut Buffers) -> Result<()> {
        let words = |plane: &Plane| match plane {
            Plane::F32(v) => v.iter().map(|v| v.to_bits()).collect::<Vec<u32>>(),
            Plane::U32(v) => v.clone(),
        };
        let all: Vec<u32> = self.rendered.frame.planes.iter().flat_map(|(_, plane)| words(plane)).collect();
        buffers.upload(gpu, "atlas", &all)?;
        let (width, height) = self.layout.size();
        let Layout { side, columns, .. } = self.layout;
        buffers.upload_uniform(gpu, "atlas_layout", &AtlasLayout { side, columns, width, texel_count: width * height })
    }

    /// The frame that shows the atlas, with what both took. Bringing the atlas from one to the other is not in it.
    pub fn joined(self, frame: Rendered) -> Rendered {
        let own = self.rendered;
        let mut stages = own.stages;
        for (name, ms) in frame.stages {
            match stages.iter_mut().find(|s| s.0 == name) {
                Some(sum) => sum.1 += ms,
                None => stages.push((name, ms)),
            }
        }
        let (a, b) = (own.counts, frame.counts);
        Rendered {
            frame_ms: own.frame_ms.iter().zip(&frame.frame_ms).map(|(a, b)| a + b).collect(),
            stages,
            counts: super::Counts {
                pairs_tested: a.pairs_tested + b.pairs_tested,
                pairs_kept: a.pairs_kept + b.pairs_kept,
                fragments_tested: a.fragments_tested + b.fragments_tested,
                fragments_kept: a.fragments_kept + b.fragments_kept,
                rechecked: a.rechecked + b.rechecked,
            },
            bytes: own.bytes.max(frame.bytes),
            grown: own.grown + frame.grown,
            passes: own.passes + frame.passes,
            ..frame
        }
    }
}

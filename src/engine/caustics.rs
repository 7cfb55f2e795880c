//! The caustics of a scene: photons by a frame of the light's camera, their triangles on the maps of the receivers.

use super::call_ms::ms_since;
use super::{Engine, RunOptions};
use crate::arrays::MapEach;
use crate::engine::plan::Wanted;
use crate::engine::stage::deposit::{CausticTriangles, Deposit};
use crate::geometry::scene_mesh::SceneMesh;
use crate::gpu::Gpu;
use crate::gpu::buffers::Buffers;
use crate::gpu::layout::{self, NONE};
use crate::input::Result;
use crate::scene::Scene;
use crate::scene::caustics::receiver_triangles::{ReceiverTriangle, ReceiverTriangles};
use crate::scene::caustics::{Caustics, CausticsReport, beams};
use std::sync::Arc;
use std::time::Instant;

/// The maps of a scene's receivers, on the device and here.
pub struct DeviceCaustics {
    caustics: Arc<Caustics>,
    mesh: Arc<SceneMesh>,
    /// `sums` and `receivers` as deposit left them; `receiver_triangle_of`, 4 bytes a triangle, and `receiver_triangles`, 48 bytes for each
    /// on a receiver. Read by gather.
    pub buffers: Buffers,
    #[cfg(feature = "internals")]
    maps: crate::scene::caustics::CausticMaps,
    pub report: CausticsReport,
}

impl DeviceCaustics {
    /// These are the maps of the scene.
    fn is_of(&self, scene: &Scene) -> bool {
        let is_same_mesh = || Arc::ptr_eq(&scene.mesh, &self.mesh) || scene.mesh == self.mesh;
        scene.caustics.as_ref().is_some_and(|c| Arc::ptr_eq(c, &self.caustics)) && is_same_mesh()
    }
}

impl Engine {
    /// The maps of the scene's receivers; `None` without caustics.
    #[cfg(feature = "internals")]
    pub fn caustic_maps(&mut self, scene: &Scene) -> Result<Option<&crate::scene::caustics::CausticMaps>> {
        let found = self.device_caustics(scene)?;
        Ok(self.caustics.as_deref().filter(|_| found.is_some()).map(|c| &c.maps))
    }

    /// The same with their buffers, kept until another scene comes.
    pub(super) fn device_caustics(&mut self, scene: &Scene) -> Result<Option<Arc<DeviceCaustics>>> {
        let Some(caustics) = scene.caustics.clone() else { return Ok(None) };
        // objects that a camera of a composite does not show are in the way of light, too
        let scene = &*scene.of_casters();
        if !self.caustics.as_ref().is_some_and(|known| known.is_of(scene)) {
            self.caustics = Some(Arc::new(self.deposit_caustics(scene, caustics)?));
        }
        Ok(self.caustics.clone())
    }

    fn deposit_caustics(&mut self, scene: &Scene, caustics: Arc<Caustics>) -> Result<DeviceCaustics> {
        let started = Instant::now();
        let (white, camera) = caustics.counting(scene);
        let wanted = Wanted::of(beams::CHANNELS.to_vec());
        let map = self.render(&white, &camera, &wanted, &RunOptions::default())?;
        let receiver_triangles = ReceiverTriangles::new(&caustics.receivers, &scene.mesh);
        let photons = caustics.photons(&scene.mesh, &receiver_triangles, &map.frame)?;
        let (list, budget) = caustics.caustic_triangles(&photons);
        let caustic_triangles = CausticTriangles::new(&caustics, &list)?;
        let mut buffers = Buffers::default();
        let sums = Deposit::new(&self.gpu)?.run(&caustic_triangles, &mut buffers)?;
        upload(&self.gpu, &receiver_triangles, &mut buffers)?;
        let maps = caustic_triangles.maps(&caustics, budget, &sums);
        let report = CausticsReport { budget: maps.budget, ms: ms_since(started) };
        Ok(DeviceCaustics {
            caustics,
            mesh: scene.mesh.clone(),
            buffers,
            #[cfg(feature = "internals")]
            maps,
            report,
        })
    }
}

fn upload(gpu: &Gpu, receiver_triangles: &ReceiverTriangles, buffers: &mut Buffers) -> Result<()> {
    let packed = |l: &ReceiverTriangle| {
        let [a, b, c] = l.corners;
        let [a, ab, ac] = [a, b - a, c - a].map_each(|v| v.as_vec2().to_array());
        layout::ReceiverTriangle { a, ab, ac, receiver: l.receiver, pad0: 0, diffuse: l.diffuse, pad1: 0 }
    };
    // the smallest buffer is larger than the list of a few triangles
    let mut of_triangle = receiver_triangles.of_triangle.clone();
    of_triangle.resize(of_triangle.len().max(LEAST), NONE);
    buffers.upload(gpu, "receiver_triangle_of", &of_triangle)?;
    buffers.upload(gpu, "receiver_triangles", &receiver_triangles.triangles.iter().map(packed).collect::<Vec<_>>())
}

/// Words of the smallest buffer.
const LEAST: usize = 64;

//! The caustics of a scene: photons by a frame of the light's camera, their triangles on the maps of the receivers.

use super::{Engine, RunOptions};
use crate::engine::plan::Wanted;
use crate::engine::stage::deposit::{Casts, Deposit};
use crate::geometry::mesh::Mesh;
use crate::gpu::Gpu;
use crate::gpu::buffers::Buffers;
use crate::gpu::layout::{self, NONE};
use crate::input::Result;
use crate::scene::Scene;
use crate::scene::caustics::landing::{Landing, Landings};
use crate::scene::caustics::{Account, Caustics, Illumination, beams};
use std::sync::Arc;
use std::time::Instant;

/// The maps of a scene's receivers, on the device and here.
pub struct Illuminated {
    caustics: Arc<Caustics>,
    mesh: Arc<Mesh>,
    /// `sums` and `receivers` as deposit left them; `landing_of`, 4 bytes a triangle, and `landings`, 48 bytes for each on a
    /// receiver. Read by gather.
    pub buffers: Buffers,
    pub illumination: Illumination,
    pub account: Account,
}

impl Illuminated {
    /// These are the maps of the scene.
    fn is_of(&self, scene: &Scene) -> bool {
        scene.caustics.as_ref().is_some_and(|c| Arc::ptr_eq(c, &self.caustics)) && scene.mesh == self.mesh
    }
}

impl Engine {
    /// The maps of the scene's receivers; `None` without caustics.
    pub fn illuminate(&mut self, scene: &Scene) -> Result<Option<&Illumination>> {
        let lit = self.illuminated(scene)?;
        Ok(self.lit.as_deref().filter(|_| lit.is_some()).map(|lit| &lit.illumination))
    }

    /// The same with their buffers, kept until another scene comes.
    pub(super) fn illuminated(&mut self, scene: &Scene) -> Result<Option<Arc<Illuminated>>> {
        let Some(caustics) = scene.caustics.clone() else { return Ok(None) };
        if !self.lit.as_ref().is_some_and(|lit| lit.is_of(scene)) {
            self.lit = Some(Arc::new(self.light(scene, caustics)?));
        }
        Ok(self.lit.clone())
    }

    fn light(&mut self, scene: &Scene, caustics: Arc<Caustics>) -> Result<Illuminated> {
        let started = Instant::now();
        let (white, camera) = caustics.counting(scene);
        let wanted = Wanted::of(beams::CHANNELS.to_vec());
        let map = self.render(&white, &camera, &wanted, &RunOptions::default())?;
        let landings = Landings::new(&caustics.receivers, &scene.mesh);
        let photons = caustics.photons(&scene.mesh, &landings, &map.frame)?;
        let (list, budget) = caustics.casts(&photons);
        let casts = Casts::new(&caustics, &list)?;
        let mut buffers = Buffers::default();
        let sums = Deposit::new(&self.gpu).run(&casts, &mut buffers)?;
        upload(&self.gpu, &landings, &mut buffers)?;
        let illumination = casts.illumination(&caustics, budget, &sums);
        let account = Account { budget: illumination.budget, ms: started.elapsed().as_secs_f64() * 1e3 };
        Ok(Illuminated { caustics, mesh: scene.mesh.clone(), buffers, illumination, account })
    }
}

fn upload(gpu: &Gpu, landings: &Landings, buffers: &mut Buffers) -> Result<()> {
    let row = |l: &Landing| {
        let [a, b, c] = l.corners;
        let [a, ab, ac] = [a, b - a, c - a].map(|v| v.as_vec2().to_array());
        layout::Landing { a, ab, ac, receiver: l.receiver, pad0: 0, diffuse: l.diffuse, pad1: 0 }
    };
    // the smallest buffer is larger than the list of a few triangles
    let mut of_triangle = landings.of_triangle.clone();
    of_triangle.resize(of_triangle.len().max(LEAST), NONE);
    buffers.upload(gpu, "landing_of", &of_triangle)?;
    buffers.upload(gpu, "landings", &landings.rows.iter().map(row).collect::<Vec<_>>())
}

/// Words of the smallest buffer.
const LEAST: usize = 64;

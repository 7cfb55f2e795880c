//! Where a point lies in the picture of a camera, as kernels find it: the image in patches ([`patch`]), in each of which origins and
//! directions of rays are bilinear, and a tree of boxes around these ([`pack`]). Newton's method finds the place in a patch.
//!
//! A patch is halved until that method, from its middle, ends within 1/64 px of the camera's own ray wherever it was tried: one
//! patch is enough for a pinhole, and a panorama takes thousands.

mod pack;
mod patch;
#[cfg(test)]
mod tests;

use crate::camera::Camera;
use crate::input::{Error, Result};
use crate::scene::Scene;
use glam::DVec3;
use pack::{HEADER_ROWS, Packing};
use patch::Patches;
use std::sync::Arc;

/// The patches of all pictures of a scene, and what they were made for.
#[derive(Clone)]
pub struct ScenePictures {
    /// One a picture; the same for the same camera.
    all: Vec<(Arc<Camera>, Arc<Patches>)>,
    bounds: Option<(DVec3, DVec3)>,
}

impl ScenePictures {
    /// Those of `last` are taken over where camera and scene are the same.
    ///
    /// # Errors
    /// Those of [`Patches::new`].
    pub fn of(scene: &Scene, last: Option<&ScenePictures>) -> Result<ScenePictures> {
        let bounds = scene.bounds();
        let mut all: Vec<(Arc<Camera>, Arc<Patches>)> = Vec::new();
        for (k, light) in scene.projector_lights.iter().enumerate() {
            let known = last.filter(|last| last.bounds == bounds).map_or(&[][..], |last| &last.all[..]);
            let is_same = |(camera, _): &&(Arc<Camera>, Arc<Patches>)| Arc::ptr_eq(camera, &light.camera);
            let patches = match known.iter().find(is_same).or_else(|| all.iter().find(is_same)) {
                Some((_, patches)) => patches.clone(),
                None => {
                    let at = |e: Error| e.at(format_args!("projector_light.{k}"));
                    Arc::new(Patches::new(&light.camera, bounds).map_err(at)?)
                }
            };
            all.push((light.camera.clone(), patches));
        }
        Ok(ScenePictures { all, bounds })
    }

    /// Returns `false` only if no ray of a picture meets a box.
    pub fn may_reach(&self, picture: usize, bounds: (DVec3, DVec3)) -> bool {
        let patches = &self.all[picture].1;
        let size = self.bounds.map_or(0.0, |(lo, hi)| (hi - lo).length());
        patches.root.may_meet(patches.t_range, bounds, size)
    }

    /// The rows of all pictures as kernels read them, the first of which will be row `first`: headers, nodes and patches. Positions are
    /// relative to `anchor`; `material` is the index of the first picture's.
    pub fn rows(&self, scene: &Scene, anchor: DVec3, first: u32, material: u32) -> Vec<[f32; 4]> {
        let mut rows = vec![[0.0; 4]; HEADER_ROWS as usize * self.all.len()];
        for (k, (light, (_, patches))) in scene.projector_lights.iter().zip(&self.all).enumerate() {
            let packing = Packing::new(patches, scene.bounds(), anchor);
            let nodes_first = first + rows.len() as u32;
            let nodes = packing.nodes(&patches.root, nodes_first);
            let header = packing.header(light, [material + k as u32, nodes_first, nodes.count]);
            rows[HEADER_ROWS as usize * k..][..HEADER_ROWS as usize].copy_from_slice(&header);
            rows.extend(nodes.rows);
        }
        rows
    }
}

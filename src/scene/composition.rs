//! The scene as each camera of a composite sees it.

use super::Scene;
use crate::camera::composition::Composition;
use crate::geometry::mesh::Mesh;
use std::borrow::Cow;

impl Scene {
    /// For each camera of a composite the scene with the objects that the camera shows. Other triangles keep their ids, and have no area;
    /// shadows are still those of all.
    pub fn of_each_camera(&self, composition: &Composition) -> Vec<Cow<'_, Scene>> {
        let ends = self.objects.iter().map(|object| object.triangles);
        let seen = |shows: Vec<bool>| -> Cow<'_, Scene> {
            if shows.iter().all(|is_shown| *is_shown) {
                return Cow::Borrowed(self);
            }
            let mut mesh = Mesh::clone(&self.mesh);
            let mut first = 0;
            for (count, is_shown) in ends.clone().zip(shows) {
                if !is_shown {
                    hide(&mut mesh, first..first + count);
                }
                first += count;
            }
            let casters = self.casters.clone().unwrap_or_else(|| self.mesh.clone());
            Cow::Owned(Scene { mesh: mesh.into(), casters: Some(casters), ..self.clone() })
        };
        composition.shows(&self.objects).into_iter().map(seen).collect()
    }

    /// The scene that casts shadows.
    pub fn of_casters(&self) -> Cow<'_, Scene> {
        match &self.casters {
            Some(mesh) => Cow::Owned(Scene { mesh: mesh.clone(), casters: None, ..self.clone() }),
            None => Cow::Borrowed(self),
        }
    }
}

/// Takes the area of these triangles, and the radius of these spheres.
fn hide(mesh: &mut Mesh, ids: std::ops::Range<usize>) {
    let end = ids.end.min(mesh.triangles.len());
    let ids = ids.start.min(end)..end;
    mesh.triangles[ids.clone()].iter_mut().for_each(|corners| *corners = [corners[0]; 3]);
    mesh.radii.iter_mut().take(end).skip(ids.start).for_each(|radius| *radius = 0.0);
}

//! Objects that the pictures of projector lights may reach.

use super::objects::Objects;
use crate::engine::plan::pictures::ScenePictures;
use crate::parallel;
use crate::scene::Scene;
use crate::scene::projector_light::{Mode, ProjectorLight};
use std::sync::OnceLock;

/// The beams of a scene's projector lights, looked at when a frame first asks.
#[derive(Default)]
pub struct Beams(OnceLock<Option<Reach>>);

struct Reach {
    pictures: ScenePictures,
    /// Of each light, whether its picture may reach each object.
    objects: Vec<Vec<bool>>,
}

impl Beams {
    /// Returns for each light whether its picture may reach each object; `None` if that is not known.
    pub fn reached(&self, scene: &Scene, objects: &Objects) -> Option<&[Vec<bool>]> {
        let reach = self.0.get_or_init(|| {
            let pictures = ScenePictures::of(scene, None).ok()?;
            let objects = objects.of(scene);
            let of_light = |(k, light): (usize, &std::sync::Arc<ProjectorLight>)| match shows_nothing(light) {
                true => vec![false; objects.len()],
                false => parallel::map(objects, |object| pictures.may_reach(k, object.bounds)),
            };
            let objects = scene.projector_lights.iter().enumerate().map(of_light).collect();
            Some(Reach { pictures, objects })
        });
        reach.as_ref().map(|reach| reach.objects.as_slice())
    }

    /// The patches of all pictures, where they are known.
    pub fn pictures(&self) -> Option<&ScenePictures> {
        self.0.get().and_then(Option::as_ref).map(|reach| &reach.pictures)
    }
}

/// The picture changes no surface that it reaches.
fn shows_nothing(light: &ProjectorLight) -> bool {
    let is_black = || light.picture.texels.rgba.iter().all(|[r, g, b, _]| [r, g, b].iter().all(|c| c.to_f32() == 0.0));
    light.throw.strength == 0.0 || light.throw.mode == Mode::Light && is_black()
}

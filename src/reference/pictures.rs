//! Pictures thrown onto surfaces, by the definition: a hit is projected into the camera of each.

use super::light::Above;
use crate::camera::bundle::Ray;
use crate::camera::project::{Image, Projector};
use crate::camera::{Camera, Rays};
use crate::scene::Scene;
use crate::scene::projector_light::{Mode, ProjectorLight};
use glam::{DVec2, DVec3};
use std::fmt;

/// A scene's pictures, with the projections into their cameras.
#[derive(Default)]
pub struct Pictures<'a> {
    all: Vec<(&'a ProjectorLight, Projector<'a>)>,
}

impl fmt::Debug for Pictures<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} pictures", self.all.len())
    }
}

/// What a picture shows at a hit that it reaches.
pub struct Shown<'a> {
    pub light: &'a ProjectorLight,
    /// Linear RGB, between the picture's pixels bilinear.
    pub colour: DVec3,
    /// Of the strip along the picture's border: 0 to 1.
    pub share: f64,
    /// Unit direction to the start of the ray that shows the hit, and how far away that is.
    pub to_start: DVec3,
    pub far: f64,
    /// Between the surface's normal and that direction, above 0.
    pub cosine: f64,
}

impl<'a> Pictures<'a> {
    pub fn of(scene: &'a Scene) -> Pictures<'a> {
        let indexed = |light: &'a std::sync::Arc<ProjectorLight>| (&**light, Projector::new(&light.camera));
        Pictures { all: scene.projector_lights.iter().map(indexed).collect() }
    }

    /// Those that reach a hit at `p` with the unit normal `n`.
    pub fn at(&self, above: &Above, p: DVec3, n: DVec3) -> Vec<Shown<'a>> {
        self.all.iter().filter_map(|(light, projector)| shown(light, projector, above, p, n)).collect()
    }
}

fn shown<'a>(light: &'a ProjectorLight, projector: &Projector, above: &Above, p: DVec3, n: DVec3) -> Option<Shown<'a>> {
    let camera = &light.camera;
    let image = projector.project(p).images.into_iter().min_by(|a, b| a.t.total_cmp(&b.t))?;
    let ray = ray_of(camera, &image)?;
    let start = ray.origin + camera.t_range[0] * ray.direction;
    let far = (start - p).length();
    let to_start = (start - p).try_normalize()?;
    let cosine = n.dot(to_start);
    if cosine <= 0.0 || light.throw.occlusion && !above.sees(to_start, far) {
        return None;
    }
    let size = DVec2::new(camera.width.into(), camera.height.into());
    let place = DVec2::new(image.x, image.y);
    let inside = place.min(size - place).min_element();
    let share = if light.throw.feather > 0.0 { (inside / light.throw.feather).clamp(0.0, 1.0) } else { 1.0 };
    let [r, g, b, _] = light.picture.at(DVec2::new(image.a, 1.0 - image.b));
    (share > 0.0).then_some(Shown { light, colour: DVec3::new(r, g, b), share, to_start, far, cosine })
}

/// The ray that an image of a point lies on.
fn ray_of(camera: &Camera, image: &Image) -> Option<Ray> {
    let place = DVec2::new(image.x, image.y);
    match &camera.layers[0] {
        Rays::Pieces(pieces) => Some(pieces.bundle_at_place(image.piece, place).ray(0.0, 0.0)),
        Rays::Field(field) => field.ray_at(place),
        Rays::Curves(_) => None,
    }
}

/// A colour under pictures: what of it is lit, and what is seen as it is.
pub fn painted(colour: DVec3, shown: &[Shown]) -> [DVec3; 2] {
    let (mut bare, mut weights, mut lit, mut seen) = (1.0, 0.0, DVec3::ZERO, DVec3::ZERO);
    for s in shown {
        let throw = s.light.throw;
        let cover = throw.strength * s.share;
        let weight = cover * s.cosine.powf(throw.angle_power) * s.far.powf(-throw.distance_power);
        match throw.mode {
            Mode::Light => continue,
            Mode::Paint => lit += weight * s.colour,
            Mode::Show => seen += weight * s.colour,
        }
        bare *= 1.0 - cover;
        weights += weight;
    }
    if weights == 0.0 {
        return [colour, DVec3::ZERO];
    }
    let cover = (1.0 - bare) / weights;
    [bare * colour + cover * lit, cover * seen]
}

impl Shown<'_> {
    /// Irradiance over pi at normal incidence, if it is a light.
    pub fn strength(&self) -> Option<DVec3> {
        let throw = self.light.throw;
        let falloff = throw.distance.map_or(1.0, |distance| (distance / self.far).powi(2));
        self.light.is_light().then_some(throw.strength * self.share * falloff * self.colour)
    }
}

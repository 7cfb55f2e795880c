//! Whether a picture, or a shadow, is where it is at a hit whatever is rounded: the decisions of the definition, taken again for hits and
//! places beside it, as far away as `docs/reference/definitions.md` allows them to be.

use anamorph::internals::camera::bundle::{Bundle, Ray};
use anamorph::internals::camera::project::{Image, Projector};
use anamorph::internals::camera::{Camera, Rays};
use anamorph::internals::image::frame::{Channel, Frame, NO_ID};
use anamorph::internals::reference::Reference;
use anamorph::internals::scene::Scene;
use anamorph::internals::scene::projector_light::ProjectorLight;
use glam::{DVec2, DVec3};

/// Places in a picture are found within this, px.
const PLACE_PX: f64 = 1.0 / 64.0;

/// Where pieces of its camera meet, or its image ends inside of a pixel, so much of it is shown by the rays of one of them, px.
const PIECE_PX: f64 = 0.5;

/// Of t, relative to the scene's extent: what the tests of triangles require at the 99.9th of a hundred pixels.
const T_ERROR: f64 = 1e-5;

/// Offsets of shadow rays above the hit, relative to the largest coordinate: the reference's and the kernels'.
const ABOVE: [f64; 2] = [1e-9, 4e-6];

/// Of the cosine between f32 normals and directions: some 16 roundings.
const COSINE_ERROR: f64 = 16.0 / 16_777_216.0;

/// Two places of a picture whose t differ by less are in one order for f32's sums of some ten terms, or in the other.
const TIE: f64 = 1e-5;

const AROUND: [(f64, f64); 8] =
    [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0), (1.0, 1.0), (-1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)];

/// A picture, its projection, and the rays of its pixels with those to the right and below.
struct Thrower<'a> {
    light: &'a ProjectorLight,
    projector: Projector<'a>,
    rays: Vec<[Ray; 3]>,
}

/// A surface as it is at a hit.
struct Place {
    /// The hit, and hits beside it that it may be taken for.
    hits: Vec<DVec3>,
    /// Those of the pixels to the left, right, above and below.
    around: Vec<DVec3>,
    /// Unit normals on the viewer's side, for shading and the triangle's own.
    n: DVec3,
    flat: DVec3,
}

/// The scene that a camera sees.
pub struct Decisions<'a> {
    scene: &'a Scene,
    camera: &'a Camera,
    reference: Reference<'a>,
    throwers: Vec<Thrower<'a>>,
    /// How far a hit may be off, world units.
    off: f64,
}

impl<'a> Decisions<'a> {
    pub fn of(scene: &'a Scene, camera: &'a Camera) -> Decisions<'a> {
        let (lo, hi) = scene.bounds().unwrap();
        let throwers = scene.projector_lights.iter().map(|light| Thrower::of(light)).collect();
        Decisions { scene, camera, reference: Reference::of_scene(scene), throwers, off: T_ERROR * (hi - lo).length() }
    }

    /// Whether all decisions at a pixel are the same beside it. `truth` has the triangle, the position and the normal of each.
    pub fn are_sure(&self, truth: &Frame, k: usize) -> bool {
        let ids = truth.u32(Channel::TriangleId).unwrap();
        let id = ids[k];
        if id == NO_ID || id as usize >= self.scene.mesh.triangles.len() {
            // nothing, or the camera's own mirror
            return true;
        }
        let vector = |k: usize, of: [Channel; 3]| DVec3::from(of.map(|c| f64::from(truth.f32(c).unwrap()[k])));
        let position = |k: usize| vector(k, [Channel::PositionX, Channel::PositionY, Channel::PositionZ]);
        let (x, n) = (position(k), vector(k, [Channel::NormalX, Channel::NormalY, Channel::NormalZ]));
        let width = self.camera.width as usize;
        let around = [
            (!k.is_multiple_of(width)).then(|| k - 1),
            Some(k + 1).filter(|k| !k.is_multiple_of(width)),
            k.checked_sub(width),
            Some(k + width),
        ];
        let is_hit = |k: &usize| ids.get(*k).is_some_and(|id| *id != NO_ID);
        let moment = self.scene.moment(self.camera, ((k % width) as u32, (k / width) as u32));
        let reference = self.reference.at(moment);
        let [a, b, c] = self.scene.corners_at(id, moment);
        let flat = (b - a).cross(c - a).normalize();
        let flat = if flat.dot(n) < 0.0 { -flat } else { flat };
        let right = flat.any_orthonormal_vector();
        let beside = AROUND.map(|(u, v)| x + self.off * (u * right + v * flat.cross(right)));
        let around = around.into_iter().flatten().filter(is_hit).map(position).collect();
        let place = Place { hits: [&[x], &beside[..]].concat(), around, n, flat };
        self.throwers.iter().all(|thrower| thrower.is_sure(&reference, &place))
            && self.scene.lights.iter().filter(|light| light.casts_shadows).all(|light| {
                let ways = place.hits.iter().map(|x| light.arriving(*x)).map(|a| (a.to_light, a.far)).collect();
                place.sees(&reference, &place.hits, ways).is_some()
            })
    }
}

impl Thrower<'_> {
    fn of(light: &ProjectorLight) -> Thrower<'_> {
        let camera = &light.camera;
        let pixels = (0..camera.height).flat_map(|j| (0..camera.width).map(move |i| (i, j)));
        let rays = |(i, j)| {
            let (_, bundle) = camera.pixel(0, i, j)?;
            Some([bundle.ray(0.0, 0.0), bundle.ray(1.0, 0.0), bundle.ray(0.0, 1.0)])
        };
        Thrower { light, projector: Projector::new(camera), rays: pixels.filter_map(rays).collect() }
    }

    /// The image with the least t, and whether none has almost the same.
    fn image(&self, x: DVec3) -> Option<(Image, bool)> {
        let mut images = self.projector.project(x).images;
        images.sort_by(|a, b| a.t.total_cmp(&b.t));
        let first = *images.first()?;
        Some((first, images.get(1).is_none_or(|next| next.t - first.t > TIE * next.t.abs())))
    }

    /// The part of the camera that an image place lies in, and its ray.
    fn ray(&self, place: DVec2) -> Option<(u32, Ray)> {
        let camera = &self.light.camera;
        match &camera.layers[0] {
            Rays::Pieces(pieces) => {
                let pixel = place.floor().min(DVec2::new(camera.width.into(), camera.height.into()) - 1.0);
                let piece = pieces.owner_of_place(pixel.x as u32, pixel.y as u32, place)?;
                Some((piece, pieces.bundle_at_place(piece, place).ray(0.0, 0.0)))
            }
            Rays::Field(field) => Some((0, field.ray_at(place)?)),
            Rays::Curves(_) => None,
        }
    }

    /// Whether a point that the picture does not reach is farther than half a pixel from every one of its pixels.
    fn is_far_from(&self, x: DVec3) -> bool {
        let [first, last] = self.light.camera.t_range;
        self.rays.iter().all(|rays| {
            let [ray, ..] = rays;
            let t = ((x - ray.origin).dot(ray.direction) / ray.direction.length_squared()).clamp(first, last);
            let [at, right, down] = [0, 1, 2].map(|k| rays[k].origin + t * rays[k].direction);
            // a pixel's own corner is 0.71 px from its centre
            at.distance(x) > (0.75 + PIECE_PX) * at.distance(right).max(at.distance(down))
        })
    }

    fn is_sure(&self, reference: &Reference, place: &Place) -> bool {
        let camera = &self.light.camera;
        let size = DVec2::new(camera.width.into(), camera.height.into());
        let x = place.hits[0];
        let Some((image, is_alone)) = self.image(x) else { return self.is_far_from(x) };
        let at = DVec2::new(image.x, image.y);
        let beside = |px: f64| AROUND.map(|by| self.ray((at + px * DVec2::from(by)).clamp(DVec2::ZERO, size)));
        let Some((part, ray)) = self.ray(at) else { return false };
        if !is_alone || !beside(PIECE_PX).iter().all(|found| found.is_some_and(|(other, _)| other == part)) {
            return false;
        }
        // what a pixel covers is filtered with texels as large: it must not reach beyond the picture's border, where that is clamped
        let inside = at.min(size - at).min_element();
        let reaches =
            |x: &DVec3| self.image(*x).is_none_or(|(next, _)| at.distance(DVec2::new(next.x, next.y)) > inside);
        if place.around.iter().any(reaches) {
            return false;
        }
        // from hits beside this one to where the ray starts, and from it along the rays of places beside its own
        let start = ray.origin + camera.t_range[0] * ray.direction;
        let far = start.distance(x);
        let to_start = |x: &DVec3| ((start - *x).normalize(), start.distance(*x));
        let along = beside(PLACE_PX).into_iter().flatten().map(|(_, ray)| (-ray.direction.normalize(), far));
        let ways: Vec<(DVec3, f64)> = place.hits.iter().map(to_start).chain(along).collect();
        let hits: Vec<DVec3> = (0..ways.len()).map(|k| *place.hits.get(k).unwrap_or(&x)).collect();
        let Some(is_before) = same(ways.iter().map(|(l, _)| sign(place.n.dot(*l)))) else { return false };
        !is_before || !self.light.throw.occlusion || place.sees(reference, &hits, ways).is_some()
    }
}

impl Place {
    /// Whether nothing is in the way from these hits, if that is the same for all.
    fn sees(&self, reference: &Reference, hits: &[DVec3], ways: Vec<(DVec3, f64)>) -> Option<bool> {
        let is_open = |(x, (l, far)): (&DVec3, (DVec3, f64))| {
            if !sign(self.flat.dot(l))? {
                return Some(false);
            }
            let size = x.abs().max_element();
            let met = ABOVE.map(|above| reference.hit(&line(*x + above * size * self.flat, l), [0.0, far]).is_some());
            (met[0] == met[1]).then_some(!met[0])
        };
        same(hits.iter().zip(ways).map(is_open))
    }
}

/// Whether it is above 0, if rounding leaves no doubt.
fn sign(cosine: f64) -> Option<bool> {
    (cosine.abs() > COSINE_ERROR).then_some(cosine > 0.0)
}

/// What all of them are, if that is the same.
fn same(mut all: impl Iterator<Item = Option<bool>>) -> Option<bool> {
    let first = all.next()??;
    all.all(|next| next == Some(first)).then_some(first)
}

fn line(from: DVec3, direction: DVec3) -> Bundle {
    let zero = DVec3::ZERO;
    Bundle { p: [from, zero, zero], d: [direction, zero, zero], h: [1.0, 0.0, 0.0] }
}

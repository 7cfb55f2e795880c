//! Motion vectors: the image position, in another frame, of the surface point that a pixel shows. Camera and scene may both move.

use crate::camera::project::Projector;
use crate::camera::{Camera, Rays};
use crate::geometry::primitive::Primitive;
use crate::image::frame::{Channel, Frame, NO_ID};
use crate::input::{Error, Result};
use crate::parallel;
use crate::scene::Scene;
use glam::{DVec2, DVec3};

/// The channels that motion needs.
pub const NEEDED: [Channel; 4] = [Channel::T, Channel::TriangleId, Channel::BaryU, Channel::BaryV];

/// Names in an EXR file.
pub const NAMES: [&str; 2] = ["motion.X", "motion.Y"];

/// Motion of each pixel of `frame`, rendered from `now`, to the image of `next`: right and down, px. The same point of the same triangle is
/// projected, and of a sphere the place that keeps its offset from the centre, where it is one frame after the pixel's own time. Of several images the nearest counts, hidden or not. 0 where nothing is
/// hit. NaN where `next` has no image of it, or the search was given up ([`crate::camera::project::Images::incomplete`]).
///
/// # Errors
/// [`Error::Input`] if the camera has a mirror or lens, the triangles are not the same, or the frame lacks one of [`NEEDED`].
pub fn motion(now: (&Scene, &Camera), next: (&Scene, &Camera), frame: &Frame) -> Result<[Vec<f32>; 2]> {
    let ((scene, camera), (next_scene, next_camera)) = (now, next);
    if camera.optics.is_some() || next_camera.optics.is_some() {
        let kind = camera.kind;
        return Err(Error::input(format!("motion is not computed through mirrors and lenses; {kind} has one")));
    }
    let has_master = |camera: &Camera| camera.composition.as_ref().is_some_and(|c| c.master.is_some());
    if has_master(camera) || has_master(next_camera) {
        return Err(Error::input("motion is through one camera; a composite with master has several"));
    }
    scene.mesh.check_copies(scene.limits)?;
    next_scene.mesh.check_copies(next_scene.limits)?;
    if (&scene.mesh.triangles, &scene.mesh.radii) != (&next_scene.mesh.triangles, &next_scene.mesh.radii) {
        return Err(Error::input("motion is of triangles that are the same in both frames; these are not"));
    }
    let f32s = |channel: Channel| frame.f32(channel);
    let needed = (f32s(Channel::T), frame.u32(Channel::TriangleId), f32s(Channel::BaryU), f32s(Channel::BaryV));
    let (Some(t), Some(ids), Some(u), Some(v)) = needed else {
        return Err(Error::input("motion needs t, triangle.id and bary"));
    };
    let projector = Projector::new(next_camera);
    let width = camera.width as usize;
    let moved = |k: usize| {
        if ids[k] == NO_ID {
            return DVec2::ZERO;
        }
        let (i, j) = ((k % width) as u32, (k / width) as u32);
        let primitive = |scene: &Scene, camera: &Camera| scene.primitive_at(ids[k], scene.moment(camera, (i, j)));
        let own = DVec2::new(f64::from(i) + 0.5, f64::from(j) + 0.5);
        let step_to = |place: DVec3| {
            let places = projector.project(place).images;
            let steps = places.iter().map(|image| DVec2::new(image.x, image.y) - own);
            steps.min_by(|a, b| a.length_squared().total_cmp(&b.length_squared())).unwrap_or(DVec2::NAN)
        };
        match (primitive(scene, camera), primitive(next_scene, next_camera)) {
            (Primitive::Triangle(corners), Primitive::Triangle([a, b, c])) => {
                let found = weights(camera, (i, j), layer_of(t[k]), corners);
                let [u, v] = found.unwrap_or([u[k].into(), v[k].into()]);
                step_to(a + u * (b - a) + v * (c - a))
            }
            (Primitive::Round(now), Primitive::Round(then)) => {
                point(camera, (i, j), t[k]).map_or(DVec2::NAN, |p| step_to(now.moved_to(&then, p)))
            }
            _ => DVec2::NAN,
        }
    };
    let steps: Vec<DVec2> = parallel::map(0..ids.len(), moved);
    Ok([steps.iter().map(|s| s.x as f32).collect(), steps.iter().map(|s| s.y as f32).collect()])
}

/// The layer whose segment ends at or after t.
fn layer_of(t: f32) -> usize {
    (t.ceil() - 1.0).max(0.0) as usize
}

/// The point at t of a pixel's path, the t of the whole path.
fn point(camera: &Camera, (i, j): (u32, u32), t: f32) -> Option<DVec3> {
    let layer = if camera.layers.len() > 1 { layer_of(t) } else { 0 };
    let t = f64::from(t) - layer as f64;
    if let Rays::Curves(curves) = &camera.layers[layer] {
        return Some(curves.near(i, j, (0.0, 0.0))?.1.at(t));
    }
    let ray = camera.pixel(layer, i, j)?.1.ray(0.0, 0.0);
    Some(ray.origin + t * ray.direction)
}

/// Weights of the second and third corner where a pixel's ray meets a triangle's plane, to f64; `None` of curves, and of rays that run
/// along it.
fn weights(camera: &Camera, (i, j): (u32, u32), layer: usize, [a, b, c]: [DVec3; 3]) -> Option<[f64; 2]> {
    let layer = if camera.layers.len() > 1 { layer } else { 0 };
    if camera.is_curved() {
        return None;
    }
    let ray = camera.pixel(layer, i, j)?.1.ray(0.0, 0.0);
    let side = |from: DVec3, to: DVec3| (from - ray.origin).cross(to - from).dot(ray.direction);
    let e = [side(b, c), side(c, a), side(a, b)];
    let sum = e[0] + e[1] + e[2];
    (sum != 0.0).then(|| [e[1] / sum, e[2] / sum])
}

//! Every pixel's ray as one that starts where `t_range` does, of unit length, and the scale of the world that suits them.

use super::REACH;
use crate::camera::{Camera, Ray, Rays as Layer};
use glam::DVec3;

pub struct Rays {
    /// A pixel's start and unit direction, row by row from the top. A pixel without a ray has one that meets nothing.
    pub each: Vec<Ray>,
    /// Where all rays end, world units from their starts; `None`: nowhere.
    pub length: Option<f64>,
    /// POV-Ray's units a world unit, a power of two.
    pub scale: f64,
}

/// How much two rays may differ in length that are of one, relative: the roundings of P, D and of a root, 16 at most.
const LENGTH_ROUNDING: f64 = 16.0 * f64::EPSILON;

/// The camera's rays through a scene in the box from `bounds.0` to `bounds.1`.
///
/// # Errors
/// What POV-Ray cannot express.
pub fn of(camera: &Camera, bounds: Option<(DVec3, DVec3)>) -> Result<Rays, String> {
    straight(camera)?;
    let [t_min, t_max] = camera.t_range;
    if t_min == f64::NEG_INFINITY {
        return Err("t_range starts at -inf, where no ray of POV-Ray can; give a finite start".into());
    }
    let (lo, hi) = bounds.unwrap_or_default();
    let (centre, radius) = (lo.midpoint(hi), lo.distance(hi) / 2.0);
    // outwards from a corner of the box
    let nothing = Ray { origin: hi, direction: DVec3::ONE.normalize() };
    let mut each = Vec::with_capacity(camera.width as usize * camera.height as usize);
    let (mut reach, mut is_cut, mut lengths) = (radius, false, [f64::INFINITY, 0.0f64]);
    for (j, i) in (0..camera.height).flat_map(|j| (0..camera.width).map(move |i| (j, i))) {
        let ray = camera.pixel(0, i, j).map(|(_, bundle)| bundle.ray(0.0, 0.0));
        let Some(Ray { origin, direction }) = ray.filter(|ray| ray.direction != DVec3::ZERO) else {
            each.push(nothing);
            continue;
        };
        let start = origin + t_min * direction;
        let farthest = start.distance(centre) + radius;
        if !farthest.is_finite() {
            return Err(format!("the ray of pixel {i},{j} starts too far away; give t_range a nearer start"));
        }
        // a direction of any length
        let largest = direction.abs().max_element();
        let (direction, speed) = (direction / largest).normalize_and_length();
        let length = (t_max - t_min) * largest * speed;
        reach = reach.max(farthest);
        is_cut |= length <= farthest;
        lengths = [lengths[0].min(length), lengths[1].max(length)];
        each.push(Ray { origin: start, direction });
    }
    let one_length = lengths[0] > 0.0 && lengths[1] - lengths[0] <= LENGTH_ROUNDING * lengths[1];
    if is_cut && !one_length {
        return Err(format!(
            "t_range ends at {t_max}, in pixels at other distances, where POV-Ray ends all rays at one; end it behind the scene"
        ));
    }
    let scale = Some((REACH / reach).log2().floor().exp2()).filter(|s| s.is_normal());
    Ok(Rays { each, length: is_cut.then_some(lengths[1]), scale: scale.unwrap_or(1.0) })
}

/// The camera has straight rays, one per pixel.
fn straight(camera: &Camera) -> Result<(), String> {
    let (kind, layers) = (camera.kind, camera.layers.len());
    if camera.optics.is_some() {
        Err(format!("{kind} reflects or refracts rays, which POV-Ray's cameras cannot represent"))
    } else if camera.layers.iter().any(|l| matches!(l, Layer::Curves(_))) {
        Err(format!("{kind} has a curve for each pixel, where POV-Ray has straight rays"))
    } else if layers != 1 {
        Err(format!("{kind} has {layers} layers, where POV-Ray has one ray for each pixel"))
    } else {
        Ok(())
    }
}

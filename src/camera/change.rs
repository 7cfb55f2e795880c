//! How the ray of each pixel changes with a number of the camera: `docs/reference/definitions.md`, Gradients.
//!
//! A camera's rays are a function of its numbers that only its kind knows. The derivative is taken from rays at six values of the
//! number, by central differences over three steps, extrapolated to a step of 0 (Richardson 1911): what is left is of the sixth power of the step.
//! How far the last extrapolation moved the result is a bound on the error of the one before it, and is kept.

use super::{Camera, Ray, Rays, lattice};
use crate::arrays::MapEach;
use crate::input::{Error, Result};
use crate::parallel;
use glam::{DVec2, DVec3};

/// Numbers of a [`PixelRay`].
pub const NUMBERS: usize = 18;

/// The ray of a pixel's centre: P and D; the change of both over the pixel from left to right, and from top to bottom. Three coordinates
/// each, world axes and units. NaN where there is none.
pub type PixelRay = [f64; NUMBERS];

/// No ray.
pub const NO_RAY: PixelRay = [f64::NAN; NUMBERS];

/// The derivative of the rays of all pixels with respect to a number.
#[derive(Debug, Clone)]
pub struct Rate {
    /// Row by row; NaN where a pixel has no ray at the values about the number.
    pub rays: Vec<PixelRay>,
    /// The largest step from the number to both sides.
    pub step: f64,
    /// Bounds on the absolute error of the derivatives of P and of D.
    pub error: [f64; 2],
}

/// Which formula a pixel's ray is of: that of a piece, or of a part of a field.
#[derive(Debug, Clone, Copy)]
enum Owner {
    Piece(u32),
    Part(usize),
}

/// Half a pixel to the right, and downwards.
const SIDES: [DVec2; 2] = [DVec2::new(0.5, 0.0), DVec2::new(0.0, 0.5)];

impl Camera {
    /// The formula of pixel `(i, j)`.
    fn owner(&self, (i, j): (u32, u32)) -> Option<Owner> {
        match self.layers.as_slice() {
            [Rays::Pieces(pieces)] => pieces.owner(i, j).map(Owner::Piece),
            [Rays::Field(field)] => field.part(i, j).map(Owner::Part),
            _ => None,
        }
    }

    /// The ray of a formula `by` pixels from the centre of a pixel.
    fn ray_of(&self, owner: Owner, (i, j): (u32, u32), by: DVec2) -> Option<Ray> {
        let ray = match (self.layers.as_slice(), owner) {
            ([Rays::Pieces(pieces)], Owner::Piece(k)) if (k as usize) < pieces.pieces.len() => {
                pieces.bundle_at(k, i, j).ray(by.x, by.y)
            }
            ([Rays::Field(field)], Owner::Part(part)) => field.ray_of_part(part, (i, j), by)?,
            _ => return None,
        };
        let is_ray = ray.origin.is_finite() && ray.direction.is_finite() && ray.direction != DVec3::ZERO;
        is_ray.then_some(ray)
    }

    fn pixel_ray(&self, owner: Option<Owner>, pixel: (u32, u32), has_slopes: bool) -> PixelRay {
        let Some(owner) = owner else { return NO_RAY };
        let Some(ray) = self.ray_of(owner, pixel, DVec2::ZERO) else { return NO_RAY };
        let mut numbers = NO_RAY;
        put(&mut numbers[..6], ray.origin, ray.direction);
        for (k, side) in SIDES.into_iter().enumerate().filter(|_| has_slopes) {
            let ends = [-side, side].map_each(|by| self.ray_of(owner, pixel, by));
            if let [Some(from), Some(to)] = ends {
                put(&mut numbers[6 + 6 * k..][..6], to.origin - from.origin, to.direction - from.direction);
            }
        }
        numbers
    }

    /// The rays of all pixels of a camera of one layer of straight rays, row by row; with `has_slopes` also their change over each pixel.
    pub fn pixel_rays(&self, has_slopes: bool) -> Vec<PixelRay> {
        let ray = |k: usize| {
            let pixel = self.pixel_of(k);
            self.pixel_ray(self.owner(pixel), pixel, has_slopes)
        };
        parallel::map(0..self.pixel_count(), ray)
    }

    fn pixel_count(&self) -> usize {
        self.width as usize * self.height as usize
    }

    fn pixel_of(&self, k: usize) -> (u32, u32) {
        let width = self.width as usize;
        ((k % width) as u32, (k / width) as u32)
    }
}

fn put(numbers: &mut [f64], p: DVec3, d: DVec3) {
    numbers[..3].copy_from_slice(&p.to_array());
    numbers[3..].copy_from_slice(&d.to_array());
}

/// Directions turn by about so much between the two ends of the largest step, radians. What is left is of the sixth power of a part of it, and below
/// the rounding of rays over the step.
const TURN: f64 = 1.0 / 256.0;

/// Steps that are tried before a camera is given up, each at least half the one before; and by how much a step may grow at once.
const TRIES: usize = 64;
const GROWTH_MAX: f64 = 1e12;

/// The largest error of a derivative, relative to the largest one of all pixels.
const ERROR_MAX: f64 = 1.0 / (1u64 << 20) as f64;

/// Rounding of a ray, relative to its largest coordinate: a formula of some hundred operations of 2^-53 each.
const RAY_ROUNDING: f64 = 1.0 / (1u64 << 46) as f64;

/// The derivative of the rays of `camera` with respect to a number, at its value; `of_value` is the camera at other values.
///
/// # Errors
/// [`Error::Input`] if there is no camera about the value, or the rays do not change smoothly with it.
pub fn rate(
    camera: &Camera,
    (name, value): (&str, f64),
    of_value: &dyn Fn(f64) -> Result<Camera>,
    has_slopes: bool,
) -> Result<Rate> {
    let step = step(camera, (name, value), of_value)?;
    let mut cameras = Vec::new();
    for k in 0..3 {
        let half = step / f64::from(1 << k);
        let (below, above) = (value - half, value + half);
        let ends = [of_value(below)?, of_value(above)?];
        if ends.iter().any(|end| !is_like(end, camera)) {
            return Err(Error::input(format!(
                "{name}: the camera's pieces change with it; a gradient needs them to stay"
            )));
        }
        cameras.push((ends, above - below));
    }
    let each = |k: usize| {
        let pixel = camera.pixel_of(k);
        let owner = camera.owner(pixel);
        let slope = |(ends, width): &([Camera; 2], f64)| {
            let [from, to] = ends.each_ref().map_each(|end| end.pixel_ray(owner, pixel, has_slopes));
            std::array::from_fn::<f64, NUMBERS, _>(|n| (to[n] - from[n]) / width)
        };
        extrapolated([&cameras[0], &cameras[1], &cameras[2]].map_each(slope))
    };
    let both: Vec<(PixelRay, PixelRay)> = parallel::map(0..camera.pixel_count(), each);
    let largest = |of: &(dyn Fn(usize, usize) -> f64 + Sync)| {
        [0, 3].map_each(|first| {
            (0..both.len()).flat_map(|k| (first..first + 3).map(move |n| of(k, n).abs())).fold(0.0, f64::max)
        })
    };
    let (sizes, error) = (largest(&|k, n| both[k].0[n]), largest(&|k, n| both[k].1[n]));
    let base = camera.pixel_rays(false);
    let reach = largest(&|k, n| base[k][n]);
    let is_smooth = |k: usize| error[k] <= ERROR_MAX * sizes[k] + 4.0 * RAY_ROUNDING * reach[k] / step;
    if !(is_smooth(0) && is_smooth(1)) {
        return Err(Error::input(format!(
            "{name}: the camera's rays do not change smoothly with it; a gradient needs that"
        )));
    }
    Ok(Rate { rays: both.into_iter().map(|(rate, _)| rate).collect(), step, error })
}

/// The same pieces in an image of the same size.
fn is_like(a: &Camera, b: &Camera) -> bool {
    (a.width, a.height, a.layers.len(), a.piece_count()) == (b.width, b.height, b.layers.len(), b.piece_count())
}

/// From differences over a step, half and a quarter of it: the limit, with an error of the sixth power of the step, and how far it lies from
/// the one of the fourth power.
fn extrapolated([whole, half, quarter]: [PixelRay; 3]) -> (PixelRay, PixelRay) {
    let (mut limit, mut error) = (NO_RAY, NO_RAY);
    for n in 0..NUMBERS {
        let [far, near] =
            [(half[n], whole[n]), (quarter[n], half[n])].map_each(|(fine, coarse)| fine + (fine - coarse) / 3.0);
        limit[n] = near + (near - far) / 15.0;
        error[n] = limit[n] - near;
    }
    (limit, error)
}

/// The step to both sides of a value at which directions turn by about [`TURN`].
fn step(camera: &Camera, (name, value): (&str, f64), of_value: &dyn Fn(f64) -> Result<Camera>) -> Result<f64> {
    let mut places: Vec<(u32, u32)> = lattice((camera.width, camera.height)).collect();
    places.dedup();
    let base: Vec<((u32, u32), Option<Owner>)> = places.into_iter().map(|pixel| (pixel, camera.owner(pixel))).collect();
    let mut step = value.abs().max(1.0) / 16.0;
    let mut failed = None;
    let mut has_grown = false;
    for _ in 0..TRIES {
        match (of_value(value - step), of_value(value + step)) {
            (Ok(below), Ok(above)) => match turn(camera, &base, [&below, &above]) {
                Some(0.0) => return Ok(power_of_2(step)),
                Some(turn) if turn <= TURN && (turn >= TURN / 4.0 || has_grown) => return Ok(power_of_2(step)),
                Some(turn) if turn < TURN / 4.0 => {
                    has_grown = true;
                    step *= (TURN / 2.0 / turn).min(GROWTH_MAX);
                }
                Some(turn) => step *= (TURN / 2.0 / turn).clamp(f64::EPSILON, 0.5),
                None => step /= 2.0,
            },
            (Err(e), _) | (_, Err(e)) => {
                failed = Some(e);
                step /= 2.0;
            }
        }
    }
    let why = failed.map_or("pixels lose their rays".to_owned(), |e| e.to_string());
    Err(Error::input(format!("{name}: the camera has no gradient here; at values about {value}: {why}")))
}

/// Not larger, so that the step and the value add up with little rounding.
fn power_of_2(step: f64) -> f64 {
    step.log2().floor().exp2()
}

/// How far directions turn at most from one camera to another, relative to their length; `None` if more than a sixteenth of the pixels that have a
/// ray have none in both.
fn turn(camera: &Camera, base: &[((u32, u32), Option<Owner>)], ends: [&Camera; 2]) -> Option<f64> {
    let (mut turn, mut seen, mut lost) = (0f64, 0, 0);
    for &(pixel, owner) in base {
        let Some((owner, ray)) = owner.and_then(|o| Some((o, camera.ray_of(o, pixel, DVec2::ZERO)?))) else { continue };
        seen += 1;
        match ends.map_each(|end| end.ray_of(owner, pixel, DVec2::ZERO)) {
            [Some(a), Some(b)] => turn = turn.max((b.direction - a.direction).length() / ray.direction.length()),
            _ => lost += 1,
        }
    }
    (16 * lost <= seen).then_some(turn)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extrapolation_is_exact_for_powers_up_to_the_sixth() {
        // the central difference of x^n at 1
        let difference = |n: i32, h: f64| ((1.0 + h).powi(n) - (1.0 - h).powi(n)) / (2.0 * h);
        for n in 1..=6 {
            let [a, b, c] = [0.5, 0.25, 0.125].map(|h| [difference(n, h); NUMBERS]);
            let (limit, _) = extrapolated([a, b, c]);
            // some ten roundings of terms up to n 2^n
            assert!((limit[0] - f64::from(n)).abs() <= 10.0 * f64::EPSILON * f64::from(n << n), "x^{n}: {}", limit[0]);
        }
        let [a, b, c] = [0.5, 0.25, 0.125].map(|h| [difference(7, h); NUMBERS]);
        let (limit, error) = extrapolated([a, b, c]);
        let off = (limit[0] - 7.0).abs();
        assert!(off > 1e-4 && off <= error[0].abs(), "x^7: off by {off}, known within {}", error[0]);
    }
}

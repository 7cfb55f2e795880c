//! How much of its image a lens sees: its field of view, and the pixels without a ray.

use super::file::Calibration;
use super::lens::Lens;
use crate::camera::Rays;
use crate::camera::calibration::Calibrated;
use crate::parallel;
use glam::{DVec2, DVec3};

/// A lens over the image that it was calibrated with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Survey {
    /// Degrees that the rays sweep along the middle row and the middle column.
    pub field_of_view: [f64; 2],
    /// Pixels that were looked at, and those of them with a ray.
    pub pixels: u64,
    pub with_ray: u64,
}

/// Most pixels that are looked at: a few rows in many of a larger image.
const PIXELS_MAX: u32 = 1 << 20;

impl Survey {
    /// # Errors
    /// The model's numbers are out of their range.
    pub fn of(calibration: &Calibration) -> Result<Survey, String> {
        let lens = Lens::new(&calibration.model)?;
        let intrinsics = &calibration.intrinsics;
        let (back, (width, height)) = (intrinsics.scale.inverse(), intrinsics.size);
        // x and y in pixels from the corner of the image
        let direction = |x: f64, y: f64| lens.direction(back * (DVec2::new(x, y) - 0.5 - intrinsics.centre));
        let middle = [f64::from(width) / 2.0, f64::from(height) / 2.0];
        let across = (0..=width).filter_map(|i| direction(i.into(), middle[1]));
        let down = (0..=height).filter_map(|j| direction(middle[0], j.into()));
        let has_ray = |i: u32, j: u32| direction(f64::from(i) + 0.5, f64::from(j) + 0.5).is_some();
        let (pixels, with_ray) = count(width, height, has_ray);
        Ok(Survey { field_of_view: [swept(across), swept(down)], pixels, with_ray })
    }
}

/// The angle that neighboring directions sweep together, degrees.
fn swept(mut directions: impl Iterator<Item = DVec3>) -> f64 {
    let Some(mut last) = directions.next() else { return 0.0 };
    let mut sum = 0.0;
    for d in directions {
        sum += last.cross(d).length().atan2(last.dot(d));
        last = d;
    }
    sum.to_degrees()
}

/// Pixels that were looked at, and those of them with a ray.
fn count(width: u32, height: u32, has_ray: impl Fn(u32, u32) -> bool + Sync) -> (u64, u64) {
    let rows = (PIXELS_MAX / width.max(1)).clamp(1, height);
    let row = |k: u32| (u64::from(k) * u64::from(height) / u64::from(rows)) as u32;
    let of_row = |k: u32| (0..width).filter(|i| has_ray(*i, row(k))).count() as u64;
    (u64::from(width) * u64::from(rows), parallel::map(0..rows, of_row).into_iter().sum())
}

/// The line about pixels without a ray; `None` if all have one.
pub(super) fn missing(rays: &Rays, calibrated: &Calibrated) -> Option<String> {
    let Rays::Field(field) = rays else { return None };
    let (pixels, with_ray) = count(field.width, field.height, |i, j| field.ray(i, j).is_some());
    let about = if pixels < u64::from(field.width) * u64::from(field.height) { "about " } else { "" };
    // one pixel of many is not rounded to 0.0 %
    let share = (100.0 * (pixels - with_ray) as f64 / pixels as f64).max(0.1);
    let end = widest(calibrated).map_or(String::new(), |degrees| format!(", {degrees:.1} degrees from its axis"));
    (with_ray < pixels).then(|| {
        format!("{about}{share:.1} % of the pixels have no ray: they are beyond the fold or the end of the lens{end}")
    })
}

/// The largest angle from the axis at which the lens is seen to end along lines from the middle to the image's border, degrees.
fn widest(calibrated: &Calibrated) -> Option<f64> {
    /// Halvings of a line, after which its end is known to the last bit: at a fold the angle's error is the root of the place's.
    const HALVINGS: u32 = 53;
    let lens = Lens::new(&calibrated.model).ok()?;
    let intrinsics = &calibrated.intrinsics;
    let back = intrinsics.scale.inverse();
    let size = DVec2::new(intrinsics.size.0.into(), intrinsics.size.1.into());
    let corners = [DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::ONE].map(|c| back * (c * size - 0.5 - intrinsics.centre));
    let ends = corners.into_iter().filter(|corner| lens.direction(*corner).is_none()).map(|corner| {
        let (mut seen, mut beyond) = (0.0, 1.0);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (seen + beyond);
            if lens.direction(corner * middle).is_some() { seen = middle } else { beyond = middle }
        }
        lens.direction(corner * seen).map_or(0.0, |d| d.truncate().length().atan2(d.z))
    });
    ends.reduce(f64::max).map(f64::to_degrees)
}

#[cfg(test)]
mod tests {
    use super::super::file::Calibration;
    use super::*;
    use crate::camera::calibration::{Intrinsics, Model};
    use glam::DMat2;

    #[test]
    fn a_fisheye_of_200_degrees_is_surveyed() {
        // theta = r / f: 200 degrees across, and all of a circle in a square
        let f = 400.0 / 200f64.to_radians();
        let intrinsics =
            Intrinsics { size: (400, 400), scale: DMat2::from_diagonal(DVec2::splat(f)), centre: DVec2::splat(199.5) };
        // theta - theta^3 / 12 folds at theta = 2, at r = 4 / 3
        let calibration = |k: &[f64]| Calibration {
            intrinsics: intrinsics.clone(),
            model: Model::fisheye(k),
            placed: None,
            note: None,
        };
        let whole = Survey::of(&calibration(&[])).unwrap();
        assert!((whole.field_of_view[0] - 200.0).abs() < 1e-9 && (whole.field_of_view[1] - 200.0).abs() < 1e-9);
        assert_eq!((whole.pixels, whole.with_ray), (160_000, 160_000));
        let folded = Survey::of(&calibration(&[-1.0 / 12.0])).unwrap();
        // a circle of radius 4 f / 3 in a square
        let circle = std::f64::consts::PI * (4.0 * f / 3.0).powi(2);
        // the pixels that its edge passes are some eight radii
        assert!((folded.with_ray as f64 - circle).abs() < 8.0 * f, "{folded:?} {circle}");
    }
}

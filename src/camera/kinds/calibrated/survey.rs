//! How much of its image a lens sees: its field of view, and the share of pixels with a ray.

use super::file::Calibration;
use super::lens::Lens;
use super::without_rays::with_rays;
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

/// Most pixels that are looked at, evenly spread over a larger image.
const PIXELS_MAX: u64 = 1 << 20;

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
        let (pixels, with_ray) = with_rays([width, height], PIXELS_MAX, has_ray);
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

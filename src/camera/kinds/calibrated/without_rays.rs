//! The pixels of a lens's image that have no ray.

use super::lens::Lens;
use crate::arrays::MapEach;
use crate::camera::Rays;
use crate::camera::calibration::Calibrated;
use crate::parallel;
use glam::DVec2;

/// Most pixels whose rays are computed for a line about them: a hundredth of a second.
const PIXELS_MAX: u64 = 1 << 14;

/// Of the image's pixels, or of at most so many of them in even steps: their number, and that of those with a ray.
pub(super) fn with_rays([width, height]: [u32; 2], most: u64, has_ray: impl Fn(u32, u32) -> bool + Sync) -> (u64, u64) {
    let all = u64::from(width) * u64::from(height);
    let step = (all as f64 / most as f64).sqrt().ceil().max(1.0) as u32;
    let [columns, rows] = [width, height].map_each(|size| size.div_ceil(step));
    // the middle of each step, or of what the image has left of it
    let at = |k: u32, size: u32| k * step + step.min(size - k * step) / 2;
    let of_row = |j: u32| (0..columns).filter(|i| has_ray(at(*i, width), at(j, height))).count() as u64;
    (u64::from(columns) * u64::from(rows), parallel::map(0..rows, of_row).into_iter().sum())
}

/// The line about pixels without a ray; `None` if all have one.
pub(super) fn missing(rays: &Rays, calibrated: &Calibrated) -> Option<String> {
    let Rays::Field(field) = rays else { return None };
    let [width, height] = [field.width, field.height];
    let has_ray = |i: u32, j: u32| field.ray(i, j).is_some();
    let (pixels, with_ray) = with_rays([width, height], PIXELS_MAX, has_ray);
    let corners = [(0, 0), (width - 1, 0), (0, height - 1), (width - 1, height - 1)];
    let is_whole = with_ray == pixels && corners.into_iter().all(|(i, j)| has_ray(i, j));
    let about = if pixels < u64::from(width) * u64::from(height) { "about " } else { "" };
    // few pixels of many are not rounded to 0.0 %
    let share = (100.0 * (pixels - with_ray) as f64 / pixels as f64).max(0.1);
    let end = widest(calibrated).map_or(String::new(), |degrees| format!(", {degrees:.1} degrees from its axis"));
    (!is_whole).then(|| {
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

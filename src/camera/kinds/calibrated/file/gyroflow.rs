//! Lens profiles of gyroflow: OpenCV's fisheye or its other model. The first pixel has its centre at (0, 0), and gyroflow puts the principal
//! point at half the size unless a profile is `asymmetrical`.

use super::document::{Document, Result, Tree};
use super::{Calibration, Contents, intrinsics};
use crate::camera::calibration::Model;
use glam::DVec2;

pub fn is_file(document: &Document) -> bool {
    document.tree().at(&["fisheye_params", "camera_matrix"]).is_some()
}

pub fn contents(document: &Document) -> Result<Contents> {
    Contents::of_one(camera(document.tree()))
}

fn camera(tree: &Tree) -> Result<Calibration> {
    let size = tree.need("calib_dimension")?.need_size(["w", "h"]).map_err(|why| format!("calib_dimension: {why}"))?;
    let parameters = tree.need("fisheye_params")?;
    let [fx, _, cx, _, fy, cy, _, _, _] = parameters.need_list::<9>("camera_matrix")?;
    let k = parameters.need_numbers("distortion_coeffs")?;
    let model = match (tree.get("distortion_model").and_then(Tree::text).unwrap_or("opencv_fisheye"), k.len()) {
        ("opencv_fisheye", 4) => Model::fisheye(&k),
        ("opencv_standard", 4 | 5 | 8 | 12 | 14) => Model::brown(&k),
        (other, count) => {
            return Err(format!(
                "distortion_model: {other:?} with {count} distortion_coeffs is not known; use opencv_fisheye (4) or opencv_standard (4, 5, 8, 12 or 14)"
            ));
        }
    };
    let is_asymmetrical = tree.get("asymmetrical") == Some(&Tree::Bool(true));
    let middle = 0.5 * DVec2::new(size[0] as f64, size[1] as f64);
    let centre = if is_asymmetrical { DVec2::new(cx, cy) } else { middle };
    let focal = DVec2::new(fx, fy) / tree.number_or("crop", 1.0)?;
    let mut calibration = Calibration::new(intrinsics(size, focal, centre)?, model);
    let stretch = |key: &str| tree.get(key).and_then(Tree::number).is_some_and(|x| x != 0.0 && x != 1.0);
    let is_stretched = stretch("input_horizontal_stretch") || stretch("input_vertical_stretch");
    if is_stretched || tree.get("digital_lens").and_then(Tree::text).is_some_and(|lens| !lens.is_empty()) {
        calibration.note =
            Some("the file's stretch and digital lens are not applied: the rays are those of the lens".into());
    }
    Ok(calibration)
}

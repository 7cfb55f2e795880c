//! KITTI's and KITTI-360's calibrations of rectified cameras: `P_rect_0N` and `S_rect_0N`. The first pixel has its centre at (0, 0).

use super::document::{Document, Result, Tree, whole};
use super::{Calibration, Contents, intrinsics};
use crate::camera::calibration::Model;
use glam::DVec2;

/// N of `P_rect_N`, which YAML reads as a text of numbers.
fn number(key: &str) -> Option<u64> {
    key.strip_prefix("P_rect_")?.parse().ok()
}

pub fn is_file(document: &Document) -> bool {
    document.tree().entries().any(|(key, _)| number(key).is_some())
}

pub fn contents(document: &Document) -> Result<Contents> {
    let tree = document.tree();
    let cameras = tree.entries().filter_map(|(key, _)| Some((number(key)?, camera(tree, key))));
    Ok(Contents::of_cameras(cameras.collect()))
}

fn camera(tree: &Tree, key: &str) -> Result<Calibration> {
    let matrix = tree.need_list::<12>(key)?;
    let size = whole(tree.need_list(&key.replacen("P_rect", "S_rect", 1))?)?;
    let [focal, centre] = [DVec2::new(matrix[0], matrix[5]), DVec2::new(matrix[2], matrix[6])];
    let mut calibration = Calibration::new(intrinsics(size, focal, centre)?, Model::brown(&[]));
    if tree.entries().any(|(key, _)| key.starts_with("K_")) {
        calibration.note =
            Some("the rays are those of the rectified image; K and D of the raw one are not read".into());
    }
    Ok(calibration)
}

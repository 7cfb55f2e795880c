//! Calibrations of WoodScape and SynWoodScape: the radius in pixels as a polynomial of the angle, even powers too. The middle of the image
//! is half its size from the corner of the first pixel.

use super::document::{Document, Result, Tree};
use super::{Calibration, Contents, intrinsics};
use crate::camera::calibration::{Model, Projection};
use glam::DVec2;

pub fn is_file(document: &Document) -> bool {
    document.tree().at(&["intrinsic", "cx_offset"]).is_some()
}

pub fn contents(document: &Document) -> Result<Contents> {
    Contents::of_one(camera(document.tree().need("intrinsic")?).map_err(|why| format!("intrinsic: {why}")))
}

fn camera(tree: &Tree) -> Result<Calibration> {
    if let Some(other) = tree.get("model").and_then(Tree::text).filter(|model| *model != "radial_poly") {
        return Err(format!("model: {other:?} is not known; use radial_poly"));
    }
    let size = tree.need_size(["width", "height"])?;
    let offset = DVec2::from(tree.need_each(["cx_offset", "cy_offset"])?);
    let c = tree.need_each(["k1", "k2", "k3", "k4"])?.to_vec();
    let aspect = DVec2::new(1.0, tree.number_or("aspect_ratio", 1.0)?);
    let centre = 0.5 * DVec2::new(size[0] as f64, size[1] as f64) + offset - 0.5;
    let model = Model::plain(Projection::RadiusOfAngle { c });
    Ok(Calibration::new(intrinsics(size, aspect, centre)?, model))
}

//! Basalt's `calib.json`: lists of cameras and of their resolutions. The first pixel has its centre at (0, 0).

use super::document::{Document, Result, Tree, whole};
use super::{Calibration, Contents, intrinsics};
use crate::camera::calibration::{Model, Projection};
use glam::DVec2;

pub fn is_file(document: &Document) -> bool {
    document.tree().at(&["value0", "intrinsics"]).is_some()
}

/// The cameras by their places in the list.
pub fn contents(document: &Document) -> Result<Contents> {
    let list = |key: &str| document.tree().at(&["value0", key]).map_or(&[][..], Tree::items);
    let sizes = list("resolution");
    let cameras = list("intrinsics").iter().enumerate();
    let read = |(n, tree): (usize, &Tree)| (n as u64, camera(tree, sizes.get(n)));
    Ok(Contents::of_cameras(cameras.map(read).collect()))
}

fn camera(tree: &Tree, size: Option<&Tree>) -> Result<Calibration> {
    let size = size.and_then(Tree::numbers).and_then(|n| <[f64; 2]>::try_from(n).ok());
    let size = whole(size.ok_or("resolution: has no width and height of this camera")?)?;
    let numbers = tree.need("intrinsics")?;
    let model = match tree.need_text("camera_type")? {
        "pinhole" => Model::brown(&[]),
        "ds" => {
            let [xi, alpha] = numbers.need_each(["xi", "alpha"])?;
            Model::plain(Projection::DoubleSphere { xi, alpha })
        }
        "eucm" => {
            let [alpha, beta] = numbers.need_each(["alpha", "beta"])?;
            Model::plain(Projection::EnhancedUnified { alpha, beta })
        }
        // x / (alpha d + (1 - alpha) z): EUCM on a sphere
        "ucm" => Model::plain(Projection::EnhancedUnified { alpha: numbers.need_number("alpha")?, beta: 1.0 }),
        "kb4" => Model::fisheye(&numbers.need_each(["k1", "k2", "k3", "k4"])?),
        "fov" => Model::field_of_view(numbers.need_number("w")?),
        "pinhole-radtan8" => Model::brown(&numbers.need_each(["k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"])?),
        other => {
            return Err(format!(
                "camera_type: {other:?} is not known; use pinhole, ds, eucm, ucm, kb4, fov or pinhole-radtan8"
            ));
        }
    };
    let [fx, fy, cx, cy] = numbers.need_each(["fx", "fy", "cx", "cy"])?;
    Ok(Calibration::new(intrinsics(size, DVec2::new(fx, fy), DVec2::new(cx, cy))?, model))
}

//! Kalibr's `camchain.yaml`: `cam0`, `cam1` and on, each with a projection and a distortion; and EuRoC's `sensor.yaml`, which has the same
//! models. Their pixels are OpenCV's: the first has its centre at (0, 0).

use super::document::{Document, Result, Tree, whole};
use super::{Calibration, Contents, intrinsics, ocam};
use crate::arrays::MapEach;
use crate::camera::calibration::{Coefficients, Model, Projection};
use glam::{DMat2, DVec2};

/// A table with a camera `camN`.
pub fn is_chain(document: &Document) -> bool {
    let is_camera = |(key, camera): (&str, &Tree)| number(key).is_some() && camera.get("camera_model").is_some();
    document.tree().entries().any(is_camera)
}

/// N of `camN`.
pub fn number(key: &str) -> Option<u64> {
    key.strip_prefix("cam")?.parse().ok()
}

pub fn chain(document: &Document) -> Result<Contents> {
    let cameras = document.tree().entries().filter_map(|(key, camera)| Some((number(key)?, camera)));
    Ok(Contents::of_cameras(cameras.map(|(n, camera)| (n, of_chain(camera))).collect()))
}

fn of_chain(camera: &Tree) -> Result<Calibration> {
    let as_written = |why: String| format!("not a camchain as Kalibr writes it: {why}");
    let size = size(camera).map_err(as_written)?;
    let [model, distortion] = ["camera_model", "distortion_model"].map_each(|key| camera.need_text(key));
    let numbers = camera.need_numbers("intrinsics").map_err(as_written)?;
    let k = camera.get("distortion_coeffs").map_or(Ok(Vec::new()), |_| camera.need_numbers("distortion_coeffs"));
    calibration(size, model.map_err(as_written)?, &numbers, distortion.map_err(as_written)?, &k.map_err(as_written)?)
}

/// EuRoC's keys, which a file of OpenCV's has otherwise.
pub fn is_sensor(document: &Document) -> bool {
    document.tree().has(&["intrinsics", "resolution"])
}

pub fn sensor(document: &Document) -> Result<Contents> {
    let tree = document.tree();
    let text = |key: &str, default| tree.get(key).map_or(Ok(default), |_| tree.need_text(key));
    let k = ["distortion_coefficients", "distortion_coeffs"].into_iter().find(|key| tree.get(key).is_some());
    let k = k.map_or(Ok(Vec::new()), |key| tree.need_numbers(key))?;
    let distortion = text("distortion_model", if k.is_empty() { "none" } else { "radtan" })?;
    let numbers = tree.need_numbers("intrinsics")?;
    if tree.get("omni_affine").is_some() {
        return Contents::of_one(kimeras_omni(tree, &k));
    }
    Contents::of_one(calibration(size(tree)?, text("camera_model", "pinhole")?, &numbers, distortion, &k))
}

/// Kimera's `omni` is Scaramuzza's model: the heights are the distortion, and its z points to the scene.
fn kimeras_omni(tree: &Tree, heights: &[f64]) -> Result<Calibration> {
    let [c, d, e] = tree.need_list("omni_affine")?;
    let scale = DMat2::from_cols(DVec2::new(1.0, d), DVec2::new(c, e));
    let polynomial: Vec<f64> = heights.iter().map(|a| -a).collect();
    ocam::camera(size(tree)?, scale, DVec2::from(tree.need_list::<2>("omni_distortion_center")?), &polynomial)
}

fn size(camera: &Tree) -> Result<[u64; 2]> {
    whole(camera.need_list("resolution")?).map_err(|why| format!("resolution: {why}"))
}

/// A camera by the names of Kalibr's models, or those of aslam and of EuRoC for the same.
pub fn calibration(size: [u64; 2], camera: &str, numbers: &[f64], distortion: &str, k: &[f64]) -> Result<Calibration> {
    let wanted = |count: usize, names: &str| {
        Err(format!("intrinsics: {} numbers; {camera} has {count}: {names}", numbers.len()))
    };
    let (projection, rest) = match (camera, numbers) {
        ("pinhole", rest) if rest.len() == 4 => (Projection::Perspective, rest),
        ("pinhole", _) => return wanted(4, "fu, fv, pu, pv"),
        ("omni" | "unified-projection", [xi, rest @ ..]) if rest.len() == 4 => (Projection::Unified { xi: *xi }, rest),
        ("omni" | "unified-projection", _) => return wanted(5, "xi, fu, fv, pu, pv"),
        ("eucm", [alpha, beta, rest @ ..]) if rest.len() == 4 => {
            (Projection::EnhancedUnified { alpha: *alpha, beta: *beta }, rest)
        }
        ("eucm", _) => return wanted(6, "alpha, beta, fu, fv, pu, pv"),
        ("ds", [xi, alpha, rest @ ..]) if rest.len() == 4 => {
            (Projection::DoubleSphere { xi: *xi, alpha: *alpha }, rest)
        }
        ("ds", _) => return wanted(6, "xi, alpha, fu, fv, pu, pv"),
        (other, _) => return Err(format!("camera_model: {other:?} is not known; use pinhole, omni, eucm or ds")),
    };
    let model = match (distortion, projection, k.len()) {
        ("none", projection, 0) => Model::plain(projection),
        ("radtan" | "radial-tangential" | "plumb_bob", projection, 4) => {
            Model { projection, distortions: vec![Coefficients::of_opencv(k)] }
        }
        ("equidistant" | "equi", Projection::Perspective, 4) => Model::fisheye(k),
        ("fov" | "fisheye", Projection::Perspective, 1) => Model::field_of_view(k[0]),
        (other, _, count) => {
            return Err(format!(
                "distortion_model: {other} with {count} distortion_coeffs and {camera}; radtan (4) and none (0) go with all \
                 camera models, equidistant (4) and fov (1) with pinhole"
            ));
        }
    };
    let intrinsics = intrinsics(size, DVec2::new(rest[0], rest[1]), DVec2::new(rest[2], rest[3]))?;
    Ok(Calibration::new(intrinsics, model))
}

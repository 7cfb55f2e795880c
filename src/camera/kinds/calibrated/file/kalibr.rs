//! Kalibr's `camchain.yaml`: `cam0`, `cam1` and on, each with a projection and a distortion. Its pixels are OpenCV's: the first has its
//! centre at (0, 0).

use super::opencv::check_brackets;
use super::{Calibration, Which, intrinsics};
use crate::camera::calibration::{Coefficients, Model, Projection};
use glam::DVec2;
use serde::Deserialize;
use std::collections::BTreeMap;

type Result<T> = std::result::Result<T, String>;

#[derive(Deserialize)]
struct Camera {
    camera_model: String,
    intrinsics: Vec<f64>,
    distortion_model: String,
    #[serde(default)]
    distortion_coeffs: Vec<f64>,
    /// Width and height, px.
    resolution: [u64; 2],
}

/// The file's first key is a camera's.
pub fn is_chain(text: &str) -> bool {
    let first = text.lines().map(str::trim).find(|line| !line.is_empty() && !line.starts_with('#') && *line != "---");
    first.and_then(number).is_some()
}

/// N of `camN:`.
fn number(key: &str) -> Option<u64> {
    key.split(':').next()?.trim().strip_prefix("cam")?.parse().ok()
}

pub fn parse(text: &str, which: Which) -> Result<Calibration> {
    check_brackets(text)?;
    let refuse = |e: serde_norway::Error| format!("not a camchain as Kalibr writes it: {e}").replace('\n', " ");
    let chain: BTreeMap<String, serde_norway::Value> = serde_norway::from_str(text).map_err(refuse)?;
    let cameras = chain.into_iter().filter_map(|(key, value)| Some((number(&key)?, value))).collect();
    let camera: Camera = serde_norway::from_value(which.of(cameras)?).map_err(refuse)?;
    let wanted = |count: usize, names: &str| {
        let found = camera.intrinsics.len();
        Err(format!("intrinsics: {found} numbers; {} has {count}: {names}", camera.camera_model))
    };
    let (projection, rest) = match (camera.camera_model.as_str(), &camera.intrinsics[..]) {
        ("pinhole", rest) if rest.len() == 4 => (Projection::Perspective, rest),
        ("pinhole", _) => return wanted(4, "fu, fv, pu, pv"),
        ("omni", [xi, rest @ ..]) if rest.len() == 4 => (Projection::Unified { xi: *xi }, rest),
        ("omni", _) => return wanted(5, "xi, fu, fv, pu, pv"),
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
    let k = &camera.distortion_coeffs;
    let model = match (camera.distortion_model.as_str(), projection, k.len()) {
        ("none", projection, 0) => Model { projection, distortions: Vec::new() },
        ("radtan", projection, 4) => Model { projection, distortions: vec![Coefficients::of_opencv(k)] },
        ("equidistant" | "equi", Projection::Perspective, 4) => Model::fisheye(k),
        ("fov", Projection::Perspective, 1) => Model::field_of_view(k[0]),
        (other, _, count) => {
            return Err(format!(
                "distortion_model: {other} with {count} distortion_coeffs and {}; radtan (4) and none (0) go with all \
                 camera models, equidistant (4) and fov (1) with pinhole",
                camera.camera_model
            ));
        }
    };
    let intrinsics = intrinsics(camera.resolution, DVec2::new(rest[0], rest[1]), DVec2::new(rest[2], rest[3]))?;
    Ok(Calibration { intrinsics, model, placed: None, note: None })
}

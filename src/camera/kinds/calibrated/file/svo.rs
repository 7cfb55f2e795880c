//! Cameras of SVO and maplab (a list `cameras`), and of vikit (`cam_model`). The first pixel has its centre at (0, 0).

use super::document::{Document, Result, Tree};
use super::{Calibration, Contents, intrinsics, kalibr, ocam};
use crate::camera::calibration::Model;
use glam::{DMat2, DVec2};

/// The cameras of vikit, by number: one at the root, or `camN`.
fn vikit(root: &Tree) -> Vec<(u64, &Tree)> {
    let named = root.entries().filter_map(|(key, camera)| Some((kalibr::number(key)?, camera)));
    let all = std::iter::once((0, root)).chain(named);
    all.filter(|(_, camera)| camera.get("cam_model").is_some()).collect()
}

/// The cameras of a list, each below `camera` or not, or the one at the root.
fn listed(root: &Tree) -> Vec<&Tree> {
    let items = root.get("cameras").map_or(std::slice::from_ref(root), Tree::items);
    let cameras = items.iter().map(|item| item.get("camera").unwrap_or(item));
    cameras.filter(|camera| camera.has(&["type", "intrinsics"])).collect()
}

pub fn is_file(document: &Document) -> bool {
    !vikit(document.tree()).is_empty() || !listed(document.tree()).is_empty()
}

pub fn contents(document: &Document) -> Result<Contents> {
    let root = document.tree();
    let listed = listed(root).into_iter().enumerate().map(|(n, camera)| (n as u64, of_list(camera)));
    let vikit = vikit(root).into_iter().map(|(n, camera)| (n, of_vikit(camera)));
    Ok(Contents::of_cameras(listed.chain(vikit).collect()))
}

fn of_list(camera: &Tree) -> Result<Calibration> {
    let size = camera.need_size(["image_width", "image_height"])?;
    let distortion = camera.get("distortion");
    let name = distortion.and_then(|d| d.get("type")).and_then(Tree::text).unwrap_or("none");
    let k = distortion
        .filter(|d| d.get("parameters").is_some())
        .map_or(Ok(Vec::new()), |d| d.need_numbers("parameters"))?;
    let k = if name == "none" { &[] } else { &k[..] };
    let (kind, numbers) = (camera.need_text("type")?, camera.need_numbers("intrinsics")?);
    // OCamCalib's polynomial, center, and c, d, e; the inverse polynomial and the radii of the mask follow
    if let ("omni", [heights @ .., cx, cy, c, d, e]) = (kind, &numbers[..numbers.len().min(10)])
        && numbers.len() == 24
    {
        let scale = DMat2::from_cols(DVec2::new(1.0, *d), DVec2::new(*e, *c));
        return ocam::camera(size, scale, DVec2::new(*cx, *cy), heights);
    }
    kalibr::calibration(size, kind, &numbers, name, k)
}

fn of_vikit(camera: &Tree) -> Result<Calibration> {
    let size = camera.need_size(["cam_width", "cam_height"])?;
    let [fx, fy, cx, cy] = camera.need_each(["cam_fx", "cam_fy", "cam_cx", "cam_cy"])?;
    let d = camera.numbers_or_0(["cam_d0", "cam_d1", "cam_d2", "cam_d3", "cam_d4"])?;
    let (mut focal, mut centre) = (DVec2::new(fx, fy), DVec2::new(cx, cy));
    let model = match camera.need_text("cam_model")? {
        "Pinhole" => Model::brown(&d),
        "PinholeRadialTangential" => Model::brown(&d[..4]),
        "PinholeNoDistortion" => Model::brown(&[]),
        "PinholeEquidistant" => Model::fisheye(&d[..4]),
        // PTAM's numbers are fractions of the image
        "ATAN" => {
            let pixels = DVec2::new(size[0] as f64, size[1] as f64);
            (focal, centre) = (focal * pixels, centre * pixels - 0.5);
            Model::field_of_view(d[0])
        }
        "PinholeAtan" if fx < 10.0 => {
            return Err(format!("cam_fx: {fx}: PinholeAtan has pixels; use ATAN for fractions of the image"));
        }
        "PinholeAtan" => Model::field_of_view(d[0]),
        other => {
            return Err(format!(
                "cam_model: {other:?} is not known; use ATAN, Pinhole, or Pinhole with NoDistortion, RadialTangential, Equidistant or Atan"
            ));
        }
    };
    Ok(Calibration::new(intrinsics(size, focal, centre)?, model))
}

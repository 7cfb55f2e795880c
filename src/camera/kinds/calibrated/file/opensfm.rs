//! OpenSfM's `camera_models.json` and `reconstruction.json`, and ODM's `cameras.json`. Lengths are relative to the larger side of the image,
//! whose middle is half its size from the corner of the first pixel. Poses are from the world to the camera.

use super::document::{Document, Result, Tree};
use super::{Calibration, Contents, Image, Placed, intrinsics};
use crate::camera::calibration::{Coefficients, Model, Projection};
use glam::{DQuat, DVec2, DVec3};
use std::collections::HashMap;
use std::f64::consts::TAU;

const TYPE: &str = "projection_type";

/// A list of reconstructions, one of them, or the cameras alone.
fn reconstructions(root: &Tree) -> impl Iterator<Item = &Tree> {
    let all = if root.is_table() { std::slice::from_ref(root) } else { root.items() };
    all.iter().filter(|part| cameras(part).next().is_some())
}

fn cameras(part: &Tree) -> impl Iterator<Item = (&str, &Tree)> {
    part.get("cameras").unwrap_or(part).entries().filter(|(_, camera)| camera.get(TYPE).is_some())
}

pub fn is_file(document: &Document) -> bool {
    reconstructions(document.tree()).next().is_some()
}

/// The cameras by their places in the file.
pub fn contents(document: &Document) -> Result<Contents> {
    let mut all = Contents::default();
    for part in reconstructions(document.tree()) {
        let mut numbers = HashMap::new();
        for (name, tree) in cameras(part) {
            numbers.insert(name, all.cameras.len() as u64);
            all.cameras.push((all.cameras.len() as u64, camera(tree)));
        }
        for (name, shot) in part.get("shots").into_iter().flat_map(Tree::entries) {
            let camera = shot.get("camera").and_then(Tree::text).and_then(|name| numbers.get(name));
            if let Some(camera) = camera {
                all.images.push(Image { name: name.into(), camera: *camera, placed: placed(shot) });
            }
        }
    }
    Ok(all)
}

fn placed(shot: &Tree) -> Result<Placed> {
    let rotation = DQuat::from_scaled_axis(DVec3::from(shot.need_list::<3>("rotation")?));
    let translation = DVec3::from(shot.need_list::<3>("translation")?);
    Placed::of_inverse(rotation, translation).ok_or("its pose is out of range".into())
}

fn camera(tree: &Tree) -> Result<Calibration> {
    let size = tree.need_size(["width", "height"])?;
    let pixels = DVec2::new(size[0] as f64, size[1] as f64);
    let unit = pixels.max_element();
    let centre = |offset: DVec2| 0.5 * pixels + unit * offset - 0.5;
    let kind = tree.need_text(TYPE)?;
    if matches!(kind, "spherical" | "equirectangular") {
        let model = Model::plain(Projection::Equirectangular);
        let scale = DVec2::splat(unit / TAU);
        return Ok(Calibration::new(intrinsics(size, scale, centre(DVec2::ZERO))?, model));
    }
    let k = tree.numbers_or_0(["k1", "k2", "k3", "k4", "k5", "k6"])?;
    let tangential = tree.numbers_or_0(["p1", "p2"])?;
    let [s0, s1, s2, s3] = tree.numbers_or_0(["s0", "s1", "s2", "s3"])?;
    let prism = [DVec2::new(s0, s2), DVec2::new(s1, s3)];
    let (projection, bent) = match kind {
        "perspective" | "simple_radial" | "radial" => (Projection::Perspective, Coefficients::radial(&k[..2])),
        "brown" => (Projection::Perspective, Coefficients { tangential, ..Coefficients::radial(&k[..3]) }),
        "fisheye" => (Projection::Equidistant, Coefficients::radial(&k[..2])),
        "fisheye_opencv" => (Projection::Equidistant, Coefficients::radial(&k[..4])),
        "fisheye62" => (Projection::Equidistant, Coefficients { tangential, ..Coefficients::radial(&k) }),
        "fisheye624" => (Projection::Equidistant, Coefficients { tangential, prism, ..Coefficients::radial(&k) }),
        other => {
            return Err(format!(
                "{TYPE}: {other:?} is not known; use perspective, simple_radial, radial, brown, fisheye, fisheye_opencv, fisheye62, fisheye624 or spherical"
            ));
        }
    };
    let focal = match tree.get("focal") {
        Some(_) => DVec2::splat(tree.need_number("focal")?),
        None => DVec2::from(tree.need_each(["focal_x", "focal_y"])?),
    };
    let offset = DVec2::from(tree.numbers_or_0(["c_x", "c_y"])?);
    let model = Model { projection, distortions: vec![bent] };
    Ok(Calibration::new(intrinsics(size, unit * focal, centre(offset))?, model))
}

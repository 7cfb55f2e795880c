//! AliceVision's and Meshroom's `.sfm` as JSON, whose numbers are texts. The principal point is an offset from the middle of the image, half
//! its size from the corner of the first pixel. Poses are from the world to the camera, rotations column by column.

use super::document::{Document, Result, Tree};
use super::{Calibration, Contents, Image, Placed, intrinsics};
use crate::camera::calibration::{Coefficients, Model, Projection};
use glam::DVec2;
use std::collections::HashMap;

pub fn is_file(document: &Document) -> bool {
    let first = document.tree().get("intrinsics").and_then(|intrinsics| intrinsics.items().first());
    first.is_some_and(|intrinsic| intrinsic.get("intrinsicId").is_some())
}

/// An identifier, which is a text.
fn id<'a>(tree: &'a Tree, key: &str) -> Option<&'a str> {
    tree.get(key).and_then(Tree::text)
}

/// The cameras by their places in the file.
pub fn contents(document: &Document) -> Result<Contents> {
    let list = |key: &str| document.tree().get(key).map_or(&[][..], Tree::items);
    // of files since 1.2 the principal point is an offset
    let version: Vec<f64> = list("version").iter().filter_map(Tree::number).collect();
    let is_offset = version.is_empty() || version[..] >= [1.0, 2.0][..];
    let numbers: HashMap<_, _> =
        list("intrinsics").iter().enumerate().filter_map(|(n, i)| Some((id(i, "intrinsicId")?, n as u64))).collect();
    let poses: HashMap<_, _> = list("poses").iter().filter_map(|pose| Some((id(pose, "poseId")?, pose))).collect();
    let images = list("views").iter().filter_map(|view| {
        let camera = *numbers.get(id(view, "intrinsicId")?)?;
        let pose = *poses.get(id(view, "poseId")?)?;
        Some(Image { name: id(view, "path")?.into(), camera, placed: placed(pose) })
    });
    let camera = |(n, tree): (usize, &Tree)| (n as u64, camera(tree, is_offset));
    let cameras = list("intrinsics").iter().enumerate().map(camera).collect();
    Ok(Contents { cameras, images: images.collect() })
}

fn placed(pose: &Tree) -> Result<Placed> {
    let transform = pose.at(&["pose", "transform"]).ok_or("pose.transform is missing")?;
    // the columns of the rotation to the camera are the rows of that to the world
    let r = transform.need_list::<9>("rotation")?;
    let c = transform.need_list::<3>("center")?;
    let row = |k: usize| [r[3 * k], r[3 * k + 1], r[3 * k + 2], c[k]];
    Placed::of_rows(&[row(0), row(1), row(2)])
}

fn camera(tree: &Tree, is_offset: bool) -> Result<Calibration> {
    let size = tree.need_size(["width", "height"])?;
    let pixels = DVec2::new(size[0] as f64, size[1] as f64);
    // px, or millimetres on a sensor
    let focal = match tree.get("pxFocalLength") {
        Some(Tree::List(_)) => DVec2::from(tree.need_list::<2>("pxFocalLength")?),
        Some(_) => DVec2::splat(tree.need_number("pxFocalLength")?),
        None => {
            let [length, width] = tree.need_each(["focalLength", "sensorWidth"])?;
            DVec2::new(1.0, tree.number_or("pixelRatio", 1.0)?) * (length / width * pixels.x)
        }
    };
    let point = DVec2::from(tree.need_list::<2>("principalPoint")?);
    let centre = if is_offset { 0.5 * pixels + point } else { point } - 0.5;
    let k = match ["distortionParams", "distortionCoefficients"].into_iter().find(|key| tree.get(key).is_some()) {
        Some(key) => tree.need_numbers(key)?,
        None => Vec::new(),
    };
    let camera = tree.need_text("type")?;
    let kind = tree.get("distortionType").and_then(Tree::text).filter(|kind| *kind != "none");
    let perspective = Model { projection: Projection::Perspective, distortions: vec![Coefficients::radial(&k)] };
    let model = match (camera, kind.unwrap_or(camera), k.len()) {
        ("pinhole", "pinhole", 0) => perspective,
        (_, "radial1" | "radialk1", 1) | (_, "radial3" | "radialk3", 3) => perspective,
        (_, "brown", 5) => Model::brown(&[k[0], k[1], k[3], k[4], k[2]]),
        (_, "fisheye4", 4) => Model::fisheye(&k),
        (_, "fisheye1", 1) => Model::field_of_view(k[0]),
        (other, distortion, count) => {
            return Err(format!(
                "type: {other} with distortion {distortion} of {count} numbers is not known; use pinhole (0), radial1 (1), radial3 (3), brown (5), fisheye4 (4) or fisheye1 (1)"
            ));
        }
    };
    Ok(Calibration::new(intrinsics(size, focal, centre)?, model))
}

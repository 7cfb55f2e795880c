//! `transforms.json` of nerfstudio, instant-ngp and others: the lens of all frames or of each, and the pose of each. The first pixel has its
//! centre at (0.5, 0.5); poses are from the camera to the world, in OpenGL's axes.

use super::document::{Document, Result, Tree, whole};
use super::{Calibration, Contents, Image, Placed, intrinsics};
use crate::arrays::MapEach;
use crate::camera::calibration::{Coefficients, Model, Projection};
use glam::DVec2;
use std::f64::consts::PI;

const MATRIX: &str = "transform_matrix";

pub fn is_file(document: &Document) -> bool {
    let first = document.tree().get("frames").and_then(|frames| frames.items().first());
    first.is_some_and(|frame| frame.get(MATRIX).is_some())
}

/// Cameras are numbered from 0 in the order of the frames that first have them.
pub fn contents(document: &Document) -> Result<Contents> {
    let root = document.tree();
    let frames = ["frames", "test_frames"].into_iter().filter_map(|key| root.get(key)).flat_map(Tree::items);
    let mut all = Contents::default();
    for (n, frame) in frames.enumerate() {
        let camera = camera(root, frame);
        if all.cameras.last().is_none_or(|(_, last)| *last != camera) {
            all.cameras.push((all.cameras.len() as u64, camera));
        }
        let name = frame.get("file_path").and_then(Tree::text).map_or_else(|| n.to_string(), str::to_owned);
        all.images.push(Image { name, camera: all.cameras.len() as u64 - 1, placed: placed(frame) });
    }
    Ok(all)
}

fn placed(frame: &Tree) -> Result<Placed> {
    let rows = frame.need(MATRIX)?.items();
    let row = |row: &Tree| row.numbers().and_then(|n| <[f64; 4]>::try_from(n).ok());
    let rows: Vec<[f64; 4]> = rows.iter().map_while(row).collect();
    let [a, b, c] = *rows.first_chunk::<3>().ok_or(format!("{MATRIX} must have 3 or 4 rows of 4 finite numbers"))?;
    // from OpenGL's axes to OpenCV's: y and z point the other way
    let turned = |[x, y, z, t]: [f64; 4]| [x, -y, -z, t];
    Placed::of_rows(&[a, b, c].map_each(turned)).map_err(|why| format!("{MATRIX}: {why}"))
}

/// The lens of a frame, whose own keys come first.
fn camera(root: &Tree, frame: &Tree) -> Result<Calibration> {
    let get = |key: &str| frame.get(key).or_else(|| root.get(key));
    let number =
        |key: &str| get(key).map(|value| value.number().ok_or(format!("{key} must be a finite number"))).transpose();
    let need = |key: &str| number(key)?.ok_or_else(|| format!("{key} is missing; add it beside frames"));
    let k = |key: &str| Ok::<_, String>(number(key)?.unwrap_or(0.0));
    let size = whole([need("w")?, need("h")?])?;
    let pixels = DVec2::new(size[0] as f64, size[1] as f64);
    let centre = DVec2::new(number("cx")?.unwrap_or(0.5 * pixels.x), number("cy")?.unwrap_or(0.5 * pixels.y)) - 0.5;
    // a focal length in pixels, or the field of view of the older files
    let focal = |length: &str, angle: &str, pixels: f64| match (number(length)?, number(angle)?) {
        (Some(length), _) => Ok(Some(length)),
        (None, Some(angle)) => Ok(Some(0.5 * pixels / (0.5 * angle).tan())),
        (None, None) => Ok::<_, String>(None),
    };
    let (fx, fy) = (focal("fl_x", "camera_angle_x", pixels.x)?, focal("fl_y", "camera_angle_y", pixels.y)?);
    let missing = || "fl_x and fl_y are missing; add them, px, beside frames".to_string();
    let focal = DVec2::new(fx.or(fy).ok_or_else(missing)?, fy.or(fx).ok_or_else(missing)?);
    let flag = |key: &str| get(key) == Some(&Tree::Bool(true));
    let named = get("camera_model").map(|name| name.text().unwrap_or("?"));
    let default = if flag("is_fisheye") { "OPENCV_FISHEYE" } else { "OPENCV" };
    let bent = || {
        let radial = Coefficients::radial(&[k("k1")?, k("k2")?, k("k3")?, k("k4")?]);
        Ok::<_, String>(Coefficients { tangential: [k("p1")?, k("p2")?], ..radial })
    };
    let (projection, distortions, focal) = match named.unwrap_or(default) {
        "SIMPLE_PINHOLE" | "PINHOLE" | "SIMPLE_RADIAL" | "RADIAL" | "OPENCV" => {
            (Projection::Perspective, vec![bent()?], focal)
        }
        "OPENCV_FISHEYE" => (Projection::Equidistant, vec![bent()?], focal),
        "FISHEYE624" => {
            let listed = get("distortion_params").ok_or("distortion_params is missing; FISHEYE624 has 12")?;
            let listed = listed.numbers().and_then(|n| <[f64; 12]>::try_from(n).ok());
            let [k @ .., p0, p1, s0, s1, s2, s3] = listed.ok_or("distortion_params must be 12 finite numbers")?;
            (Projection::Equidistant, Coefficients::radial_then_thin_prism(&k, [p0, p1], [s0, s1, s2, s3]), focal)
        }
        // half a turn over the focal length
        "EQUIRECTANGULAR" => (Projection::Equirectangular, Vec::new(), focal / PI),
        other => {
            return Err(format!(
                "camera_model: {other:?} is not read as a lens; use ods for stereo panoramas, orthographic for orthophotos, or another file"
            ));
        }
    };
    Ok(Calibration::new(intrinsics(size, focal, centre)?, Model { projection, distortions }))
}

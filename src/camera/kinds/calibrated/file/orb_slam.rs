//! Settings of ORB-SLAM2 and 3 (`Camera.fx` or `Camera1.fx`), and of stella_vslam and OpenVSLAM (`Camera:` with `fx` below it). The first
//! pixel has its centre at (0, 0).

use super::document::{Document, Result, Tree, each, whole};
use super::{Calibration, Contents, intrinsics};
use crate::camera::calibration::{Model, Projection};
use glam::DVec2;
use std::f64::consts::TAU;

/// The keys of a camera, with its name in front or below it.
#[derive(Clone, Copy)]
struct Keys<'a> {
    root: &'a Tree,
    camera: &'static str,
}

impl<'a> Keys<'a> {
    fn get(&self, key: &str) -> Option<&'a Tree> {
        self.root.get(&format!("{}.{key}", self.camera)).or_else(|| self.root.at(&[self.camera, key]))
    }

    fn optional(&self, key: &str) -> Result<Option<f64>> {
        let number = |value: &Tree| value.number().ok_or(format!("{}.{key} must be a finite number", self.camera));
        self.get(key).map(number).transpose()
    }

    fn number(&self, key: &str) -> Result<f64> {
        self.optional(key)?.ok_or(format!("{}.{key} is missing", self.camera))
    }

    /// Numbers of absent keys are 0.
    fn numbers<const N: usize>(&self, keys: [&str; N]) -> Result<[f64; N]> {
        each(keys, |key| Ok(self.optional(key)?.unwrap_or(0.0)))
    }
}

const CAMERAS: [&str; 3] = ["Camera", "Camera1", "Camera2"];

fn cameras(root: &Tree) -> impl Iterator<Item = (u64, Keys<'_>)> {
    let keys = CAMERAS.into_iter().map(move |camera| Keys { root, camera });
    let is_there = |keys: &Keys| keys.get("fx").is_some() || keys.get("model").is_some();
    keys.filter(is_there).enumerate().map(|(n, keys)| (n as u64, keys))
}

pub fn is_file(document: &Document) -> bool {
    cameras(document.tree()).next().is_some()
}

/// The cameras of a stereo pair are 0 and 1.
pub fn contents(document: &Document) -> Result<Contents> {
    let root = document.tree();
    Ok(Contents::of_cameras(cameras(root).map(|(n, keys)| (n, camera(root, keys))).collect()))
}

fn camera(root: &Tree, keys: Keys) -> Result<Calibration> {
    // ORB-SLAM3 gives one size for both cameras, stella_vslam calls it columns and rows
    let shared = Keys { root, camera: "Camera" };
    let side = |names: [&str; 2]| {
        let own = names.into_iter().find_map(|name| keys.get(name).or(shared.get(name)));
        own.and_then(Tree::number).ok_or(format!("Camera.{} is missing; add Camera.width and Camera.height", names[0]))
    };
    let size = whole([side(["width", "cols"])?, side(["height", "rows"])?])?;
    let kind = ["type", "model"].into_iter().find_map(|key| keys.get(key).or(shared.get(key)));
    let model = match kind.map_or("PinHole", |kind| kind.text().unwrap_or("?")) {
        "PinHole" | "Pinhole" | "perspective" => Model::brown(&keys.numbers(["k1", "k2", "p1", "p2", "k3"])?),
        // the images are undistorted
        "Rectified" => Model::brown(&[]),
        "KannalaBrandt8" | "fisheye" => Model::fisheye(&keys.numbers(["k1", "k2", "k3", "k4"])?),
        "radial_division" => Model::plain(Projection::Division { k: keys.number("distortion")? }),
        "equirectangular" => {
            // one turn over the width, half a turn over the height
            let pixels = DVec2::new(size[0] as f64, size[1] as f64);
            let intrinsics = intrinsics(size, pixels / DVec2::new(TAU, 0.5 * TAU), 0.5 * pixels)?;
            return Ok(Calibration::new(intrinsics, Model::plain(Projection::Equirectangular)));
        }
        other => {
            return Err(format!(
                "{}.type: {other:?} is not known; use PinHole, Rectified or KannalaBrandt8, or stella_vslam's models",
                keys.camera
            ));
        }
    };
    let (focal, centre) =
        (DVec2::new(keys.number("fx")?, keys.number("fy")?), [keys.number("cx")?, keys.number("cy")?]);
    Ok(Calibration::new(intrinsics(size, focal, centre.into())?, model))
}

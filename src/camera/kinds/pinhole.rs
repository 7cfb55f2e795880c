//! `pinhole`: all rays start at the eye.

use crate::camera::Pieces;
use crate::camera::Rays;
use crate::camera::bundle::Bundle;
use crate::camera::pose::{KEYS, Pose};
use crate::camera::recipe::{Built, Recipe, Setting};
use crate::input::reader::Table;
use crate::input::{Error, Result};
use glam::DVec3;
use std::sync::Arc;

/// The camera of every renderer.
#[derive(Debug, Clone, PartialEq)]
pub struct Pinhole {
    pub eye: DVec3,
    pub target: DVec3,
    pub up: DVec3,
    /// Degrees, from the top to the bottom of the image.
    pub vfov: f64,
}

/// Reads the camera's table.
pub fn read(table: &Table) -> Result<Arc<dyn Recipe>> {
    table.allow(&[&["kind", "t_range"], &KEYS[..], &["vfov"]].concat())?;
    let (eye, target, up) = Pose::read(table)?.directed();
    Ok(Arc::new(Pinhole { eye, target, up, vfov: table.need("vfov", "40")?.number()? }))
}

impl Recipe for Pinhole {
    /// One piece: the whole image.
    fn build(&self, setting: &Setting) -> Result<Built> {
        let (width, height) = setting.size()?;
        let bundle = bundle(&Pose::UNTURNED, self.vfov, height)?;
        let pose = Pose::look_at(self.eye, self.target, self.up);
        let pieces = Pieces::whole_turned_by(pose.view()?, pose.eye, bundle, (width, height));
        Ok(Built::new((width, height), Rays::Pieces(pieces)))
    }
}

/// `P = eye`, `D = f + (2a-1) k (W/H) r + (1-2b) k u` with `k = tan(vfov/2)`; centred on the image's middle.
pub fn bundle(pose: &Pose, vfov_deg: f64, height: u32) -> Result<Bundle> {
    if !(vfov_deg > 0.0 && vfov_deg < 180.0) {
        return Err(Error::input(format!("camera.vfov = {vfov_deg}: must lie between 0 and 180 degrees")));
    }
    let v = pose.view()?;
    let step = 2.0 * (vfov_deg.to_radians() / 2.0).tan() / height as f64;
    Ok(Bundle {
        p: [pose.eye, DVec3::ZERO, DVec3::ZERO],
        d: [v.forward, step * v.right, -step * v.up],
        h: [1.0, 0.0, 0.0],
    })
}

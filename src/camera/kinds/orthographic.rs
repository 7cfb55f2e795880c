//! `orthographic`: all rays are parallel.

use crate::camera::Pieces;
use crate::camera::Rays;
use crate::camera::bundle::Bundle;
use crate::camera::pose::{KEYS, Pose};
use crate::camera::recipe::{Built, Recipe, Setting};
use crate::input::reader::Table;
use crate::input::{Error, Result};
use glam::DVec3;
use std::sync::Arc;

/// A camera without perspective.
#[derive(Debug, Clone, PartialEq)]
pub struct Orthographic {
    pub eye: DVec3,
    pub target: DVec3,
    pub up: DVec3,
    /// Of the image, world units.
    pub height: f64,
}

/// Reads the camera's table.
pub fn read(table: &Table) -> Result<Arc<dyn Recipe>> {
    table.allow(&[&["kind", "t_range"], &KEYS[..], &["height"]].concat())?;
    let (eye, target, up) = Pose::read(table)?.directed();
    Ok(Arc::new(Orthographic { eye, target, up, height: table.need("height", "10")?.number()? }))
}

impl Recipe for Orthographic {
    /// One piece: the whole image.
    fn build(&self, setting: &Setting) -> Result<Built> {
        let (width, height) = setting.size()?;
        let bundle = bundle(&Pose::UNTURNED, self.height, height)?;
        let pose = Pose::look_at(self.eye, self.target, self.up);
        let pieces = Pieces::whole_turned_by(pose.view()?, pose.eye, bundle, (width, height));
        Ok(Built::new((width, height), Rays::Pieces(pieces)))
    }
}

/// `P = eye + (2a-1)(height/2)(W/H) r + (1-2b)(height/2) u`, `D = f`; centred on the image's middle.
pub fn bundle(pose: &Pose, height_world: f64, height: u32) -> Result<Bundle> {
    if !(height_world > 0.0 && height_world.is_finite()) {
        return Err(Error::input(format!("camera.height = {height_world}: must be a positive length")));
    }
    let v = pose.view()?;
    let step = height_world / height as f64;
    Ok(Bundle {
        p: [pose.eye, step * v.right, -step * v.up],
        d: [v.forward, DVec3::ZERO, DVec3::ZERO],
        h: [1.0, 0.0, 0.0],
    })
}

//! `ods`: an omni-directional stereo pair, the left eye's picture above the right eye's.

use super::{Lens, POSE, Pose, Posed};
use crate::camera::recipe::{Built, Recipe, Setting};
use crate::camera::tessellate::{KEYS, Tessellation};
use crate::camera::values::number_if;
use crate::input::reader::Table;
use crate::input::{Error, Result};
use glam::DVec3;
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

#[derive(Debug, PartialEq)]
struct Ods {
    pose: Pose,
    /// World units between the eyes.
    ipd: f64,
    tessellation: Tessellation,
}

pub fn read(table: &Table) -> Result<Arc<dyn Recipe>> {
    table.allow(&[&["kind", "t_range", "ipd"][..], &POSE, &KEYS].concat())?;
    let ipd = number_if(&table.need("ipd", "0.064")?, |ipd| ipd >= 0.0, "is less than 0, which would swap the eyes")?;
    Ok(Arc::new(Ods { pose: Pose::read(table)?, ipd, tessellation: Tessellation::read(table)? }))
}

impl Recipe for Ods {
    fn build(&self, setting: &Setting) -> Result<Built> {
        let (_, h) = setting.size()?;
        if h % 2 == 1 {
            return Err(Error::input(format!(
                "image: {h} rows are not two pictures of equal height; give an even height"
            )));
        }
        let map = Posed::new(&self.pose, Circle { radius: self.ipd / 2.0 })?;
        self.tessellation.build(Arc::new(map), setting)
    }
}

/// Rays that touch a horizontal circle about the eye.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Circle {
    radius: f64,
}

impl Lens for Circle {
    fn direction(&self, a: f64, b: f64) -> Option<DVec3> {
        let b = if b < 0.5 { 2.0 * b } else { 2.0 * b - 1.0 };
        let (sin, cos) = ((a - 0.5) * TAU).sin_cos();
        let (up, level) = ((0.5 - b) * PI).sin_cos();
        Some(DVec3::new(level * sin, up, level * cos))
    }

    fn origin(&self, a: f64, b: f64) -> Option<DVec3> {
        let side = if b < 0.5 { -1.0 } else { 1.0 };
        let (sin, cos) = ((a - 0.5) * TAU).sin_cos();
        (self.radius != 0.0).then(|| DVec3::new(side * self.radius * cos, 0.0, -side * self.radius * sin))
    }
}

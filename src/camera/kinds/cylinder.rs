//! `cylinder`: the horizontal angle and the tangent of elevation become image coordinates; exact, or in strips.

use super::strips::{self, Grid};
use super::{Lens, POSE, Pose, Posed};
use crate::camera::recipe::{Built, Recipe, Setting};
use crate::camera::tessellate::{KEYS, Tessellation};
use crate::camera::values::number_if;
use crate::input::reader::Table;
use crate::input::{Error, Result};
use glam::DVec3;
use std::f64::consts::PI;
use std::sync::Arc;

#[derive(Debug, PartialEq)]
struct Cylinder {
    pose: Pose,
    /// Radians, left to right.
    fov: f64,
    /// Tangents of elevation at the lower and upper border; `None`: as many as make pixels square on the horizon.
    tan: Option<[f64; 2]>,
    /// Strips round the cylinder instead of exact rays.
    strips: Option<u32>,
    tessellation: Tessellation,
}

pub fn read(table: &Table) -> Result<Arc<dyn Recipe>> {
    table.allow(&[&["kind", "t_range", "fov", "vfov", "tan", "strips"][..], &POSE, &KEYS].concat())?;
    let is_fov = |x: f64| x > 0.0 && x <= 360.0;
    let fov = table.or("fov", 360.0, |f| number_if(f, is_fov, "degrees; must be over 0 and at most 360"))?;
    let (pose, strips, tessellation) = (Pose::read(table)?, strips::read(table)?, Tessellation::read(table)?);
    Ok(Arc::new(Cylinder { pose, fov: fov.to_radians(), tan: read_tan(table)?, strips, tessellation }))
}

/// The height of the image: `vfov`, or `tan`, or neither.
fn read_tan(table: &Table) -> Result<Option<[f64; 2]>> {
    let Some(field) = table.get("tan") else {
        return table.optional("vfov", |field| {
            let vfov = number_if(field, |x| x > 0.0 && x < 180.0, "degrees; must lie between 0 and 180")?;
            Ok((vfov.to_radians() / 2.0).tan()).map(|k| [-k, k])
        });
    };
    if table.has("vfov") {
        return Err(field.error("tan and vfov both give the image's height; give one of them"));
    }
    let tan: [f64; 2] = field.numbers("the tangents of elevation at the lower and upper border, as [-1, 1]")?;
    if tan[0] >= tan[1] {
        return Err(field.error(format_args!("the first, {}, must be less than the second, {}", tan[0], tan[1])));
    }
    Ok(Some(tan))
}

impl Recipe for Cylinder {
    fn build(&self, setting: &Setting) -> Result<Built> {
        let (w, h) = setting.size()?;
        let square = self.fov * f64::from(h) / f64::from(w) / 2.0;
        let lens = Wall { fov: self.fov, tan: self.tan.unwrap_or([-square, square]) };
        let map = Posed::new(&self.pose, lens)?;
        match self.strips {
            None => self.tessellation.build(Arc::new(map), setting),
            Some(n) => build_strips(&map, lens, n, setting),
        }
    }
}

/// `n` strips `2 delta = fov / n` wide, each the perspective onto the plane through the strip's borders:
/// `D = cos(delta) f_k + s sin(delta) r_k + v u` with s from -1 to 1 across it. It is the exact cylinder at both borders.
///
/// Between them the ray is the exact one of an image place that is `s delta - atan(s tan delta)` of angle beside and, as its
/// horizontal part is `cos(delta)` long at the least, `v (1 / cos(delta) - 1)` above or below at most.
fn build_strips(map: &Posed, Wall { fov, tan }: Wall, n: u32, setting: &Setting) -> Result<Built> {
    let (w, h) = setting.size()?;
    let delta = fov / f64::from(n) / 2.0;
    if delta >= PI / 2.0 {
        let least = (fov / PI).floor() + 1.0;
        return Err(Error::input(format!(
            "camera.strips = {n}: a strip is 180 degrees or wider; give {least} or more"
        )));
    }
    // where the derivative by s is 0
    let worst = (delta.tan() / delta - 1.0).max(0.0).sqrt() / delta.tan();
    let beside = (worst * delta - (worst * delta.tan()).atan()).abs() * f64::from(w) / fov;
    let highest = tan[0].abs().max(tan[1].abs());
    let above = highest * (1.0 / delta.cos() - 1.0) * f64::from(h) / (tan[1] - tan[0]);
    let note =
        format!("{n} strips; from the exact cylinder at most {beside:.4} px beside, {above:.4} px above or below");
    let built = Grid::new(n, 1.0, setting)?.build(map);
    Ok(Built { notes: vec![note].into(), ..built })
}

/// Directions over the image, their horizontal part a unit vector.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Wall {
    fov: f64,
    tan: [f64; 2],
}

impl Lens for Wall {
    fn direction(&self, a: f64, b: f64) -> Option<DVec3> {
        let (sin, cos) = ((a - 0.5) * self.fov).sin_cos();
        Some(DVec3::new(sin, self.tan[1] + b * (self.tan[0] - self.tan[1]), cos))
    }
}

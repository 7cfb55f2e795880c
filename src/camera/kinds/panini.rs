//! `panini`: a cylinder seen from behind its axis, for wide pictures whose verticals stay straight.

use super::{Lens, POSE, Pose, Posed};
use crate::camera::recipe::{Built, Recipe, Setting};
use crate::camera::tessellate::{KEYS, Tessellation};
use crate::camera::values::number_if;
use crate::input::Result;
use crate::input::reader::Table;
use glam::DVec3;
use std::sync::Arc;

#[derive(Debug, PartialEq)]
struct Panini {
    pose: Pose,
    /// Radians, left to right.
    fov: f64,
    /// From the axis of the cylinder back to the centre of projection, radii.
    d: f64,
    /// Vertical compression, 0 to 1.
    s: f64,
    tessellation: Tessellation,
}

pub fn read(table: &Table) -> Result<Arc<dyn Recipe>> {
    table.allow(&[&["kind", "t_range", "fov", "d", "s"][..], &POSE, &KEYS].concat())?;
    let d = table.or("d", 1.0, |f| number_if(f, |d| d >= 0.0, "must not be under 0"))?;
    let s = table.or("s", 0.0, |f| number_if(f, |s| (0.0..=1.0).contains(&s), "must be from 0 to 1"))?;
    let fov = table.need("fov", "150")?;
    let widest = widest(d, s).to_degrees();
    let wrong = format_args!("degrees; with d = {d} and s = {s} it must lie between 0 and {widest}");
    let degrees = number_if(&fov, |x| x > 0.0 && x < widest, wrong)?;
    Ok(Arc::new(Panini {
        pose: Pose::read(table)?,
        fov: degrees.to_radians(),
        d,
        s,
        tessellation: Tessellation::read(table)?,
    }))
}

/// Under this angle the distance from the middle is finite and grows: `d + cos > 0` and `1 + d cos > 0`; with vertical
/// compression also `cos > 0`.
fn widest(d: f64, s: f64) -> f64 {
    if s > 0.0 { std::f64::consts::PI } else { 2.0 * (-d.min(1.0 / d)).acos() }
}

impl Recipe for Panini {
    fn build(&self, setting: &Setting) -> Result<Built> {
        let (w, h) = setting.size()?;
        let (sin, cos) = (self.fov / 2.0).sin_cos();
        let across = sin * (self.d + 1.0) / (self.d + cos);
        let lens = Screen { across, aspect: f64::from(h) / f64::from(w), d: self.d, s: self.s };
        self.tessellation.build(Arc::new(Posed::new(&self.pose, lens)?), setting)
    }
}

/// Directions over the image, their horizontal part a unit vector.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Screen {
    /// Half the image's width in radii of the cylinder.
    across: f64,
    /// Height over width of the image.
    aspect: f64,
    d: f64,
    s: f64,
}

impl Lens for Screen {
    fn direction(&self, a: f64, b: f64) -> Option<DVec3> {
        let (x, y) = ((2.0 * a - 1.0) * self.across, (1.0 - 2.0 * b) * self.across * self.aspect);
        // x = S sin(phi), S = (d + 1) / (d + cos(phi)): a quadratic equation in cos(phi)
        let d = self.d;
        let k = (x / (d + 1.0)).powi(2);
        let cos = ((1.0 + k - k * d * d).max(0.0).sqrt() - k * d) / (k + 1.0);
        let stretch = (d + 1.0) / (d + cos);
        let high = (1.0 - self.s) * stretch + if self.s > 0.0 { self.s / cos } else { 0.0 };
        Some(DVec3::new(x / stretch, y / high, cos))
    }
}

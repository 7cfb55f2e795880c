//! `pencil` and `twisted`: a pinhole and an orthographic camera sheared about the plane that the target lies in.
//!
//! Yu and McMillan 2004, section 3; Yu, Yu and McMillan 2009, section 3.1: the two classes of general linear cameras whose
//! characteristic equation has a double root, or none, and is no multiple of the identity there.

use super::{POSE, Pose};
use crate::camera::recipe::{Built, Recipe, Setting};
use crate::camera::values::{angle_within, half_tangent, length};
use crate::camera::{Bundle, Pieces, Rays};
use crate::input::Result;
use crate::input::reader::{Field, Table};
use glam::DVec3;
use std::sync::Arc;

#[derive(Debug, PartialEq)]
struct Pencil {
    pose: Pose,
    /// tan(vfov / 2).
    k: f64,
    /// World units.
    slit: f64,
    /// Degrees.
    angle: f64,
}

pub fn read(table: &Table) -> Result<Arc<dyn Recipe>> {
    table.allow(&[&["kind", "t_range", "vfov", "slit", "angle"], &POSE[..]].concat())?;
    Ok(Arc::new(Pencil {
        pose: Pose::read(table)?,
        k: half_tangent(&table.need("vfov", "40")?)?,
        slit: table.need("slit", "2")?.number()?,
        angle: table.or("angle", 0.0, Field::number)?,
    }))
}

impl Recipe for Pencil {
    fn build(&self, setting: &Setting) -> Result<Built> {
        let size = setting.size()?;
        let (view, aspect) = (self.pose.view()?, size.0 as f64 / size.1 as f64);
        let (sin, cos) = self.angle.to_radians().sin_cos();
        // the eye moves along the slit with the image place's distance from it
        let shift = self.slit / 2.0 * (cos * view.right + sin * view.up);
        let (px, py) = (-sin * aspect * shift, cos * shift);
        let per_t = 1.0 / self.pose.distance();
        let d = [view.forward, self.k * aspect * view.right - per_t * px, self.k * view.up - per_t * py];
        let bundle = Bundle::over_image([self.pose.eye, px, py], d, size);
        Ok(Built::new(size, Rays::Pieces(Pieces::whole(bundle, size.0, size.1))))
    }
}

#[derive(Debug, PartialEq)]
struct Twisted {
    pose: Pose,
    /// World units.
    height: f64,
    /// tan(angle).
    tan_angle: f64,
}

pub fn read_twisted(table: &Table) -> Result<Arc<dyn Recipe>> {
    table.allow(&[&["kind", "t_range", "height", "angle"], &POSE[..]].concat())?;
    Ok(Arc::new(Twisted {
        pose: Pose::read(table)?,
        height: length(&table.need("height", "10")?)?,
        tan_angle: angle_within(&table.need("angle", "30")?, -90.0, 90.0)?.to_radians().tan(),
    }))
}

impl Recipe for Twisted {
    fn build(&self, setting: &Setting) -> Result<Built> {
        let size = setting.size()?;
        let (view, half) = (self.pose.view()?, self.height / 2.0);
        let slant = self.tan_angle * view.right;
        let distance = self.pose.distance();
        let p = [self.pose.eye, half * size.0 as f64 / size.1 as f64 * view.right, half * view.up - distance * slant];
        let bundle = Bundle::over_image(p, [view.forward, DVec3::ZERO, slant], size);
        Ok(Built::new(size, Rays::Pieces(Pieces::whole(bundle, size.0, size.1))))
    }
}

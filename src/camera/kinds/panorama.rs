//! `panorama`: an eye on a circle, looking in at an object or out from a centre: a ring of cross-slit cameras.
//!
//! Yu, Yu and McMillan 2009, section 5.1: all share a slit through the circle's centre, its axis; the other slits are segments of
//! the circle. The limit of many segments is the exact map: each column is seen from its own place of the circle.

use super::{Lens, Posed};
use crate::camera::recipe::{Built, Recipe, Setting};
use crate::camera::tessellate::{self, Tessellation};
use crate::camera::values::{direction, length, number_if, word};
use crate::camera::view::{View, view};
use crate::input::Result;
use crate::input::reader::{Field, Table};
use glam::DVec3;
use std::sync::Arc;

#[derive(Debug, PartialEq)]
struct Panorama {
    center: DVec3,
    axis: DVec3,
    front: DVec3,
    ring: Ring,
    tessellation: Tessellation,
}

/// The exact limit as a lens in the circle's frame. Its axes: x to the right of a viewer who looks inward in the middle column, y along the
/// circle's axis, z from the centre to that column's eye.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Ring {
    radius: f64,
    /// Height of the circle over the centre, along the axis.
    elevation: f64,
    /// Height of the image, at the distance of one radius from the eye.
    height: f64,
    /// Degrees.
    sweep: f64,
    /// 1: at the axis; -1: away from it.
    inward: f64,
}

pub fn read(table: &Table) -> Result<Arc<dyn Recipe>> {
    let own = ["kind", "t_range", "center", "axis", "front", "radius", "elevation", "height", "sweep", "look"];
    table.allow(&[&own[..], &tessellate::KEYS].concat())?;
    Ok(Arc::new(Panorama {
        center: table.or("center", DVec3::ZERO, Field::vec3)?,
        axis: table.or("axis", DVec3::Y, direction)?,
        front: table.or("front", DVec3::Z, direction)?,
        ring: Ring {
            radius: length(&table.need("radius", "8")?)?,
            elevation: table.or("elevation", 0.0, Field::number)?,
            height: length(&table.need("height", "4")?)?,
            sweep: table.or("sweep", 360.0, read_sweep)?,
            inward: table.or("look", 1.0, read_look)?,
        },
        tessellation: Tessellation::read(table)?,
    }))
}

fn read_sweep(field: &Field) -> Result<f64> {
    number_if(field, |x| x > 0.0 && x <= 360.0, "must be over 0 and at most 360 degrees")
}

fn read_look(field: &Field) -> Result<f64> {
    word(field, &[("inward", 1.0), ("outward", -1.0)], "is \"inward\", at what the eye goes round, or \"outward\"")
}

impl Recipe for Panorama {
    fn build(&self, setting: &Setting) -> Result<Built> {
        // a viewer at `front` who looks at the axis has it upright
        let view = view(self.front, DVec3::ZERO, self.axis).map_err(|_| {
            crate::input::Error::input("camera.front: it is parallel to axis; give a direction to a side of it")
        })?;
        let frame = View { right: view.right, up: self.axis, forward: self.axis.cross(-view.right) };
        let map = Posed { eye: self.center, view: frame, lens: Arc::new(self.ring) };
        self.tessellation.build(Arc::new(map), setting)
    }
}

impl Lens for Ring {
    fn direction(&self, a: f64, b: f64) -> Option<DVec3> {
        let Ring { elevation, height, inward, .. } = self;
        Some(-inward * self.out(a) + (height * (0.5 - b) - elevation) * DVec3::Y)
    }

    fn origin(&self, a: f64, _b: f64) -> Option<DVec3> {
        Some(self.out(a) + self.elevation * DVec3::Y)
    }
}

impl Ring {
    /// From the axis to the eye of a column.
    fn out(&self, a: f64) -> DVec3 {
        let (sin, cos) = (self.inward * self.sweep * (a - 0.5)).to_radians().sin_cos();
        self.radius * DVec3::new(sin, 0.0, cos)
    }
}

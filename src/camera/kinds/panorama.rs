//! `panorama`: an eye on a circle, looking in at an object or out from a centre: a ring of cross-slit cameras.
//!
//! Yu, Yu and McMillan 2009, section 5.1: all share a slit through the circle's centre, its axis; the other slits are segments of
//! the circle. The limit of many segments is the exact map: each column is seen from its own place of the circle.

use crate::camera::recipe::{Built, Recipe, Setting};
use crate::camera::tessellate::{self, Tessellation};
use crate::camera::values::{direction, length};
use crate::camera::view::view;
use crate::camera::{Ray, RayMap};
use crate::input::Result;
use crate::input::reader::{Field, Table};
use glam::DVec3;
use std::sync::Arc;

#[derive(Debug, PartialEq)]
struct Panorama {
    ring: Keys,
    tessellation: Tessellation,
}

/// As read.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Keys {
    center: DVec3,
    axis: DVec3,
    front: DVec3,
    radius: f64,
    /// Of the circle over the centre, along the axis.
    elevation: f64,
    /// Of the image, at the distance of one radius from the eye.
    height: f64,
    /// Degrees.
    sweep: f64,
    /// 1: at the axis; -1: away from it.
    inward: f64,
}

/// The exact limit.
#[derive(Debug)]
struct Ring {
    keys: Keys,
    /// Unit vectors: along the axis, from the centre to the middle column's eye, and to the right of that column's viewer if
    /// they look inward.
    w: DVec3,
    e: DVec3,
    side: DVec3,
}

pub fn read(table: &Table) -> Result<Arc<dyn Recipe>> {
    let own = ["kind", "t_range", "center", "axis", "front", "radius", "elevation", "height", "sweep", "look"];
    table.allow(&[&own[..], &tessellate::KEYS].concat())?;
    let ring = Keys {
        center: table.or("center", DVec3::ZERO, Field::vec3)?,
        axis: table.or("axis", DVec3::Y, direction)?,
        front: table.or("front", DVec3::Z, direction)?,
        radius: length(&table.need("radius", "8")?)?,
        elevation: table.or("elevation", 0.0, Field::number)?,
        height: length(&table.need("height", "4")?)?,
        sweep: table.or("sweep", 360.0, read_sweep)?,
        inward: table.or("look", 1.0, read_look)?,
    };
    Ok(Arc::new(Panorama { ring, tessellation: Tessellation::read(table)? }))
}

fn read_sweep(field: &Field) -> Result<f64> {
    let sweep = field.number()?;
    if sweep > 0.0 && sweep <= 360.0 {
        return Ok(sweep);
    }
    Err(field.error(format_args!("{sweep} must be over 0 and at most 360 degrees")))
}

fn read_look(field: &Field) -> Result<f64> {
    match field.text()? {
        "inward" => Ok(1.0),
        "outward" => Ok(-1.0),
        _ => Err(field.error("is \"inward\", at what the eye goes round, or \"outward\"")),
    }
}

impl Recipe for Panorama {
    fn build(&self, setting: &Setting) -> Result<Built> {
        let keys = self.ring;
        // a viewer at `front` who looks at the axis has it upright
        let view = view(keys.front, DVec3::ZERO, keys.axis).map_err(|_| {
            crate::input::Error::input("camera.front: it is parallel to axis; give a direction to a side of it")
        })?;
        let ring = Ring { keys, w: keys.axis, e: keys.axis.cross(-view.right), side: view.right };
        self.tessellation.build(Arc::new(ring), setting)
    }
}

impl RayMap for Ring {
    fn ray(&self, a: f64, b: f64) -> Option<Ray> {
        let Keys { center, radius, elevation, height, sweep, inward, .. } = self.keys;
        let (sin, cos) = (inward * sweep * (a - 0.5)).to_radians().sin_cos();
        let out = radius * (cos * self.e + sin * self.side);
        let origin = center + out + elevation * self.w;
        Some(Ray { origin, direction: -inward * out + (height * (0.5 - b) - elevation) * self.w })
    }
}

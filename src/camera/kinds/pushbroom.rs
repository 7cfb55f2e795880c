//! `pushbroom`: a line camera that moves straight on; one general linear camera.
//!
//! Gupta and Hartley 1997 (the linear pushbroom); Yu, Yu and McMillan 2009, section 3.1. Its path is a slit at t = 0.

use crate::camera::recipe::{Built, Recipe, Setting};
use crate::camera::values::{direction, half_tangent, length};
use crate::camera::view::view;
use crate::camera::{Bundle, Pieces, Rays};
use crate::input::reader::{Field, Table};
use crate::input::{Error, Result};
use glam::DVec3;
use std::sync::Arc;

#[derive(Debug, PartialEq)]
struct Pushbroom {
    start: DVec3,
    /// From the path's start to its end.
    path: DVec3,
    look: DVec3,
    up: DVec3,
    line: Line,
}

/// The sensor: a column of the image or a row of it, and the tangent of half its angle.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Line {
    Column(f64),
    Row(f64),
}

/// Sine of an angle to the sensor's line under which the path gives the image no width: see `view::UP_SINE_MIN`.
const PATH_SINE_MIN: f64 = crate::camera::view::UP_SINE_MIN;

pub fn read(table: &Table) -> Result<Arc<dyn Recipe>> {
    let paths = ["end", "velocity", "time", "direction", "extent"];
    table.allow(&[&["kind", "t_range", "start", "look", "up", "vfov", "hfov"][..], &paths].concat())?;
    let start = table.need("start", "[-10, 8, 5]")?.vec3()?;
    let line = match (table.get("vfov"), table.get("hfov")) {
        (Some(_), Some(row)) => return Err(row.error("vfov makes the sensor a column, hfov a row; give one of them")),
        (None, Some(row)) => Line::Row(half_tangent(&row)?),
        (_, None) => Line::Column(half_tangent(&table.need("vfov", "40")?)?),
    };
    Ok(Arc::new(Pushbroom {
        start,
        path: read_path(table, start)?,
        look: direction(&table.need("look", "[0, 0, -1]")?)?,
        up: table.or("up", DVec3::Y, Field::vec3)?,
        line,
    }))
}

/// One of the three ways to say how far the camera goes.
fn read_path(table: &Table, start: DVec3) -> Result<DVec3> {
    let given: Vec<&str> = ["end", "velocity", "direction"].into_iter().filter(|key| table.has(key)).collect();
    let [given_key] = given[..] else {
        return Err(table.error("a path is end = [x, y, z], or velocity and time, or direction and extent; give one"));
    };
    let partners = [("time", "velocity"), ("extent", "direction")];
    if let Some((key, with)) = partners.into_iter().find(|(key, with)| table.has(key) && *with != given_key) {
        return Err(table.error(format_args!("{key} goes with {with}, not with {given_key}; leave one out")));
    }
    let path = match given_key {
        "end" => table.need("end", "[10, 8, 5]")?.vec3()? - start,
        "velocity" => length(&table.need("time", "10")?)? * table.need("velocity", "[2, 0, 0]")?.vec3()?,
        _ => length(&table.need("extent", "20")?)? * direction(&table.need("direction", "[1, 0, 0]")?)?,
    };
    if path == DVec3::ZERO || !path.is_finite() {
        return Err(
            table.error(format_args!("{given_key}: the path has no length that can be used; let the camera move"))
        );
    }
    Ok(path)
}

impl Recipe for Pushbroom {
    fn build(&self, setting: &Setting) -> Result<Built> {
        let size = setting.size()?;
        let view = view(DVec3::ZERO, self.look, self.up)?;
        let across = if matches!(self.line, Line::Column(_)) { view.right } else { view.up };
        let sideways = self.path.normalize().dot(across);
        if sideways.abs() < PATH_SINE_MIN {
            let direction =
                if matches!(self.line, Line::Column(_)) { "to a side" } else { "up or down in the picture" };
            return Err(Error::input(format!("camera: the path must go {direction}; change it, look or up")));
        }
        // a picture is never mirrored: a camera that goes left fills it from the right
        let half = 0.5 * sideways.signum() * self.path;
        let middle = self.start + 0.5 * self.path;
        let bundle = match self.line {
            Line::Column(k) => {
                Bundle::over_image([middle, half, DVec3::ZERO], [view.forward, DVec3::ZERO, k * view.up], size)
            }
            Line::Row(k) => {
                Bundle::over_image([middle, DVec3::ZERO, half], [view.forward, k * view.right, DVec3::ZERO], size)
            }
        };
        Ok(Built::new(size, Rays::Pieces(Pieces::whole(bundle, size.0, size.1))))
    }
}

//! `sphere`: longitude and latitude become image coordinates (equirectangular); exact, or in perspective cells.

use super::strips::{self, Grid};
use super::{Lens, POSE, Pose, Posed};
use crate::arrays::MapEach;
use crate::camera::recipe::{Built, Recipe, Setting};
use crate::camera::tessellate::{KEYS, Tessellation};
use crate::input::reader::{Field, Table};
use crate::input::{Error, Result};
use glam::DVec3;
use std::sync::Arc;

#[derive(Debug, PartialEq)]
struct Sphere {
    pose: Pose,
    angles: Angles,
    /// Strips round the sphere instead of exact rays.
    strips: Option<u32>,
    tessellation: Tessellation,
}

/// Unit directions over the image.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Angles {
    /// Radians at the left and right border, 0 ahead, growing to the right.
    lon: [f64; 2],
    /// Radians at the lower and upper border.
    lat: [f64; 2],
}

pub fn read(table: &Table) -> Result<Arc<dyn Recipe>> {
    table.allow(&[&["kind", "t_range", "lon", "lat", "strips"][..], &POSE, &KEYS].concat())?;
    let lon = table.or("lon", [-180.0, 180.0], |f| read_range(f, "two longitudes in degrees, as [-180, 180]"))?;
    if lon[1] - lon[0] > 360.0 {
        return Err(table.error("lon: the longitudes span over 360 degrees; no ray is wanted twice"));
    }
    let lat = table.or("lat", [-90.0, 90.0], |f| read_range(f, "two latitudes in degrees, as [-90, 90]"))?;
    if lat[0] < -90.0 || lat[1] > 90.0 {
        return Err(table.error("lat: latitudes lie from -90 to 90 degrees"));
    }
    let angles = Angles { lon: lon.map_each(f64::to_radians), lat: lat.map_each(f64::to_radians) };
    let (pose, strips, tessellation) = (Pose::read(table)?, strips::read(table)?, Tessellation::read(table)?);
    Ok(Arc::new(Sphere { pose, angles, strips, tessellation }))
}

fn read_range(field: &Field, expected: &str) -> Result<[f64; 2]> {
    let range: [f64; 2] = field.numbers(expected)?;
    if range[0] >= range[1] {
        return Err(field.error(format_args!("the first, {}, must be less than the second, {}", range[0], range[1])));
    }
    Ok(range)
}

impl Recipe for Sphere {
    fn build(&self, setting: &Setting) -> Result<Built> {
        let map = Posed::new(&self.pose, self.angles)?;
        match self.strips {
            None => self.tessellation.build(Arc::new(map), setting),
            Some(n) => build_cells(&map, self.angles, n, setting),
        }
    }
}

/// `n` columns of cells about as high as they are wide, each two triangles whose directions are interpolated from
/// the exact unit directions at their corners; so neighbours agree on the whole of a shared side.
///
/// On the unit sphere no second derivative over longitude and latitude is longer than 1, so linear interpolation
/// over a right triangle with legs h and k is off by at most `(h + k)^2 / 8`, and the ray by at most the arcsine.
fn build_cells(map: &Posed, Angles { lon, lat }: Angles, n: u32, setting: &Setting) -> Result<Built> {
    let (wide, high) = (lon[1] - lon[0], lat[1] - lat[0]);
    let rows = (f64::from(n) * high / wide).ceil();
    let bound = (wide / f64::from(n) + high / rows).powi(2) / 8.0;
    if bound >= 1.0 {
        return Err(Error::input(format!("camera.strips = {n}: too few to tell directions apart; give more")));
    }
    let grid = Grid::new(n, rows, setting)?;
    let bound_deg = bound.asin().to_degrees();
    let note =
        format!("{} cells; a ray differs from the exact sphere's by at most {bound_deg:.4} degrees", grid.cells());
    Ok(Built { notes: vec![note].into(), ..grid.build(map) })
}

impl Lens for Angles {
    fn direction(&self, a: f64, b: f64) -> Option<DVec3> {
        let lon = self.lon[0] + a * (self.lon[1] - self.lon[0]);
        let lat = self.lat[1] + b * (self.lat[0] - self.lat[1]);
        Some(DVec3::new(lat.cos() * lon.sin(), lat.sin(), lat.cos() * lon.cos()))
    }
}

//! Vertices of a PLY file as points: faces are left out.

use super::element::{Skipped, number, set_color};
use super::{Wrong, check_sizes, first, linear, read, read_file};
use crate::geometry::spheres::Points;
use crate::input::{Limits, Loading, Result};
use glam::DVec3;
use ply_rs_bw::parser::Reader;
use ply_rs_bw::ply::{Property, PropertyAccess, PropertyAccessResult};
use std::path::Path;

/// Names of the property that is a radius; the second is that of CloudCompare's scalar fields.
const RADIUS: [&str; 2] = ["radius", "scalar_radius"];

#[derive(Default)]
struct Point {
    place: DVec3,
    radius: f64,
    /// sRGB, from 0 to 1.
    color: [f64; 3],
}

impl PropertyAccess for Point {
    fn new() -> Point {
        Point::default()
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        let Some(value) = number(&property) else { return PropertyAccessResult::Ignored };
        let place = match name {
            "x" => &mut self.place.x,
            "y" => &mut self.place.y,
            "z" => &mut self.place.z,
            name if RADIUS.contains(&name) => &mut self.radius,
            _ => return set_color(&mut self.color, name, &property),
        };
        *place = value;
        PropertyAccessResult::Set
    }
}

/// The vertices of a PLY file, with their radii and colours if it has them.
///
/// # Errors
/// [`crate::input::Error::Missing`] or [`crate::input::Error::Read`] if it cannot be read; [`crate::input::Error::Input`] naming it.
pub fn load_points(path: &Path, loading: &Loading) -> Result<Points> {
    read_file(path, loading, parse)
}

fn parse(bytes: &[u8], limits: Limits) -> std::result::Result<Points, Wrong> {
    let mut reader = Reader::new(bytes);
    let header = first(bytes, &mut reader)?;
    check_sizes(&header, bytes.len(), limits)?;
    let Some(vertex) = header.elements.get("vertex") else {
        return Err(Wrong::File("has no vertices, of which spheres are made".into()));
    };
    let has = |name: &str| vertex.properties.contains_key(name);
    if let Some(name) = ["x", "y", "z"].into_iter().find(|name| !has(name)) {
        return Err(Wrong::File(format!("its vertices have no {name}")));
    }
    let has_radii = RADIUS.into_iter().any(has);
    let has_colors = ["red", "green", "blue"].into_iter().all(has);
    let mut points = Vec::new();
    for (name, element) in &header.elements {
        match name.as_str() {
            "vertex" => points = read::<Point>(&mut reader, element, &header)?,
            _ => drop(read::<Skipped>(&mut reader, element, &header)?),
        }
        if name == "vertex" {
            // what comes after them is not needed
            break;
        }
    }
    let color = |(k, point): (usize, &Point)| linear(point.color, || format!("vertex {k}"));
    let colors = has_colors.then(|| points.iter().enumerate().map(color).collect::<std::result::Result<Vec<_>, _>>());
    Ok(Points {
        colors: colors.transpose()?,
        radii: has_radii.then(|| points.iter().map(|point| point.radius).collect()),
        centres: points.iter().map(|point| point.place).collect(),
    })
}

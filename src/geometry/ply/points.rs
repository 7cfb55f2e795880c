//! Vertices of a PLY file as points: faces are left out.

use super::element::VertexProperties;
use super::read::Header;
use super::{Wrong, check_sizes, linear, read_file};
use crate::geometry::spheres::Points;
use crate::input::{Limits, Loading, Result};
use std::path::Path;

/// Names of the property that is a radius; the second is that of CloudCompare's scalar fields.
const RADIUS: [[&str; 1]; 2] = [["radius"], ["scalar_radius"]];

/// The vertices of a PLY file, with their radii and colours if it has them.
///
/// # Errors
/// [`crate::input::Error::Missing`] or [`crate::input::Error::Read`] if it cannot be read; [`crate::input::Error::Input`] naming it.
pub fn load_points(path: &Path, loading: &Loading) -> Result<Points> {
    read_file(path, loading, parse)
}

fn parse(bytes: &[u8], limits: Limits) -> std::result::Result<Points, Wrong> {
    let (header, mut body) = Header::parse(bytes)?;
    check_sizes(&header, bytes.len() as u64, limits)?;
    let Some(place) = header.elements.iter().position(|e| e.name == "vertex") else {
        return Err(Wrong::File("has no vertices, of which spheres are made".into()));
    };
    // what comes after the vertices is not needed
    let (vertex, before) = (&header.elements[place], &header.elements[..place]);
    for element in before {
        body.read(element, &mut |_| Ok(()))?;
    }
    let properties = VertexProperties::of(vertex)?;
    let radius = vertex.numbers(&RADIUS);
    let mut points = Points {
        centres: Vec::with_capacity(vertex.count),
        radii: radius.map(|_| Vec::with_capacity(vertex.count)),
        colors: properties.color.map(|_| Vec::with_capacity(vertex.count)),
        missing: Vec::new(),
    };
    body.read(vertex, &mut |row| {
        let number = points.centres.len();
        points.centres.push(properties.position(row));
        if let (Some(radii), Some(radius)) = (&mut points.radii, radius) {
            radii.extend(row.numbers(radius));
        }
        if let (Some(colors), Some(color)) = (&mut points.colors, properties.color) {
            colors.push(linear(color.at(row), || format!("vertex {number}"))?);
        }
        Ok(())
    })?;
    Ok(points)
}

//! Vertices of a PLY file as points: faces are left out.

use super::body::{Body, Part};
use super::element::{VertexProperties, linear};
use super::faces::not_finite;
use super::read::Header;
use super::{Wrong, read_file};
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

fn parse(header: &Header, mut body: Body, _: Limits) -> std::result::Result<Points, Wrong> {
    let Some(place) = header.elements.iter().position(|e| e.name == "vertex") else {
        return Err(Wrong::File("has no vertices, of which spheres are made".into()));
    };
    // what comes after the vertices is not needed
    let (vertex, before) = (&header.elements[place], &header.elements[..place]);
    before.iter().try_for_each(|element| body.skip(element))?;
    let properties = VertexProperties::of(vertex)?;
    let radius = vertex.numbers(&RADIUS);
    let mut points = Points {
        centres: Vec::with_capacity(vertex.count),
        radii: radius.map(|_| Vec::with_capacity(vertex.count)),
        colors: properties.color.map(|_| Vec::with_capacity(vertex.count)),
        missing: Vec::new(),
    };
    let decode = |part: &Part| {
        let (mut centres, mut radii, mut colors) = (Vec::with_capacity(part.count), Vec::new(), Vec::new());
        part.read(|row| {
            let number = part.first + centres.len();
            centres.push(properties.position(row));
            radii.extend(radius.map(|radius| row.numbers(radius)[0]));
            if let Some(color) = properties.color {
                colors.push(linear(color.at(row)).ok_or_else(|| not_finite(format_args!("vertex {number}")))?);
            }
            Ok(())
        })?;
        Ok((centres, radii, colors))
    };
    body.read(vertex, decode, |(centres, radii, colors)| {
        points.centres.extend(centres);
        points.radii.iter_mut().for_each(|all| all.extend_from_slice(&radii));
        points.colors.iter_mut().for_each(|all| all.extend_from_slice(&colors));
    })?;
    Ok(points)
}

//! Values that several kinds of camera read alike.

use crate::input::Result;
use crate::input::reader::Field;
use glam::DVec3;

/// A length above 0.
pub fn length(field: &Field) -> Result<f64> {
    let value = field.number()?;
    if value > 0.0 { Ok(value) } else { Err(field.error(format_args!("{value} is no length; give one above 0"))) }
}

/// An angle in degrees strictly between the two ends.
pub fn angle_within(field: &Field, least: f64, most: f64) -> Result<f64> {
    let value = field.number()?;
    if value > least && value < most {
        return Ok(value);
    }
    Err(field.error(format_args!("{value} must lie between {least} and {most} degrees")))
}

/// tan(angle / 2) of an angle between two borders of the image, in degrees.
pub fn half_tangent(field: &Field) -> Result<f64> {
    Ok((angle_within(field, 0.0, 180.0)?.to_radians() / 2.0).tan())
}

/// A vector's direction, at length 1.
pub fn direction(field: &Field) -> Result<DVec3> {
    field.vec3()?.try_normalize().ok_or_else(|| field.error("is zero; give a direction"))
}

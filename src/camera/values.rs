//! Values that several kinds of camera read alike.

use crate::input::reader::Field;
use crate::input::{Error, Result};
use glam::DVec3;
use std::fmt::Display;

/// A number that passes a test; the error for another one is the number itself and `wrong`.
pub fn number_if(field: &Field, is_good: impl Fn(f64) -> bool, wrong: impl Display) -> Result<f64> {
    let value = field.number()?;
    if is_good(value) { Ok(value) } else { Err(field.error(format_args!("{value} {wrong}"))) }
}

/// The message of an error of a camera that is a part of another one and has this key there: "camera.KEY: ..." becomes that key of the part.
pub fn of_part(key: impl Display, error: &Error) -> String {
    let message = error.to_string();
    format!("{key}{}", message.strip_prefix("camera").unwrap_or(&message))
}

/// Returns the value that a word stands for; `wrong` is the error for any other text.
pub fn word<T: Copy>(field: &Field, words: &[(&str, T)], wrong: &str) -> Result<T> {
    let text = field.text()?;
    words.iter().find(|word| word.0 == text).map(|word| word.1).ok_or_else(|| field.error(wrong))
}

/// A length above 0.
pub fn length(field: &Field) -> Result<f64> {
    number_if(field, |x| x > 0.0, "is no length; give one above 0")
}

/// An angle in degrees strictly between the two ends.
pub fn angle_within(field: &Field, least: f64, most: f64) -> Result<f64> {
    let wrong = format_args!("must lie between {least} and {most} degrees");
    number_if(field, |x| x > least && x < most, wrong)
}

/// tan(angle / 2) of an angle between two borders of the image, in degrees.
pub fn half_tangent(field: &Field) -> Result<f64> {
    Ok((angle_within(field, 0.0, 180.0)?.to_radians() / 2.0).tan())
}

/// A vector's direction, at length 1.
pub fn direction(field: &Field) -> Result<DVec3> {
    field.vec3()?.try_normalize().ok_or_else(|| field.error("is zero; give a direction"))
}

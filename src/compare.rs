//! The error of one frame against another, usually of an engine against the f64 reference.

mod quantiles;

use std::fmt;

use serde::Serialize;

use crate::error::{Error, Result};
use crate::frame::{Channel, Frame, NO_ID, Plane};

pub use quantiles::{Measure, Quantiles};

/// How frame `a` differs from frame `b`. A field is `None` where the channels it needs are not in both
/// frames, where there is nothing to measure, or where the caller did not say what is safe.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Comparison {
    pub pixels: u64,
    /// Pixels with different triangle ids, hit against miss included.
    pub wrong_triangle: Option<u64>,
    /// Pixels that only one of the two frames hits.
    pub wrong_hit_miss: Option<u64>,
    /// Wrong-triangle pixels among the safe ones.
    pub wrong_safe: Option<u64>,
    pub unsafe_pixels: Option<u64>,
    /// `unsafe_pixels / pixels`.
    pub unsafe_share: Option<f64>,
    /// |ta - tb| / max(|tb|, scale) over the pixels where both frames hit the same triangle.
    pub t_relative: Option<Quantiles>,
    /// The same of Z, with scale * |D| for scale.
    pub z_relative: Option<Quantiles>,
    /// Decibels of R, G, B together, linear values clamped to [0, 1], peak 1. Infinite (in JSON null)
    /// where the two are identical.
    pub psnr: Option<f64>,
    /// The clamped colours are equal everywhere.
    pub identical: Option<bool>,
    /// Largest error of a barycentric weight over the pixels where both frames hit the same triangle.
    pub bary_max: Option<Measure>,
}

/// Compares `a` against `b`. `safe` and `scales` have one value a pixel: whether every answer near the
/// pixel's centre is the same, and the scene's extent over |D|, below which differences of t are
/// measured against it. NaN is never right, whatever the other frame holds: its error is infinite.
///
/// # Errors
/// [`Error::Input`] where the frames, `safe` or `scales` differ in size.
pub fn compare(a: &Frame, b: &Frame, safe: Option<&[bool]>, scales: Option<&[f32]>) -> Result<Comparison> {
    let pixels = check_sizes(a, b, safe, scales)?;
    let ids = a.u32(Channel::TriangleId).zip(b.u32(Channel::TriangleId));
    let wrong = |i: usize| ids.is_some_and(|(a, b)| a[i] != b[i]);
    let wrong_triangle = ids.map(|_| count(pixels, wrong));
    let unsafe_pixels = safe.map(|safe| count(pixels, |i| !safe[i]));
    let same: Option<Vec<usize>> = ids.map(|(a, b)| (0..pixels).filter(|&i| a[i] == b[i] && a[i] != NO_ID).collect());
    let mse = color_error(a, b);
    Ok(Comparison {
        pixels: pixels as u64,
        wrong_triangle,
        wrong_hit_miss: hits(a, b).map(|(a, b)| count(pixels, |i| a(i) != b(i))),
        wrong_safe: safe.zip(ids).map(|(safe, _)| count(pixels, |i| safe[i] && wrong(i))),
        unsafe_pixels,
        unsafe_share: unsafe_pixels.map(|count| count as f64 / pixels as f64),
        t_relative: same.as_deref().and_then(|same| t_errors(a, b, same, scales)).and_then(Quantiles::of),
        z_relative: same.as_deref().and_then(|same| z_errors(a, b, same, scales)).and_then(Quantiles::of),
        psnr: mse.map(|mse| -10.0 * mse.log10()),
        identical: mse.map(|mse| mse == 0.0),
        bary_max: same.as_deref().and_then(|same| bary_max(a, b, same)),
    })
}

/// The number of pixels of both frames, every plane checked to have that many.
fn check_sizes(a: &Frame, b: &Frame, safe: Option<&[bool]>, scales: Option<&[f32]>) -> Result<usize> {
    if (a.width, a.height) != (b.width, b.height) {
        let sizes = format!("{} x {} against {} x {}", a.width, a.height, b.width, b.height);
        return Err(Error::input(format!("the images differ in size ({sizes}); compare images of one size")));
    }
    let pixels = a.width as usize * a.height as usize;
    let full = |frame: &Frame| {
        frame.planes.iter().all(|(_, plane)| match plane {
            Plane::F32(values) => values.len() == pixels,
            Plane::U32(values) => values.len() == pixels,
        })
    };
    let masks = safe.is_none_or(|s| s.len() == pixels) && scales.is_none_or(|s| s.len() == pixels);
    if pixels == 0 || !masks || !full(a) || !full(b) {
        return Err(Error::input("an image's channels do not fill it; there must be one value a pixel, and a pixel"));
    }
    Ok(pixels)
}

fn count(pixels: usize, holds: impl Fn(usize) -> bool) -> u64 {
    (0..pixels).filter(|&i| holds(i)).count() as u64
}

type Hits<'a> = Box<dyn Fn(usize) -> bool + 'a>;

/// Whether each frame hits something at a pixel, by the first channel of both that tells.
fn hits<'a>(a: &'a Frame, b: &'a Frame) -> Option<(Hits<'a>, Hits<'a>)> {
    for channel in [Channel::TriangleId, Channel::PieceId] {
        if let (Some(a), Some(b)) = (a.u32(channel), b.u32(channel)) {
            return Some((Box::new(|i| a[i] != NO_ID), Box::new(|i| b[i] != NO_ID)));
        }
    }
    let channel = [Channel::T, Channel::Z].into_iter().find(|&c| a.f32(c).is_some() && b.f32(c).is_some())?;
    let (a, b) = (a.f32(channel)?, b.f32(channel)?);
    // A miss is +inf; NaN is a hit with a wrong value.
    Some((Box::new(|i| a[i] != f32::INFINITY), Box::new(|i| b[i] != f32::INFINITY)))
}

fn t_errors(a: &Frame, b: &Frame, same: &[usize], scales: Option<&[f32]>) -> Option<Vec<f64>> {
    let (ta, tb) = (a.f32(Channel::T)?, b.f32(Channel::T)?);
    Some(same.iter().map(|&i| relative(ta[i].into(), tb[i].into(), scale_at(scales, i))).collect())
}

fn z_errors(a: &Frame, b: &Frame, same: &[usize], scales: Option<&[f32]>) -> Option<Vec<f64>> {
    let (za, zb) = (a.f32(Channel::Z)?, b.f32(Channel::Z)?);
    let floor = |i: usize| match (a.f32(Channel::T), b.f32(Channel::T)) {
        (Some(ta), Some(tb)) => scale_at(scales, i) * ray_length(za[i], ta[i]).max(ray_length(zb[i], tb[i])),
        _ => 0.0,
    };
    Some(same.iter().map(|&i| relative(za[i].into(), zb[i].into(), floor(i))).collect())
}

/// |D| of a straight ray from Z = t |D|; 0 where these two do not tell.
fn ray_length(z: f32, t: f32) -> f64 {
    let length = (f64::from(z) / f64::from(t)).abs();
    if length.is_finite() { length } else { 0.0 }
}

fn scale_at(scales: Option<&[f32]>, pixel: usize) -> f64 {
    scales.map(|s| f64::from(s[pixel])).filter(|s| s.is_finite()).unwrap_or(0.0)
}

/// |a - b| / max(|b|, scale); infinite where that is not a number, 0 where the two are equal.
fn relative(a: f64, b: f64, scale: f64) -> f64 {
    if a == b {
        return 0.0;
    }
    let error = (a - b).abs() / b.abs().max(scale);
    if error.is_nan() { f64::INFINITY } else { error }
}

fn bary_max(a: &Frame, b: &Frame, same: &[usize]) -> Option<Measure> {
    let mut largest: f64 = 0.0;
    for channel in [Channel::BaryU, Channel::BaryV] {
        let (a, b) = (a.f32(channel)?, b.f32(channel)?);
        for &i in same {
            let error = (f64::from(a[i]) - f64::from(b[i])).abs();
            largest = largest.max(if error.is_nan() { f64::INFINITY } else { error });
        }
    }
    (!same.is_empty()).then_some(Measure(largest))
}

/// Mean squared error of R, G and B, each clamped to [0, 1]; NaN has the largest error, 1.
fn color_error(a: &Frame, b: &Frame) -> Option<f64> {
    let mut sum = 0.0;
    let mut values = 0;
    for channel in [Channel::R, Channel::G, Channel::B] {
        let (a, b) = (a.f32(channel)?, b.f32(channel)?);
        values += a.len();
        for (a, b) in a.iter().zip(b) {
            let error = f64::from(a.clamp(0.0, 1.0)) - f64::from(b.clamp(0.0, 1.0));
            sum += if error.is_nan() { 1.0 } else { error * error };
        }
    }
    Some(sum / values as f64)
}

impl fmt::Display for Comparison {
    /// One line for a person; what could not be measured is left out.
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{} pixels", self.pixels)?;
        if let Some(wrong) = self.wrong_triangle {
            write!(f, ", {wrong} with the wrong triangle")?;
        }
        if let Some(wrong) = self.wrong_safe {
            write!(f, " ({wrong} of them safe)")?;
        }
        if let Some(wrong) = self.wrong_hit_miss {
            write!(f, ", {wrong} wrong hit or miss")?;
        }
        if let (Some(count), Some(share)) = (self.unsafe_pixels, self.unsafe_share) {
            write!(f, ", {count} unsafe ({:.3} %)", 100.0 * share)?;
        }
        for (name, quantiles) in [("t", &self.t_relative), ("Z", &self.z_relative)] {
            if let Some(quantiles) = quantiles {
                write!(f, ", {name} error {quantiles}")?;
            }
        }
        if let Some(bary) = self.bary_max {
            write!(f, ", barycentric error max {bary}")?;
        }
        match (self.identical, self.psnr) {
            (Some(true), _) => write!(f, ", colour identical"),
            (_, Some(psnr)) => write!(f, ", PSNR {psnr:.2} dB"),
            _ => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests;

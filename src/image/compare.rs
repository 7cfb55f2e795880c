//! The error of one frame against another, usually of an engine against the f64 reference.

mod quantiles;

use std::fmt;

use serde::Serialize;

use crate::image::frame::{Channel, Frame, NO_ID};
use crate::input::{Error, Result};

pub use quantiles::{Measure, Quantiles};

/// How frame `a` differs from frame `b`. A field is `None` where the channels it needs are not in both
/// frames, if there is nothing to measure, or if the caller gave no safe pixels.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Comparison {
    /// All pixels.
    pub pixels: u64,
    /// The channels that both frames have. Only these are compared.
    pub channels: Vec<&'static str>,
    /// Pixels with different triangle ids, hit against miss included.
    pub wrong_triangle: Option<u64>,
    /// Pixels where only one of the two frames hits something, by the first of triangle.id, t, Z, object.id, material.id and piece.id
    /// that both have.
    pub wrong_hit_miss: Option<u64>,
    /// Wrong-triangle pixels among the safe ones.
    pub wrong_safe: Option<u64>,
    /// Pixels that are not safe: their answer changes within 1/16 px of their centre.
    pub unsafe_pixels: Option<u64>,
    /// `unsafe_pixels / pixels`.
    pub unsafe_share: Option<f64>,
    /// The pixels where t and Z are compared.
    pub where_both_hit: Option<Matched>,
    /// |ta - tb| / max(|tb|, scale) in these pixels.
    pub t_relative: Option<Quantiles>,
    /// The same of Z, with scale * |D| for scale.
    pub z_relative: Option<Quantiles>,
    /// Decibels of R, G, B together, linear values clamped to [0, 1], peak 1. Infinite (in JSON null)
    /// where the two are identical.
    pub psnr: Option<f64>,
    /// The clamped colours are equal everywhere.
    pub identical: Option<bool>,
    /// Largest error of a barycentric weight where both frames hit the same triangle.
    pub bary_max: Option<Measure>,
    /// The differences of all other channels.
    pub others: Vec<Difference>,
}

impl Comparison {
    /// As `anamorph compare --json` prints it.
    pub fn json(&self) -> String {
        serde_json::to_string_pretty(self).unwrap_or_default()
    }
}

/// The pixels where depth is compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Matched {
    /// Both frames hit the same triangle.
    SameTriangle,
    /// Both frames hit something; at least one of them has no triangle ids.
    BothHit,
}

/// The difference of one channel over all pixels.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Difference {
    /// Its name.
    pub channel: &'static str,
    /// Pixels with different values; NaN is different from every value.
    pub pixels: u64,
    /// The largest difference; `None` for ids.
    pub max: Option<Measure>,
}

/// Compares `a` against `b`. `safe` and `scales` have one value per pixel: whether it is safe, and the
/// scene's extent over |D|, the least scale for relative errors of t. NaN is always wrong: its error is infinite.
///
/// # Errors
/// [`Error::Input`] if the frames, `safe` or `scales` differ in size, or the frames have no channel in common.
pub fn compare(a: &Frame, b: &Frame, safe: Option<&[bool]>, scales: Option<&[f32]>) -> Result<Comparison> {
    let pixels = check_sizes(a, b, safe, scales)?;
    let ids = a.u32(Channel::TriangleId).zip(b.u32(Channel::TriangleId));
    let wrong = |i: usize| ids.is_some_and(|(a, b)| a[i] != b[i]);
    let wrong_triangle = ids.map(|_| count(pixels, wrong));
    let unsafe_pixels = safe.map(|safe| count(pixels, |i| !safe[i]));
    let channels = common(a, b)?;
    let hits = hits(a, b);
    let where_both = |hit: &dyn Fn(usize) -> bool| (0..pixels).filter(|&i| hit(i)).collect();
    let (matched, compared): (_, Vec<usize>) = match (ids, &hits) {
        (Some((a, b)), _) => (Some(Matched::SameTriangle), where_both(&|i| a[i] == b[i] && a[i] != NO_ID)),
        (None, Some([a, b])) => (Some(Matched::BothHit), where_both(&|i| a[i] && b[i])),
        (None, None) => (None, Vec::new()),
    };
    let mse = color_error(a, b);
    let others = channels.iter().filter(|c| !is_measured(**c, mse.is_some(), ids.is_some()));
    Ok(Comparison {
        pixels: pixels as u64,
        channels: channels.iter().map(|c| c.name()).collect(),
        wrong_triangle,
        wrong_hit_miss: hits.as_ref().map(|[a, b]| count(pixels, |i| a[i] != b[i])),
        wrong_safe: safe.zip(ids).map(|(safe, _)| count(pixels, |i| safe[i] && wrong(i))),
        unsafe_pixels,
        unsafe_share: unsafe_pixels.map(|count| count as f64 / pixels as f64),
        where_both_hit: matched,
        t_relative: t_errors(a, b, &compared, scales).and_then(Quantiles::of),
        z_relative: z_errors(a, b, &compared, scales).and_then(Quantiles::of),
        psnr: mse.map(|mse| -10.0 * mse.log10()),
        identical: mse.map(|mse| mse == 0.0),
        bary_max: ids.and_then(|_| bary_max(a, b, &compared)),
        others: others.filter_map(|c| difference(a, b, *c)).collect(),
    })
}

/// The channels that both frames have.
fn common(a: &Frame, b: &Frame) -> Result<Vec<Channel>> {
    let of = |frame: &Frame| frame.planes.iter().map(|(channel, _)| *channel).collect::<Vec<_>>();
    let (of_a, of_b) = (of(a), of(b));
    let both: Vec<Channel> = of_a.iter().copied().filter(|c| of_b.contains(c)).collect();
    if both.is_empty() {
        let names = |list: &[Channel]| list.iter().map(|c| c.name()).collect::<Vec<_>>().join(" ");
        let (of_a, of_b) = (names(&of_a), names(&of_b));
        return Err(Error::input(format!(
            "nothing to compare: the first image has {of_a}, the second {of_b}; render both with a channel in common"
        )));
    }
    Ok(both)
}

/// Whether a [`Comparison`] has a field for the error of this channel.
fn is_measured(channel: Channel, has_colour: bool, has_triangles: bool) -> bool {
    match channel {
        Channel::R | Channel::G | Channel::B => has_colour,
        Channel::BaryU | Channel::BaryV => has_triangles,
        Channel::TriangleId | Channel::T | Channel::Z => true,
        _ => false,
    }
}

fn difference(a: &Frame, b: &Frame, channel: Channel) -> Option<Difference> {
    let name = channel.name();
    if let (Some(a), Some(b)) = (a.u32(channel), b.u32(channel)) {
        return Some(Difference { channel: name, pixels: count(a.len(), |i| a[i] != b[i]), max: None });
    }
    let (a, b) = (a.f32(channel)?, b.f32(channel)?);
    let error = |i: usize| match (f64::from(a[i]), f64::from(b[i])) {
        (a, b) if a == b => 0.0,
        (a, b) => Some((a - b).abs()).filter(|e| !e.is_nan()).unwrap_or(f64::INFINITY),
    };
    let max = (0..a.len()).map(error).fold(0.0, f64::max);
    Some(Difference { channel: name, pixels: count(a.len(), |i| a[i] != b[i]), max: Some(Measure(max)) })
}

/// The number of pixels of both frames, every plane checked to have that many.
fn check_sizes(a: &Frame, b: &Frame, safe: Option<&[bool]>, scales: Option<&[f32]>) -> Result<usize> {
    if (a.width, a.height) != (b.width, b.height) {
        let sizes = format!("{} x {} against {} x {}", a.width, a.height, b.width, b.height);
        return Err(Error::input(format!("the images differ in size ({sizes}); compare images of one size")));
    }
    let pixels = a.width as usize * a.height as usize;
    let full = |frame: &Frame| frame.planes.iter().all(|(_, plane)| plane.count() == pixels);
    let masks = safe.is_none_or(|s| s.len() == pixels) && scales.is_none_or(|s| s.len() == pixels);
    if pixels == 0 || !masks || !full(a) || !full(b) {
        return Err(Error::input("an image's channels do not fill it; there must be one value a pixel, and a pixel"));
    }
    Ok(pixels)
}

fn count(pixels: usize, holds: impl Fn(usize) -> bool) -> u64 {
    (0..pixels).filter(|&i| holds(i)).count() as u64
}

/// Whether each frame hits something at each pixel, by the first suitable channel of both.
fn hits(a: &Frame, b: &Frame) -> Option<[Vec<bool>; 2]> {
    // piece.id last: with a mirror, a pixel has a piece even if its ray hits nothing
    let telling =
        [Channel::TriangleId, Channel::T, Channel::Z, Channel::ObjectId, Channel::MaterialId, Channel::PieceId];
    telling.into_iter().find_map(|channel| {
        if let (Some(a), Some(b)) = (a.u32(channel), b.u32(channel)) {
            return Some([a, b].map(|ids| ids.iter().map(|id| *id != NO_ID).collect()));
        }
        let (a, b) = (a.f32(channel)?, b.f32(channel)?);
        // A miss is +inf; NaN is a hit with a wrong value.
        Some([a, b].map(|numbers| numbers.iter().map(|number| *number != f32::INFINITY).collect()))
    })
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

/// |D| of a straight ray from Z = t |D|; 0 if they do not determine it.
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
    /// A line of text; values that could not be measured are left out.
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{} pixels of {}", self.pixels, self.channels.join(" "))?;
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
                let of = if self.where_both_hit == Some(Matched::BothHit) { " where both hit" } else { "" };
                write!(f, ", {name} error{of} {quantiles}")?;
            }
        }
        if let Some(bary) = self.bary_max {
            write!(f, ", barycentric error max {bary}")?;
        }
        for Difference { channel, pixels, max } in &self.others {
            match max {
                _ if *pixels == 0 => {}
                Some(max) => write!(f, ", {channel} differs in {pixels} by at most {max}")?,
                None => write!(f, ", {channel} differs in {pixels}")?,
            }
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

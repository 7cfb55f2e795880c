//! Calibration files: which format a file has, and what all of them say.

mod colmap;
mod kalibr;
pub mod opencv;
mod rig;
mod xml;

use crate::camera::calibration::{Intrinsics, Model};
use crate::input::{Error, Loading, Result};
use glam::{DMat2, DQuat, DVec2, DVec3};
use std::path::Path;

/// One camera of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct Calibration {
    pub intrinsics: Intrinsics,
    pub model: Model,
    /// Of an image, if one was asked for.
    pub placed: Option<Placed>,
    /// What the file does not say, and is taken for granted.
    pub note: Option<String>,
}

/// Where an image was taken from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placed {
    /// In the world.
    pub eye: DVec3,
    /// From the camera's frame (x right, y down, z forward) to the world's.
    pub rotation: DQuat,
}

/// Which camera of a file is meant.
#[derive(Debug, Clone, Copy)]
pub enum Which<'a> {
    /// The only one.
    Only,
    /// That of this number: COLMAP's id, Kalibr's N of camN, or the place in a rig's list of sensors, from 0.
    Index(u64),
    /// That of an image of COLMAP's, by name.
    Image(&'a str),
}

impl Which<'_> {
    /// The only one of what a file has, or the one of this number.
    fn of<T>(self, mut all: Vec<(u64, T)>) -> std::result::Result<T, String> {
        let listed = || all.iter().map(|(n, _)| n.to_string()).collect::<Vec<_>>().join(", ");
        let at = match self {
            Which::Only if all.len() == 1 => Some(0),
            Which::Only if all.is_empty() => return Err("has no camera that can be used".into()),
            Which::Only => return Err(format!("has cameras {}; choose one: index = {}", few(&listed()), all[0].0)),
            Which::Index(index) => all.iter().position(|(n, _)| *n == index),
            Which::Image(_) => return Err("has no images, only COLMAP's models have; give index".into()),
        };
        match at {
            Some(at) => Ok(all.swap_remove(at).1),
            None => Err(format!("has no camera of this index; it has {}", few(&listed()))),
        }
    }
}

/// A list, cut where it is long.
fn few(listed: &str) -> String {
    match listed.char_indices().nth(80) {
        Some((end, _)) => format!("{}...", &listed[..end]),
        None => listed.into(),
    }
}

/// Reads a camera from a file of OpenCV, ROS, Kalibr or NVIDIA's DRIVE, or from a folder that COLMAP wrote (or its file of cameras).
///
/// # Errors
/// [`Error::Input`], [`Error::Missing`] or [`Error::Read`] naming the file: it cannot be read, is none of these, or has no such camera.
pub fn read(path: &Path, which: Which, loading: &Loading) -> Result<Calibration> {
    if colmap::is_model(path) {
        return colmap::read(path, which, loading);
    }
    let text =
        loading.read_to_string(path).map_err(|e| Error::unreadable(path, format_args!("{e}; check the path")))?;
    let read = if rig::is_rig(&text) {
        rig::parse(&text, which)
    } else if kalibr::is_chain(&text) {
        kalibr::parse(&text, which)
    } else {
        opencv::parse(&text).and_then(|file| match which {
            Which::Only => file.calibration(None),
            _ => Err("has one camera; leave index and image out".into()),
        })
    };
    read.map_err(|why| Error::input(format!("{}: {why}", path.display())))
}

/// The names of the images of a folder that COLMAP wrote, in order.
///
/// # Errors
/// [`Error::Input`], [`Error::Missing`] or [`Error::Read`] naming the file of images: it cannot be read, or has none.
pub fn images(model: &Path, loading: &Loading) -> Result<Vec<String>> {
    colmap::images(model, loading)
}

/// The poses of those images, in the same order.
///
/// # Errors
/// As [`images`].
pub fn poses(model: &Path, loading: &Loading) -> Result<Vec<Placed>> {
    colmap::poses(model, loading)
}

/// It is a folder that COLMAP wrote, or its file of images.
pub fn has_images(path: &Path) -> bool {
    colmap::has_images(path)
}

/// The intrinsics of a camera without skew, its principal point in OpenCV's pixels; checked.
fn intrinsics(size: [u64; 2], focal: DVec2, centre: DVec2) -> std::result::Result<Intrinsics, String> {
    crate::image::size::check_size(size[0], size[1]).map_err(|e| e.to_string())?;
    if !(focal.min_element() > 0.0 && (focal.x * focal.y).is_finite() && centre.is_finite()) {
        return Err(format!(
            "focal lengths {}, {} and principal point {}, {}: the lengths must be over 0, and all numbers finite",
            focal.x, focal.y, centre.x, centre.y
        ));
    }
    // checked above to be far under 2^32
    let size = (size[0] as u32, size[1] as u32);
    Ok(Intrinsics { size, scale: DMat2::from_diagonal(focal), centre })
}

//! Many points at once: their images as arrays, and pictures of them.

use super::Camera;
use crate::camera::project::Projector;
use crate::gpu::Gpu;
use crate::gpu::device::{GpuOptions, NO_ADAPTER};
use crate::input::{Error, Result};
use crate::jobs::project::{self, Projected};
use crate::jobs::splat::{self, Splatted};
use bytemuck::cast_slice;

/// What works on points.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Device {
    /// The CPU, in f64.
    #[default]
    Cpu,
    /// The fastest adapter.
    Gpu,
    /// The adapter of this name, or of which it is a part.
    Named(String),
}

impl Device {
    fn open(&self) -> Result<Option<Gpu>> {
        let adapter = match self {
            Device::Cpu => return Ok(None),
            Device::Gpu => None,
            Device::Named(name) => Some(name.clone()),
        };
        let gpu = Gpu::open(&GpuOptions { adapter, ..GpuOptions::default() })?;
        gpu.map(Some).ok_or_else(|| Error::work(format!("{NO_ADAPTER}; use Device::Cpu")))
    }
}

/// All images of many points (world units), as arrays: those of [`project`](super::project), in its order.
///
/// With a device kernels prove, in f32 with bounds, where a camera of pieces does not show a point; the images are still found in f64, and
/// the numbers are the same to the last bit. Where `within_px` is over 0, images whose place the kernels prove to be within it are taken from
/// them: `x` and `y` are then off by up to `within_px`, and t by as little as f32 has it; [`Projected::by_kernel`] counts their points. No image
/// is lost either way.
///
/// # Errors
/// [`Error::Input`] for a device that is not there, a bound that is negative or no number, or a camera with a mirror or a lens; [`Error::Work`] if the device fails.
pub fn project_many(camera: &Camera, points: &[[f64; 3]], device: &Device, within_px: f64) -> Result<Projected> {
    if within_px.is_nan() || within_px < 0.0 {
        return Err(Error::input(format!("within_px: {within_px} is not a distance in pixels; use 0 or more")));
    }
    refuse_optics(camera)?;
    let gpu = device.open()?;
    project::project_many(&Projector::new(&camera.camera), cast_slice(points), gpu.as_ref(), within_px)
}

/// Draws points (world units): each pixel shows the nearest of those whose images lie in it, by t; of several at one t the one of the lowest
/// index. Every image of a point counts. The result is the same on every device.
///
/// # Errors
/// [`Error::Input`] for a device that is not there, or a camera with a mirror or a lens; [`Error::Work`] if the device fails, or for 2^32 - 1 points or more.
pub fn splat(camera: &Camera, points: &[[f64; 3]], device: &Device) -> Result<Splatted> {
    refuse_optics(camera)?;
    let gpu = device.open()?;
    splat::splat(&camera.camera, cast_slice(points), gpu.as_ref())
}

pub(super) fn refuse_optics(camera: &Camera) -> Result<()> {
    match camera.camera.optics {
        None => Ok(()),
        Some(_) => Err(Error::input(format!("camera: {} reflects or refracts rays; use another kind", camera.kind()))),
    }
}

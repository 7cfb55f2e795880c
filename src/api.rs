//! The public API: a few types over the layers below.

mod batch;
mod builder;
mod camera;
mod caster;
mod gradients;
mod job;
mod mesh;
mod objects;
mod pictures;
mod project;
mod renderer;
mod scene;
mod time;
mod values;
#[cfg(feature = "view")]
mod view;
mod views;
mod volume;

pub use self::batch::Batch;
pub use self::builder::CameraBuilder;
pub use self::camera::{Camera, camera_kinds, colmap_images, project};
pub use self::caster::{Caster, RayHit};
pub use self::gradients::{GradientArray, GradientParameter, Gradients, Numbers};
pub use self::job::Job;
pub use self::mesh::Mesh;
pub use self::project::{Device, project_many, splat};
pub use self::renderer::{RenderOptions, Rendered, Renderer, check, reference};
pub use self::scene::{Placed, Scene};
pub use self::time::{Exposure, LineOrder};
pub use self::values::{Table, Value};
#[cfg(feature = "view")]
pub use self::view::Viewer;
pub use self::views::Views;
pub use crate::camera::project::{Degenerate, Image, Images};
pub use crate::image::compare::{Comparison, Difference, Matched, Measure, Quantiles};
pub use crate::image::frame::{Channel, Frame, NO_ID, Plane};
pub use crate::input::Limits;
pub use crate::jobs::batch::{BatchOptions, Counts as BatchCounts, Event as BatchEvent, Outcome as BatchOutcome};
pub use crate::jobs::batch::{Shard, Task as BatchFrame, Worked as DeviceUse};
pub use crate::jobs::project::Projected;
pub use crate::jobs::splat::Splatted;

use crate::input::{Loading, Result};
use std::path::Path;

/// Reads those channels of an EXR that are named like [`Channel`]s.
///
/// # Errors
/// [`Error::Missing`](crate::Error::Missing) or [`Error::Read`](crate::Error::Read) if the file cannot be read, [`Error::Input`](crate::Error::Input) if it is no EXR.
pub fn read_exr(path: impl AsRef<Path>) -> Result<Frame> {
    crate::image::read_exr(path.as_ref(), &Loading::default())
}

/// Writes a frame as EXR.
///
/// # Errors
/// [`Error::Write`](crate::Error::Write) if the file cannot be written.
pub fn write_exr(path: impl AsRef<Path>, frame: &Frame) -> Result<()> {
    crate::image::write_exr(path.as_ref(), frame, &[])
}

/// Writes 8-bit sRGB colour of `width x height` pixels as PNG: three (RGB) or four (RGBA) bytes each, row by row from the top.
///
/// # Errors
/// [`Error::Work`](crate::Error::Work) if there are not so many bytes, [`Error::Write`](crate::Error::Write) if the file cannot be written.
pub fn write_png(path: impl AsRef<Path>, (width, height): (u32, u32), srgb8: &[u8]) -> Result<()> {
    crate::image::write_png(path.as_ref(), width, height, srgb8)
}

/// Compares `a` with `b` in the channels that both have.
///
/// # Errors
/// [`Error::Input`](crate::Error::Input) if they differ in size or have no channel in common.
pub fn compare(a: &Frame, b: &Frame) -> Result<Comparison> {
    crate::image::compare::compare(a, b, None, None)
}

//! `anamorph info FILE` of a calibration: its format, and the size, lens and field of view of each camera.

use crate::camera::kinds::calibrated::file::{self, Calibration};
use crate::camera::kinds::calibrated::{numbers, survey::Survey};
use crate::input::{Loading, Result};
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt;
use std::path::Path;

#[derive(Serialize)]
pub struct Calibrations {
    file: String,
    /// "calibration".
    kind: &'static str,
    format: &'static str,
    cameras: Vec<Camera>,
    /// Cameras after the first [`CAMERAS_MAX`].
    more_cameras: usize,
    /// Images with a pose.
    images: usize,
    /// The first of them, for `image`.
    #[serde(skip_serializing_if = "Option::is_none")]
    first_image: Option<String>,
}

#[derive(Serialize)]
struct Camera {
    /// The value of the key `index`.
    index: u64,
    #[serde(flatten)]
    found: Found,
}

#[derive(Serialize)]
#[serde(untagged)]
enum Found {
    Lens(Lens),
    Unusable { error: String },
}

#[derive(Serialize)]
struct Lens {
    width: u32,
    height: u32,
    projection: &'static str,
    /// Its numbers other than 0.
    numbers: BTreeMap<&'static str, f64>,
    /// Degrees along the middle row and column.
    field_of_view: [f64; 2],
    /// Share of the pixels that have a ray.
    with_ray: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    note: Option<String>,
}

/// Most cameras that are described; projects may have one for each image.
const CAMERAS_MAX: usize = 20;

/// A folder, or a file with the name of a calibration, or one whose text is one.
pub fn is_calibration(path: &Path, loading: &Loading) -> bool {
    const NAMES: [&str; 7] = ["yaml", "yml", "xml", "txt", "ini", "sfm", "bin"];
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    let is_json = || loading.read_to_string(path).is_ok_and(|text| file::is_calibration(&text));
    path.is_dir() || NAMES.contains(&extension.as_str()) || extension == "json" && is_json()
}

pub fn read(path: &Path, loading: &Loading) -> Result<Calibrations> {
    let (format, contents) = file::load(path, loading)?;
    let placed: Vec<_> = contents.images.into_iter().filter(|image| image.placed.is_ok()).collect();
    let more_cameras = contents.cameras.len().saturating_sub(CAMERAS_MAX);
    let found = |found: std::result::Result<Calibration, String>| {
        let lens = found.and_then(|calibration| Lens::of(&calibration));
        lens.map_or_else(|error| Found::Unusable { error }, Found::Lens)
    };
    let cameras = contents.cameras.into_iter().take(CAMERAS_MAX);
    Ok(Calibrations {
        file: path.display().to_string(),
        kind: "calibration",
        format,
        cameras: cameras.map(|(index, camera)| Camera { index, found: found(camera) }).collect(),
        more_cameras,
        images: placed.len(),
        first_image: placed.into_iter().next().map(|image| image.name),
    })
}

impl Lens {
    fn of(calibration: &Calibration) -> std::result::Result<Lens, String> {
        let survey = Survey::of(calibration)?;
        let Calibration { intrinsics, model, note, .. } = calibration;
        Ok(Lens {
            width: intrinsics.size.0,
            height: intrinsics.size.1,
            projection: model.projection.name(),
            numbers: numbers::listed(intrinsics, model).into_iter().collect(),
            field_of_view: survey.field_of_view,
            with_ray: survey.with_ray as f64 / survey.pixels as f64,
            note: note.clone(),
        })
    }
}

impl fmt::Display for Calibrations {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        writeln!(f, "{} ({}, {})", self.file, self.kind, self.format)?;
        for camera in &self.cameras {
            match &camera.found {
                Found::Lens(lens) => write!(f, "  camera {:<14}{lens}", camera.index)?,
                Found::Unusable { error } => writeln!(f, "  camera {:<14}cannot be used: {error}", camera.index)?,
            }
        }
        if self.more_cameras > 0 {
            writeln!(f, "  and {} cameras more", self.more_cameras)?;
        }
        if let Some(first) = &self.first_image {
            writeln!(f, "  images with poses    {}, the first is {first:?}", self.images)?;
        }
        Ok(())
    }
}

impl fmt::Display for Lens {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let [across, down] = self.field_of_view;
        let numbers: Vec<String> = self.numbers.iter().map(|(name, number)| format!("{name} = {number}")).collect();
        writeln!(f, "{} x {}, {}", self.width, self.height, self.projection)?;
        writeln!(f, "    numbers            {}", numbers.join(", "))?;
        writeln!(f, "    field of view      {across:.1} x {down:.1} degrees, along the middle row and column")?;
        // rounded down, so that 100 means all
        writeln!(f, "    pixels with a ray  {} %", (self.with_ray * 1000.0).floor() / 10.0)?;
        self.note.iter().try_for_each(|note| writeln!(f, "    note               {note}"))
    }
}

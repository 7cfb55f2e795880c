//! `opencv`: a calibrated camera, its intrinsics read from a file that OpenCV wrote; with a rolling shutter.

mod brown;
pub(crate) mod file;
mod inverse;
mod kannala_brandt;
pub(crate) mod lens;
mod roots;
mod tilt;

use super::central::{POSE, Pose};
use crate::camera::recipe::{Built, Recipe, Setting};
use crate::camera::tessellate::{KEYS, Tessellation};
use crate::camera::view::View;
use crate::camera::{Ray, RayMap};
use crate::input::Result;
use crate::input::reader::{Field, Table};
use file::Intrinsics;
use glam::{DQuat, DVec2, DVec3};
use lens::{Distortion, Model};
use std::sync::Arc;

#[derive(Debug, PartialEq)]
struct OpenCv {
    pose: Pose,
    intrinsics: Intrinsics,
    model: Model,
    distortion: Distortion,
    shutter: Shutter,
    tessellation: Tessellation,
}

/// Everything that defines the rays. The reference computes its own rays from this alone.
#[derive(Debug, Clone)]
pub struct Calibrated {
    pub eye: DVec3,
    pub view: View,
    pub intrinsics: Intrinsics,
    pub model: Model,
    pub shutter: Shutter,
}

/// How the camera moves while its rows are read, top to bottom.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shutter {
    /// Seconds from one row to the next.
    pub line_time: f64,
    /// World units a second.
    pub velocity: DVec3,
    /// Radians a second about the world's axes through the eye, right-handed.
    pub angular: DVec3,
}

impl Shutter {
    fn is_still(&self) -> bool {
        self.line_time == 0.0 || (self.velocity, self.angular) == (DVec3::ZERO, DVec3::ZERO)
    }
}

pub fn read(table: &Table) -> Result<Arc<dyn Recipe>> {
    let own = ["file", "model", "line_time", "velocity", "angular_velocity"];
    table.allow(&[&["kind", "t_range"], &POSE[..], &own, &KEYS].concat())?;
    let file = table.need("file", "\"camera.yml\"")?;
    let intrinsics = file::read(&file.path()?)?;
    let model = model(table, &file, &intrinsics)?;
    let distortion = Distortion::new(&model).map_err(|why| file.error(why))?;
    let shutter = Shutter {
        line_time: table.or("line_time", 0.0, Field::number)?,
        velocity: table.or("velocity", DVec3::ZERO, Field::vec3)?,
        angular: table.or("angular_velocity", DVec3::ZERO, Field::vec3)?.map(f64::to_radians),
    };
    for key in ["velocity", "angular_velocity"] {
        if let (Some(field), false) = (table.get(key), table.has("line_time")) {
            return Err(field.error("the camera moves from row to row only with a line_time; add line_time = 3e-5"));
        }
    }
    let (pose, tessellation) = (Pose::read(table)?, Tessellation::read(table)?);
    Ok(Arc::new(OpenCv { pose, intrinsics, model, distortion, shutter, tessellation }))
}

/// The model that the scene names, or else the file, with the file's coefficients.
fn model(table: &Table, file: &Field, intrinsics: &Intrinsics) -> Result<Model> {
    let named = table.optional("model", |field| match field.text()? {
        "brown" => Ok(false),
        "fisheye" => Ok(true),
        _ => Err(field.error("use \"brown\" or \"fisheye\"")),
    })?;
    if let (Some(field), Some(said), Some((in_file, key))) = (table.get("model"), named, &intrinsics.fisheye)
        && said != *in_file
    {
        return Err(field.error(format_args!("the file says {key}; leave model out, or correct the file")));
    }
    let k = &intrinsics.coefficients;
    let refuse = |known: &str| Err(file.error(format_args!("{} distortion coefficients; {known}", k.len())));
    if named.or(intrinsics.fisheye.as_ref().map(|f| f.0)).unwrap_or(false) {
        return match k[..] {
            [a, b, c, d] => Ok(Model::Fisheye([a, b, c, d])),
            _ => refuse("the fisheye model has 4"),
        };
    }
    match k.len() {
        0 | 4 | 5 | 8 | 12 | 14 => Ok(Model::Brown(std::array::from_fn(|i| k.get(i).copied().unwrap_or(0.0)))),
        _ => refuse("the Brown model has 0, 4, 5, 8, 12 or 14"),
    }
}

impl Recipe for OpenCv {
    fn build(&self, setting: &Setting) -> Result<Built> {
        let size = setting.size.or(Some(self.intrinsics.size));
        let calibrated = Calibrated {
            eye: self.pose.eye,
            view: self.pose.view()?,
            intrinsics: self.intrinsics.clone(),
            model: self.model,
            shutter: self.shutter,
        };
        self.tessellation.build(Arc::new(Sensor { calibrated, distortion: self.distortion }), &setting.of_size(size))
    }
}

/// The rays of the calibrated image, stretched over the image.
#[derive(Debug)]
struct Sensor {
    calibrated: Calibrated,
    distortion: Distortion,
}

impl RayMap for Sensor {
    /// The place (a, b) is OpenCV's pixel `(a W - 1/2, b H - 1/2)` of the calibrated image.
    fn ray(&self, a: f64, b: f64) -> Option<Ray> {
        let Calibrated { eye, view, intrinsics: Intrinsics { size, focal, centre, .. }, shutter, .. } =
            &self.calibrated;
        let pixel = DVec2::new(a * f64::from(size.0), b * f64::from(size.1)) - 0.5;
        let d = self.distortion.direction((pixel - *centre) / *focal)?;
        // OpenCV's camera has y down
        let direction = view.vector(d.x, -d.y, d.z);
        let time = pixel.y * shutter.line_time;
        let rotation = DQuat::from_scaled_axis(shutter.angular * time);
        Some(Ray { origin: *eye + time * shutter.velocity, direction: rotation * direction })
    }

    /// By the forward formula, if the camera stands still.
    fn images(&self, point: DVec3) -> Option<Vec<(DVec2, f64)>> {
        let Calibrated { eye, view, intrinsics: Intrinsics { size, focal, centre, .. }, shutter, .. } =
            &self.calibrated;
        let v = point - *eye;
        let rounding = f64::EPSILON * (point.length() + eye.length());
        if !shutter.is_still() || v.length() <= rounding {
            return None;
        }
        let places = self.distortion.places(DVec3::new(v.dot(view.right), -v.dot(view.up), v.dot(view.forward)))?;
        let size = DVec2::new(size.0.into(), size.1.into());
        Some(places.into_iter().map(|(q, t)| ((q * *focal + *centre + 0.5) / size, t)).collect())
    }

    fn calibrated(&self) -> Option<&Calibrated> {
        Some(&self.calibrated)
    }
}

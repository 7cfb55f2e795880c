//! `calibrated` and `opencv`: cameras with the intrinsics of a calibration file, of an image of a project, and with a rolling shutter.

mod branches;
mod brown;
pub(crate) mod file;
mod inverse;
pub(crate) mod lens;
pub(crate) mod numbers;
mod projection;
mod roots;
#[cfg(feature = "cli")]
pub(crate) mod survey;
mod tilt;
mod without_rays;

use super::{POSE, Pose, Posed};
use crate::camera::calibration::{Calibrated, Intrinsics, Model, Shutter};
use crate::camera::exposure::{LineOrder, Lines};
use crate::camera::recipe::{Built, Recipe, Setting};
use crate::camera::tessellate::{KEYS, Tessellation};
use crate::camera::values::word;
use crate::camera::{Ray, RayMap};
use crate::input::reader::{Field, Table};
use crate::input::{Error, Result};
use file::{Calibration, Which};
use glam::{DQuat, DVec2, DVec3};
use lens::Lens;
use std::sync::Arc;

#[derive(Debug, Clone, PartialEq)]
struct FromFile {
    pose: Pose,
    intrinsics: Intrinsics,
    model: Model,
    lens: Lens,
    shutter: Shutter,
    tessellation: Tessellation,
    /// What the file leaves open.
    note: Option<String>,
}

const SHUTTER: [&str; 3] = ["line_time", "velocity", "angular_velocity"];

/// Kind `calibrated`: any file.
pub fn read(table: &Table) -> Result<Arc<dyn Recipe>> {
    table.allow(&[&["kind", "t_range", "file", "image", "index"], &SHUTTER[..], &POSE, &KEYS].concat())?;
    let file = table.need("file", "\"cameras.txt\"")?;
    let which = match (table.optional("image", Field::text)?, table.optional("index", |f| f.integer(0, u64::MAX))?) {
        (Some(_), Some(_)) => return Err(table.error("image and index both choose a camera; remove one of the two")),
        (Some(image), None) => Which::Image(image),
        (None, Some(index)) => Which::Index(index),
        (None, None) => Which::Only,
    };
    let calibration = file::read(&file.path()?, which, file.loading())?;
    let pose = match calibration.placed {
        None => Pose::read(table)?,
        Some(placed) => match POSE.iter().filter(|key| **key != "distance").find_map(|key| table.get(key)) {
            Some(field) => return Err(field.error("image says it already; remove one of the two, or give index")),
            None => Pose::of_camera(placed.eye, placed.rotation, table.or("distance", 1.0, Field::above_zero)?)?,
        },
    };
    from_file(table, &file, pose, calibration)
}

/// Kind `opencv`: a file of OpenCV, of which the scene may name the model.
pub fn read_opencv(table: &Table) -> Result<Arc<dyn Recipe>> {
    table.allow(&[&["kind", "t_range", "file", "model"], &SHUTTER[..], &POSE, &KEYS].concat())?;
    let file = table.need("file", "\"camera.yml\"")?;
    let found = file::opencv::read(&file.path()?, file.loading())?;
    let models = [("brown", false), ("fisheye", true)];
    let named = table.optional("model", |field| word(field, &models, "use \"brown\" or \"fisheye\""))?;
    if let (Some(field), Some(line)) = (table.get("model"), named.and_then(|fisheye| found.contradicts(fisheye))) {
        return Err(field.error(format_args!("the file says {line}; leave model out, or correct the file")));
    }
    let calibration = found.calibration(named).map_err(|why| file.error(why))?;
    from_file(table, &file, Pose::read(table)?, calibration)
}

fn from_file(table: &Table, file: &Field, pose: Pose, calibration: Calibration) -> Result<Arc<dyn Recipe>> {
    let Calibration { intrinsics, model, note, .. } = calibration;
    let lens = Lens::new(&model).map_err(|why| file.error(why))?;
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
    Ok(Arc::new(FromFile { pose, intrinsics, model, lens, shutter, tessellation: Tessellation::read(table)?, note }))
}

impl Recipe for FromFile {
    fn build(&self, setting: &Setting) -> Result<Built> {
        let size = setting.size.or(Some(self.intrinsics.size));
        let calibrated = Calibrated {
            eye: self.pose.eye,
            view: self.pose.view()?,
            intrinsics: self.intrinsics.clone(),
            model: self.model.clone(),
            shutter: self.shutter,
        };
        let sensor = Sensor { calibrated: calibrated.clone(), lens: self.lens.clone() };
        let built = self.tessellation.build(Arc::new(sensor), &setting.of_size(size))?;
        let missing = built.layers.iter().filter_map(|rays| without_rays::missing(rays, &calibrated));
        Ok(Built { unfulfilled: self.note.iter().cloned().chain(missing).collect(), ..built })
    }

    fn lines(&self) -> Option<Lines> {
        let line_time = self.shutter.line_time;
        (line_time != 0.0).then_some(Lines {
            first: 0.0,
            line_time,
            order: LineOrder::Down,
            count: self.intrinsics.size.1,
        })
    }

    fn numbers(&self) -> Vec<(&'static str, f64)> {
        let mut own = self.clone();
        numbers::NAMES.into_iter().filter_map(|name| Some((name, *own.number(name)?))).collect()
    }

    fn with_number(&self, name: &str, value: f64) -> Result<Option<Arc<dyn Recipe>>> {
        let mut changed = self.clone();
        let Some(number) = changed.number(name) else { return Ok(None) };
        *number = value;
        changed.lens = Lens::new(&changed.model).map_err(Error::input)?;
        Ok(Some(Arc::new(changed)))
    }
}

/// The directions of the calibrated image, stretched over the image.
#[derive(Debug, PartialEq)]
struct Pixels {
    intrinsics: Intrinsics,
    lens: Lens,
}

impl super::Lens for Pixels {
    fn direction(&self, a: f64, b: f64) -> Option<DVec3> {
        direction(&self.intrinsics, &self.lens, pixel(&self.intrinsics, a, b))
    }
}

/// Returns OpenCV's pixel `(a W - 1/2, b H - 1/2)` of the calibrated image at the place (a, b).
fn pixel(intrinsics: &Intrinsics, a: f64, b: f64) -> DVec2 {
    DVec2::new(a * f64::from(intrinsics.size.0), b * f64::from(intrinsics.size.1)) - 0.5
}

/// Returns the direction of a pixel, to the right, up and forward: OpenCV's camera has y down.
fn direction(intrinsics: &Intrinsics, lens: &Lens, pixel: DVec2) -> Option<DVec3> {
    let d = lens.direction(intrinsics.scale.inverse() * (pixel - intrinsics.centre))?;
    Some(DVec3::new(d.x, -d.y, d.z))
}

/// The rays of the calibrated image, stretched over the image.
#[derive(Debug)]
struct Sensor {
    calibrated: Calibrated,
    lens: Lens,
}

impl RayMap for Sensor {
    fn ray(&self, a: f64, b: f64) -> Option<Ray> {
        let Calibrated { eye, view, intrinsics, shutter, .. } = &self.calibrated;
        let pixel = pixel(intrinsics, a, b);
        let d = direction(intrinsics, &self.lens, pixel)?;
        let direction = view.vector(d.x, d.y, d.z);
        let time = pixel.y * shutter.line_time;
        let rotation = DQuat::from_scaled_axis(shutter.angular * time);
        Some(Ray { origin: *eye + time * shutter.velocity, direction: rotation * direction })
    }

    fn viewer(&self) -> Option<Posed> {
        let Calibrated { eye, view, intrinsics, shutter, .. } = &self.calibrated;
        let lens = Pixels { intrinsics: intrinsics.clone(), lens: self.lens.clone() };
        shutter.is_still().then(|| Posed { eye: *eye, view: *view, lens: Arc::new(lens) })
    }

    /// By the forward formula, if the camera stands still.
    fn images(&self, point: DVec3) -> Option<Vec<(DVec2, f64)>> {
        let Calibrated { eye, view, intrinsics: Intrinsics { size, scale, centre }, shutter, .. } = &self.calibrated;
        let v = point - *eye;
        let rounding = f64::EPSILON * (point.length() + eye.length());
        if !shutter.is_still() || v.length() <= rounding {
            return None;
        }
        let places = self.lens.places(DVec3::new(v.dot(view.right), -v.dot(view.up), v.dot(view.forward)))?;
        let size = DVec2::new(size.0.into(), size.1.into());
        Some(places.into_iter().map(|(q, t)| ((*scale * q + *centre + 0.5) / size, t)).collect())
    }

    fn calibrated(&self) -> Option<&Calibrated> {
        Some(&self.calibrated)
    }
}

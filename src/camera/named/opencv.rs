//! `opencv`: a calibrated camera, its intrinsics read from a file that OpenCV wrote; with a rolling shutter.

mod file;
mod lens;
mod roots;

use super::pose::{POSE, Pose};
use crate::camera::central::View;
use crate::camera::cut::{Cut, KEYS};
use crate::camera::recipe::{Built, Recipe, Setting};
use crate::camera::{Ray, RayMap};
use crate::error::Result;
use crate::scene::file::reader::{Field, Table};
use file::Intrinsics;
use glam::{DQuat, DVec2, DVec3};
use lens::{Brown, Distortion, KannalaBrandt};
use std::sync::Arc;

#[derive(Debug)]
struct OpenCv {
    pose: Pose,
    intrinsics: Intrinsics,
    distortion: Distortion,
    shutter: Shutter,
    cut: Cut,
}

/// How the camera moves while its rows are read, top to bottom.
#[derive(Debug, Clone, Copy)]
struct Shutter {
    /// Seconds from one row to the next.
    line_time: f64,
    /// World units a second.
    velocity: DVec3,
    /// Radians a second about the world's axes through the eye, right-handed.
    angular: DVec3,
}

pub fn read(table: &Table) -> Result<Arc<dyn Recipe>> {
    let own = ["file", "model", "line_time", "velocity", "angular_velocity"];
    table.allow(&[&["kind", "t_range"], &POSE[..], &own, &KEYS].concat())?;
    let file = table.need("file", "\"camera.yml\"")?;
    let intrinsics = file::read(&file.path()?)?;
    let fisheye = table.or("model", false, |field| match field.text()? {
        "brown" => Ok(false),
        "fisheye" => Ok(true),
        _ => Err(field.error("use \"brown\" or \"fisheye\"")),
    })?;
    let k = &intrinsics.coefficients;
    let distortion = match (fisheye, k.len()) {
        (true, 4) => Distortion::Fisheye(KannalaBrandt::new([k[0], k[1], k[2], k[3]])),
        (false, 0 | 4 | 5 | 8) => {
            Distortion::Brown(Brown::new(std::array::from_fn(|i| k.get(i).copied().unwrap_or(0.0))))
        }
        (_, n) => {
            let known = if fisheye { "the fisheye model has 4" } else { "the Brown model has 0, 4, 5 or 8 here" };
            return Err(file.error(format_args!("{n} distortion coefficients; {known}")));
        }
    };
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
    Ok(Arc::new(OpenCv { pose: Pose::read(table)?, intrinsics, distortion, shutter, cut: Cut::read(table)? }))
}

impl Recipe for OpenCv {
    fn build(&self, setting: &Setting) -> Result<Built> {
        let size = setting.size.or(Some(self.intrinsics.size));
        let map = Sensor {
            eye: self.pose.eye,
            view: self.pose.view()?,
            intrinsics: self.intrinsics.clone(),
            distortion: self.distortion,
            shutter: self.shutter,
        };
        self.cut.build(Arc::new(map), &setting.of_size(size))
    }
}

/// The rays of the calibrated image, stretched over the image.
#[derive(Debug)]
struct Sensor {
    eye: DVec3,
    view: View,
    intrinsics: Intrinsics,
    distortion: Distortion,
    shutter: Shutter,
}

impl RayMap for Sensor {
    /// The place (a, b) is OpenCV's pixel `(a W - 1/2, b H - 1/2)` of the calibrated image.
    fn ray(&self, a: f64, b: f64) -> Option<Ray> {
        let Intrinsics { size, focal, centre, .. } = &self.intrinsics;
        let pixel = DVec2::new(a * f64::from(size.0), b * f64::from(size.1)) - 0.5;
        let d = self.distortion.direction((pixel - *centre) / *focal)?;
        // OpenCV's camera has y down
        let direction = self.view.vector(d.x, -d.y, d.z);
        let time = pixel.y * self.shutter.line_time;
        let turn = DQuat::from_scaled_axis(self.shutter.angular * time);
        Some(Ray { origin: self.eye + time * self.shutter.velocity, direction: turn * direction })
    }
}

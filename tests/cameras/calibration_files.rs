//! Calibration files as programs and data sets write them: each ray is seen at its pixel by the formula of the writer's own code.

use crate::calibrated::{POSE, brown, count, equidistant, in_camera_frame, in_file};
use crate::common::written::camera_in;
use glam::{DMat3, DVec2, DVec3};

mod opencv_ros;
mod photogrammetry;
mod polynomials;
mod public;
mod refused;
mod slam;

/// A file of 96 x 64 pixels, and the writer's projection to its pixels, whose first has its centre at (0, 0).
struct Case {
    name: &'static str,
    file: &'static str,
    text: String,
    keys: &'static str,
    project: fn(DVec3) -> DVec2,
    /// Rays behind the eye are expected.
    is_wide: bool,
}

const NARROW: Case =
    Case { name: "", file: "cam.yaml", text: String::new(), keys: "", project: |_| DVec2::ZERO, is_wide: false };
const WIDE: Case =
    Case { name: "", file: "cam.yaml", text: String::new(), keys: "", project: |_| DVec2::ZERO, is_wide: true };

const K: [f64; 4] = [0.02, -0.003, 2e-4, -1e-5];
const BROWN: ([f64; 2], [f64; 2]) = ([-0.05, 0.01], [1e-3, -2e-3]);

fn flat(d: DVec3) -> DVec2 {
    d.truncate() / d.z
}

fn to_pixel(focal: [f64; 2], centre: [f64; 2], p: DVec2) -> DVec2 {
    DVec2::from(focal) * p + DVec2::from(centre)
}

fn radtan(d: DVec3) -> DVec2 {
    to_pixel([60.0, 58.0], [47.5, 31.0], brown(flat(d), &BROWN.0, BROWN.1))
}

fn kannala_brandt(d: DVec3) -> DVec2 {
    to_pixel([30.0, 29.0], [47.5, 31.0], brown(equidistant(d), &K, [0.0; 2]))
}

/// Rational distortion, and k3 of the numerator.
fn rational(d: DVec3) -> DVec2 {
    let (p, r2) = (flat(d), flat(d).length_squared());
    let radial = (1.0 + r2 * (-0.05 + r2 * (0.01 + r2 * 0.002))) / (1.0 + r2 * (0.03 + r2 * (0.004 - r2 * 0.001)));
    to_pixel([60.0, 58.0], [47.5, 31.0], p * radial + brown(p, &[], BROWN.1) - p)
}

fn eucm(d: DVec3, alpha: f64, beta: f64) -> DVec2 {
    let rho = (beta * d.truncate().length_squared() + d.z * d.z).sqrt();
    to_pixel([30.0, 29.0], [47.5, 31.0], d.truncate() / (alpha * rho + (1.0 - alpha) * d.z))
}

fn double_sphere(d: DVec3) -> DVec2 {
    let z = -0.2 * d.length() + d.z;
    to_pixel([20.0, 19.0], [47.5, 31.0], d.truncate() / (0.6 * d.truncate().length().hypot(z) + 0.4 * z))
}

fn check(cases: &[Case]) {
    for Case { name, file, text, keys, project, is_wide } in cases {
        let keys = if keys.contains("image") { (*keys).into() } else { format!("{keys}\n{POSE}") };
        let camera = in_file(file, text, &keys).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert_eq!((camera.width, camera.height), (96, 64), "{name}");
        let [seen, behind] = count(&camera, name, project);
        assert!(seen > 3000 && (!is_wide || behind > 20), "{name}: {seen} rays, {behind} behind");
    }
}

const RADTAN: &str = "-0.05, 0.01, 0.001, -0.002";

/// A file of camodocal's with these tables.
fn camodocal(model: &str, tables: &[(&str, &str)]) -> String {
    let tables: String =
        tables.iter().map(|(name, numbers)| format!("{name}:\n   {}\n", numbers.replace(", ", "\n   "))).collect();
    format!("%YAML:1.0\n---\nmodel_type: {model}\ncamera_name: camera\nimage_width: 96\nimage_height: 64\n{tables}")
}

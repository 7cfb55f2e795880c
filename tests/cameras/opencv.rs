//! Calibrated lenses against OpenCV itself: random ones of every model, and those that `calibrateCamera` finds with every
//! combination of its flags. Skipped without a `python3` that has `cv2` and `numpy`.

use crate::common;

use anamorph::internals::camera::project::Projector;
use anamorph::internals::camera::{Camera, Rays};
use common::written::camera_in;
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use serde::Deserialize;
use std::path::Path;
use std::process::Command;

/// Random lenses of each model, and those of `calibrateCamera`.
const RANDOM: usize = 1000;
const CALIBRATED: usize = 200;

/// Points for each lens, as `lenses.py` writes them: x and y at z = 1, and their pixel by OpenCV.
const POINTS: usize = 16;

/// Largest error of a projected point, px.
const PIXEL: f64 = 1e-9;

/// Largest error of a ray where dF/dp stretches by more than 0.2, as it does at the points of `lenses.py`: the rounding of a pixel (some
/// 1e-14 px) over that stretch and a focal length of 10 px, with a hundredfold margin.
const RAY: f64 = 1e-12;

#[derive(Deserialize)]
struct Lens {
    file: String,
    fisheye: bool,
}

fn has_opencv() -> bool {
    let asked = Command::new("python3").args(["-c", "import cv2, numpy"]).output();
    let found = asked.is_ok_and(|a| a.status.success());
    if !found {
        common::needs::skip("no python3 with cv2 and numpy on this machine; pip install opencv-python-headless");
    }
    found
}

/// What the script prints.
fn script(folder: &Path, args: &[&str]) -> String {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/cameras/opencv/lenses.py");
    let output = Command::new("python3").arg(path).arg(args[0]).arg(folder).args(&args[1..]).output().unwrap();
    let (printed, wrong) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success(), "lenses.py {args:?}: {printed}{wrong}");
    printed.into_owned()
}

/// OpenCV counts pixels from the centre of the first, this program from its corner.
fn place_of(pixel: DVec2) -> DVec2 {
    pixel + 0.5
}

/// The direction in OpenCV's frame.
fn turned(d: DVec3) -> DVec3 {
    DVec3::new(d.x, -d.y, -d.z)
}

fn camera(folder: &Path, lens: &Lens) -> Camera {
    let model = if lens.fisheye { "fisheye" } else { "brown" };
    let own = tempfile::tempdir().unwrap();
    let file = folder.join(&lens.file);
    let keys = format!(
        "kind = 'opencv'\nfile = '{}'\nmodel = '{model}'\neye = [0, 0, 0]\ntarget = [0, 0, -1]",
        file.display()
    );
    camera_in(own.path(), &keys, None).unwrap_or_else(|e| panic!("{}: {e}", lens.file))
}

/// The directions of all pixels; NaN where there is none.
fn rays(camera: &Camera) -> Vec<f64> {
    let pixels = (0..camera.height).flat_map(|j| (0..camera.width).map(move |i| (i, j)));
    let ray = |(i, j)| camera.ray(i, j).map_or([f64::NAN; 3], |r| turned(r.direction).to_array());
    pixels.flat_map(ray).collect()
}

/// Checks points of the branch both ways: the ray at the pixel that OpenCV gives passes through the point, and the point projects to that
/// pixel. Returns how many lie in the picture.
fn check_points(lens: &Lens, camera: &Camera, points: &[f64]) -> usize {
    let Rays::Field(field) = &camera.layers[0] else { panic!("{}: no field", lens.file) };
    let projector = Projector::new(camera);
    let mut count = 0;
    for point in points.chunks_exact(4) {
        let (at, place) = (DVec3::new(point[0], point[1], 1.0), place_of(DVec2::new(point[2], point[3])));
        let is_in =
            place.cmpgt(DVec2::ZERO).all() && place.x < f64::from(camera.width) && place.y < f64::from(camera.height);
        if !is_in {
            continue;
        }
        count += 1;
        let ray = field.ray_at(place).unwrap_or_else(|| panic!("{}: {at} has no ray at {place}", lens.file));
        let d = turned(ray.direction);
        assert!((d / d.z - at).length() <= RAY, "{}: {d}, not {at}", lens.file);
        let images = projector.project(3.0 * turned(at)).images;
        let [image] = images[..] else { panic!("{}: {at} is seen at {images:?}, not {place}", lens.file) };
        assert!(DVec2::new(image.x, image.y).distance(place) <= PIXEL, "{}: {image:?}, not {place}", lens.file);
    }
    count
}

#[test]
fn every_lens_is_opencvs() {
    if !has_opencv() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    script(folder, &["make", &RANDOM.to_string(), &CALIBRATED.to_string()]);
    let lenses: Vec<Lens> = serde_json::from_slice(&std::fs::read(folder.join("lenses.json")).unwrap()).unwrap();
    let points = std::fs::read(folder.join("points.f64")).unwrap();
    let points: Vec<f64> = points.chunks_exact(8).map(|b| f64::from_le_bytes(b.try_into().unwrap())).collect();
    let one = |(lens, points): (&Lens, &[f64])| {
        let camera = camera(folder, lens);
        (rays(&camera), check_points(lens, &camera, points))
    };
    let made: Vec<(Vec<f64>, usize)> = lenses.par_iter().zip(points.par_chunks(4 * POINTS)).map(one).collect();
    let bytes: Vec<u8> = made.iter().flat_map(|(rays, _)| rays).flat_map(|x| x.to_le_bytes()).collect();
    std::fs::write(folder.join("rays.f64"), bytes).unwrap();
    let back: usize = made.iter().map(|m| m.1).sum();
    println!("{} lenses; {back} points checked\n{}", lenses.len(), script(folder, &["check"]));
    assert!(lenses.len() >= 5 * RANDOM + CALIBRATED * 9 / 10 && back > 8 * lenses.len(), "{} {back}", lenses.len());
}

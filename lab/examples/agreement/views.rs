//! Every kind of camera, looking at the ball of radius 1 about the origin, and the files that they read.

use anamorph::internals::camera::kinds::KINDS;
use anamorph::internals::image::{write_npy_f64, write_text};
use anamorph::internals::input::{Error, Result};
use glam::DVec3;
use std::f64::consts::TAU;
use std::path::Path;
use toml::{Table, Value};

/// Width and height of the pictures, pixels, but for scans.
pub const SIZE: [u32; 2] = [800, 600];

/// A camera by name, and its keys.
pub struct View {
    pub name: String,
    pub size: [u32; 2],
    pub camera: Table,
}

/// Every camera of `cameras.toml`.
///
/// # Errors
/// [`Error::Work`] where a kind of the program has none.
pub fn views() -> Result<Vec<View>> {
    let broken = |why: &dyn std::fmt::Display| Error::work(format!("cameras.toml: {why}"));
    let mut all: Table = include_str!("cameras.toml").parse().map_err(|e| broken(&e))?;
    let Some(Value::Array(tables)) = all.remove("camera") else { return Err(broken(&"no [[camera]]")) };
    let mut views = Vec::new();
    for table in tables {
        let Value::Table(mut camera) = table else { return Err(broken(&"a camera is no table")) };
        let Some(Value::String(name)) = camera.remove("name") else { return Err(broken(&"a camera has no name")) };
        let size = camera.remove("image").map_or(Ok(SIZE), Value::try_into).map_err(|e| broken(&e))?;
        views.push(View { name, size, camera });
    }
    let seen = |kind: &str| views.iter().any(|v| v.camera.get("kind").and_then(Value::as_str) == Some(kind));
    match KINDS.iter().map(|k| k.name).find(|kind| !seen(kind)) {
        Some(kind) => Err(broken(&format_args!("no camera of kind {kind}"))),
        None => Ok(views),
    }
}

/// Writes the files that cameras read into the scenes' folder.
pub fn write_camera_files(folder: &Path) -> Result<()> {
    write_text(&folder.join("lens.yml"), include_str!("lens.yml"))?;
    write_text(&folder.join("fisheye.yml"), include_str!("fisheye.yml"))?;
    write_text(&folder.join("cameras.txt"), include_str!("cameras.txt"))?;
    write_text(&folder.join("screen.obj"), include_str!("screen.obj"))?;
    let [w, h] = SIZE;
    let pixels = || (0..h).flat_map(move |j| (0..w).map(move |i| (i, j)));
    let rays: Vec<[DVec3; 2]> = pixels().map(|(i, j)| rippled((i, j))).collect();
    for (k, name) in ["ray-origins.npy", "ray-directions.npy"].into_iter().enumerate() {
        let numbers: Vec<f64> = rays.iter().flat_map(|r| r[k].to_array()).collect();
        write_npy_f64(&folder.join(name), &[h.into(), w.into(), 3], &numbers)?;
    }
    let shots: Vec<f64> = pixels().flat_map(|(i, j)| rosette(j * w + i)).flat_map(|v| v.to_array()).collect();
    write_npy_f64(&folder.join("rosette.npy"), &[u64::from(w) * u64::from(h), 6], &shots)
}

/// Where the viewer of `raymap` and of the rosette stands, and the directions ahead, to the right and up.
fn pose() -> (DVec3, [DVec3; 3]) {
    let eye = DVec3::new(1.5, 2.0, 3.0);
    let forward = -eye.normalize();
    let right = forward.cross(DVec3::Y).normalize();
    (eye, [forward, right, right.cross(forward)])
}

/// A pixel's ray through rippled glass: it starts off the eye, and is bent.
fn rippled((i, j): (u32, u32)) -> [DVec3; 2] {
    let (eye, [forward, right, up]) = pose();
    let [w, h] = SIZE.map(f64::from);
    let (x, y) = ((2.0 * (f64::from(i) + 0.5) - w) / h, 1.0 - 2.0 * (f64::from(j) + 0.5) / h);
    let ripple = 0.02 * DVec3::new((5.0 * y).sin(), (4.0 * x).cos(), (3.0 * (x + y)).sin());
    let direction = forward + 0.25 * (x * right + y * up) + 0.5 * ripple;
    [eye + ripple, direction]
}

/// Shot k of a scanner of two mirrors that turn against each other, one a little faster: petals about the view's middle, one
/// beside the other.
fn rosette(k: u32) -> [DVec3; 2] {
    /// Turns of the first mirror during the scan: one in a row of the image.
    const TURNS: f64 = SIZE[1] as f64;
    /// Turns of the second one meanwhile.
    const RATIO: f64 = -(TURNS + 1.0) / TURNS;
    /// Tangent of the half angle that is scanned.
    const REACH: f64 = 0.25;
    let (eye, [forward, right, up]) = pose();
    let angle = TAU * TURNS * f64::from(k) / f64::from(SIZE[0] * SIZE[1]);
    let x = angle.cos() + (RATIO * angle).cos();
    let y = angle.sin() + (RATIO * angle).sin();
    [eye, (forward + 0.5 * REACH * (x * right + y * up)).normalize()]
}

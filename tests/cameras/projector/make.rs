//! Projectors from scene files, and formulas that several tests share.

use crate::common::written::camera_in;
use anamorph::internals::camera::Camera;
use anamorph::internals::input::Result;
use glam::DVec3;
use std::path::Path;

pub const SIZE: (u32, u32) = (24, 18);

/// Points are sums of some twenty products of numbers up to 10, and angles of some turns: 2^-53 each, with a margin for the
/// order of evaluation.
pub const ROUNDING: f64 = 1e-13;

pub fn try_load(dir: &Path, text: &str) -> Result<Camera> {
    camera_in(dir, text, Some(SIZE))
}

pub fn load(camera: &str) -> Camera {
    let dir = tempfile::tempdir().unwrap();
    try_load(dir.path(), camera).unwrap_or_else(|e| panic!("{camera}: {e}"))
}

pub fn projector(surfaces: &[&str], reparam: &str) -> String {
    format!("kind = \"projector\"\nsurfaces = [{}]\n{reparam}", surfaces.join(", "))
}

pub fn pixels() -> impl Iterator<Item = (u32, u32)> {
    (0..SIZE.1).flat_map(|j| (0..SIZE.0).map(move |i| (i, j)))
}

pub fn place(i: u32, j: u32) -> (f64, f64) {
    ((i as f64 + 0.5) / SIZE.0 as f64, (j as f64 + 0.5) / SIZE.1 as f64)
}

pub fn close(a: DVec3, b: DVec3) -> bool {
    (a - b).length() <= ROUNDING * (1.0 + a.length())
}

/// A second surface that no surface here touches, and a third.
pub const FAR: &str = "{ kind = 'point', at = [30, 20, 10] }";
pub const FAR_PLANE: &str = "{ kind = 'plane', origin = [30, 20, 10], u = [1, 2, 0], v = [0, 1, 3] }";

/// A grid of points that no plane holds, and its text.
pub fn grid(rows: usize, columns: usize) -> (Vec<Vec<DVec3>>, String) {
    let point = |i: usize, j: usize| {
        let (x, y) = (i as f64, j as f64);
        DVec3::new(x + 0.25 * y, y - 0.125 * x * x, (x * y * 0.5).sin())
    };
    let grid: Vec<Vec<DVec3>> = (0..rows).map(|j| (0..columns).map(|i| point(i, j)).collect()).collect();
    let text = |p: &DVec3| format!("[{:?}, {:?}, {:?}]", p.x, p.y, p.z);
    let row = |row: &Vec<DVec3>| format!("[{}]", row.iter().map(text).collect::<Vec<_>>().join(", "));
    let text = format!("[{}]", grid.iter().map(row).collect::<Vec<_>>().join(", "));
    (grid, text)
}

pub fn bernstein(i: usize, n: usize, t: f64) -> f64 {
    let binomial: f64 = (0..i).map(|k| (n - k) as f64 / (k + 1) as f64).product();
    binomial * t.powi(i as i32) * (1.0 - t).powi((n - i) as i32)
}

/// Two triangles over the unit square, their border the diagonal u + v = 1; `z` of the corners.
pub fn square<const N: usize>(order: [&str; N], z: [f64; 4]) -> String {
    let at = |u: u32, v: u32, z: f64| format!("{{ image = [{u}, {v}], at = [{u}, {v}, {z:?}] }}");
    let vertices = [at(0, 0, z[0]), at(1, 0, z[1]), at(0, 1, z[2]), at(1, 1, z[3])].join(", ");
    format!("{{ kind = 'pieces', vertices = [{vertices}], triangles = [{}] }}", order.join(", "))
}

pub const UPPER: &str = "[0, 1, 2]";
pub const LOWER: &str = "[1, 3, 2]";

//! The root of a top-down camera: one pinhole view, or the six faces of a cube around its eye laid out in the image.

use super::legs;
use super::outline::{self, Outline};
use super::view::{Pinhole, View};
use crate::arrays::MapEach;
use crate::camera::pose::Pose;
use crate::input::{Error, Result};
use glam::{DVec2, DVec3};

/// How the root lies in the image.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Layout {
    Plain,
    /// Cube faces: up over the second of left, front, right, back; down under it.
    Cross,
    /// Cube faces: left, front, right, back, up, down.
    Strip,
}

/// A view of the root, and the part of the image that it fills.
pub struct Root {
    pub view: View,
    pub pinhole: Pinhole,
    /// Pixels that its vfov spans.
    pub height: u32,
    pub centre_px: DVec2,
    /// All of the picture, or a face of a cube; pixels.
    pub outline: Outline,
}

/// The views of a root, in the order left, front, right, back, up, down where it is a cube. A plain root's outline is left
/// empty.
pub fn roots(pinhole: &Pinhole, layout: Layout, (width, height): (u32, u32)) -> Result<Vec<Root>> {
    let centre = legs::centre((width, height));
    if layout == Layout::Plain {
        let view = View::new(pinhole, height, centre)?;
        return Ok(vec![Root { view, pinhole: *pinhole, height, centre_px: centre, outline: Outline::new() }]);
    }
    let (columns, rows) = if layout == Layout::Cross { (4, 3) } else { (6, 1) };
    let side = (width / columns).min(height / rows);
    if side == 0 {
        return Err(Error::input(format!(
            "image: {width}x{height} is too small for {columns} by {rows} faces; make it larger"
        )));
    }
    let start = DVec2::new(((width - columns * side) / 2) as f64, ((height - rows * side) / 2) as f64);
    let front = View::new(pinhole, side, centre)?;
    let [right, down] = front.steps().map_each(DVec3::normalize);
    let (f, r, u) = (front.forward(), right, -down);
    let around = [(-r, u), (f, u), (r, u), (-f, u), (u, -f), (-u, f)];
    let cell = |k: usize| match (layout, k) {
        (Layout::Cross, 0..4) => (k, 1),
        (Layout::Cross, 4) => (1, 0),
        (Layout::Cross, _) => (1, 2),
        _ => (k, 0),
    };
    let face = |(k, (forward, up)): (usize, (DVec3, DVec3))| {
        let (column, row) = cell(k);
        let lo = start + DVec2::new(column as f64, row as f64) * side as f64;
        let hi = lo + side as f64;
        let eye = pinhole.pose.eye;
        let of_face = Pinhole { pose: Pose::look_at(eye, eye + forward, up), ..*pinhole };
        let centre_px = (lo + hi) / 2.0;
        let view = View::new(&of_face, side, centre_px)?;
        Ok(Root { view, pinhole: of_face, height: side, centre_px, outline: outline::rectangle(lo, hi) })
    };
    around.into_iter().enumerate().map(face).collect()
}

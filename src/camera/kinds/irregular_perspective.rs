//! `irregular_perspective`: perspective, orthographic and inverse perspective, set per axis and per corner
//! (Brosz et al. 2007, Figures 4 and 5).
//!
//! The picture of the plane at the target, of half-height `T tan(vfov / 2)`, is that of a pinhole. A point q of that plane,
//! from its middle, goes to `q (1 + c (z - T) / T)` at the depth z: c = 1 is perspective, 0 orthographic, -1 inverse
//! perspective, whose rays meet at the depth 2 T. c may differ across and up (then the camera is a GLC: a cross-slit, a
//! pushbroom, ...) and from corner to corner (near and far are bilinear patches). The columns of Figure 5 keep their shape
//! with less convergence across than up.

use super::viewer::{Viewer, allow, aspect, upright};
use crate::arrays::MapEach;
use crate::camera::projector::Volume;
use crate::camera::projector::surface::Surface;
use crate::camera::recipe::{Built, Recipe, Setting};
use crate::camera::tessellate::{self, Tessellation};
use crate::input::Result;
use crate::input::reader::{Field, Table};
use glam::{DMat2, DVec2};
use std::sync::Arc;

#[derive(Debug, PartialEq)]
struct Irregular {
    viewer: Viewer,
    /// Of the plane at the target, world units.
    height: f64,
    convergence: Convergence,
    tessellation: Tessellation,
}

#[derive(Debug, PartialEq)]
enum Convergence {
    /// Across and up.
    Even(DVec2),
    /// In the image's corners: top left, top right, bottom left, bottom right.
    Corners([DVec2; 4]),
}

pub fn read(table: &Table) -> Result<Arc<dyn Recipe>> {
    let [pieces, error] = tessellate::KEYS;
    allow(table, &["convergence", pieces, error])?;
    let viewer = Viewer::read(table, [0.1, 2.0])?;
    let convergence = table.or("convergence", Convergence::Even(DVec2::new(0.4, 1.0)), read_convergence)?;
    let all = match &convergence {
        Convergence::Even(c) => std::slice::from_ref(c),
        Convergence::Corners(c) => &c[..],
    };
    let size = |depth: f64, c: &DVec2| viewer.scale(depth, *c).min_element();
    if all.iter().any(|c| size(viewer.near, c) < 0.0 || size(viewer.far, c) < 0.0) {
        return Err(table.error("convergence: rays cross between near and far; make it smaller or bring them together"));
    }
    let height = 2.0 * viewer.distance * Viewer::half_height(table)?;
    Ok(Arc::new(Irregular { viewer, height, convergence, tessellation: Tessellation::read(table)? }))
}

fn read_convergence(field: &Field) -> Result<Convergence> {
    let pair = |field: &Field| Ok(DVec2::from(field.numbers::<2>("two numbers: across and up")?));
    if !field.is_list() {
        return Ok(Convergence::Even(DVec2::splat(field.number()?)));
    }
    let items: Vec<Field> = field.items("a number, two, or four pairs for the corners")?.collect();
    if items.len() != 4 {
        return Ok(Convergence::Even(pair(field)?));
    }
    let mut corners = [DVec2::ZERO; 4];
    for (corner, item) in corners.iter_mut().zip(&items) {
        *corner = pair(item)?;
    }
    Ok(Convergence::Corners(corners))
}

impl Viewer {
    /// How much larger than at the target the picture is at a depth.
    fn scale(&self, depth: f64, convergence: DVec2) -> DVec2 {
        DVec2::ONE + convergence * ((depth - self.distance) / self.distance)
    }
}

impl Recipe for Irregular {
    fn build(&self, setting: &Setting) -> Result<Built> {
        let at_target = upright(self.height, aspect(setting.size()?));
        let surface = |depth: f64| match &self.convergence {
            Convergence::Even(c) => {
                let m = DMat2::from_diagonal(self.viewer.scale(depth, *c)) * at_target;
                Surface::from(self.viewer.plane(depth, m, DVec2::ZERO))
            }
            Convergence::Corners(c) => {
                let corners = [(0, -0.5, 0.5), (1, 0.5, 0.5), (2, -0.5, -0.5), (3, 0.5, -0.5)];
                Surface::Bilinear(corners.map_each(|(k, x, y)| {
                    self.viewer.point(self.viewer.scale(depth, c[k]) * (at_target * DVec2::new(x, y)), depth)
                }))
            }
        };
        Volume::over(vec![surface(self.viewer.near), surface(self.viewer.far)])?.build(setting, self.tessellation)
    }
}

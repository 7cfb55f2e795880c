//! `hinge`: two cross-slit cameras that share an image column, the second one rotated about it.
//!
//! Yu, Yu and McMillan 2009, section 5.3 (faux animation): rotating the second camera makes its part of the scene appear to rotate, and the
//! picture stays continuous.

use super::{POSE, Pose};
use crate::arrays::MapEach;
use crate::camera::mesh::triangle;
use crate::camera::recipe::{Built, Recipe, Setting};
use crate::camera::values::{angle_within, half_tangent, length, number_if, word};
use crate::camera::{Pieces, Ray, Rays};
use crate::input::Result;
use crate::input::reader::{Field, Table};
use glam::DVec2;
use std::sync::Arc;

#[derive(Debug, PartialEq)]
struct Hinge {
    pose: Pose,
    /// tan(vfov / 2).
    k: f64,
    /// World units.
    path: f64,
    /// The hinge's a.
    column: f64,
    /// Degrees.
    angle: f64,
    /// 1: the part right of the hinge rotates; -1: the left one.
    side: f64,
}

pub fn read(table: &Table) -> Result<Arc<dyn Recipe>> {
    table.allow(&[&["kind", "t_range", "vfov", "path", "column", "angle", "side"], &POSE[..]].concat())?;
    Ok(Arc::new(Hinge {
        pose: Pose::read(table)?,
        k: half_tangent(&table.need("vfov", "40")?)?,
        path: length(&table.need("path", "8")?)?,
        column: table.or("column", 0.5, read_column)?,
        angle: angle_within(&table.need("angle", "30")?, -90.0, 90.0)?,
        side: table.or("side", 1.0, read_side)?,
    }))
}

fn read_column(field: &Field) -> Result<f64> {
    number_if(field, |x| x > 0.0 && x < 1.0, "must lie between 0 and 1, the image's left and right border")
}

fn read_side(field: &Field) -> Result<f64> {
    word(field, &[("right", 1.0), ("left", -1.0)], "is \"right\" or \"left\", the side of the hinge that turns")
}

impl Recipe for Hinge {
    /// Two pieces on each side of the hinge, of one general linear camera.
    fn build(&self, setting: &Setting) -> Result<Built> {
        let (w, h) = setting.size()?;
        let view = self.pose.view()?;
        let (half_path, distance) = (self.path / 2.0, self.pose.distance());
        let (half_width, half_height) = (self.k * distance * w as f64 / h as f64, self.k * distance);
        let (sin, cos) = self.angle.to_radians().sin_cos();
        let at_hinge = 2.0 * self.column - 1.0;
        let ray = |a: f64, b: f64| {
            let (x, y) = (2.0 * a - 1.0, 1.0 - 2.0 * b);
            let beyond = if (x - at_hinge) * self.side > 0.0 { x - at_hinge } else { 0.0 };
            let along = view.vector(x - beyond + beyond * cos, 0.0, beyond * self.side * sin);
            let to_image = (half_width - half_path) * along + view.vector(0.0, y * half_height, distance);
            Ray { origin: self.pose.eye + half_path * along, direction: to_image / distance }
        };
        let size = DVec2::new(w.into(), h.into());
        let piece =
            |q: [(f64, f64); 3]| triangle(q.map_each(|(a, b)| DVec2::new(a, b) * size), q.map_each(|(a, b)| ray(a, b)));
        let halves = [(0.0, self.column), (self.column, 1.0)];
        let pieces = halves
            .iter()
            .flat_map(|&(l, r)| [piece([(l, 0.0), (r, 0.0), (l, 1.0)]), piece([(r, 1.0), (r, 0.0), (l, 1.0)])])
            .collect();
        Ok(Built::new((w, h), Rays::Pieces(Pieces::new(pieces, w, h))))
    }
}

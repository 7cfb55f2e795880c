//! A viewer, and planes across the view at given depths: the parts of the viewing volumes of Brosz et al.

use super::{POSE, Pose};
use crate::camera::projector::surface::Plane;
use crate::camera::values::half_tangent;
use crate::camera::view::View;
use crate::input::Result;
use crate::input::reader::{Field, Table};
use glam::{DMat2, DVec2, DVec3};

/// A viewer, and the depths between which the volume lies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Viewer {
    pub eye: DVec3,
    pub view: View,
    /// Depth of the target: its distance from the eye.
    pub distance: f64,
    /// Depths where the volume begins and ends, `0 <= near < far`.
    pub near: f64,
    pub far: f64,
}

/// The keys of [`Viewer::read`] besides those of a pose.
const KEYS: [&str; 4] = ["kind", "vfov", "near", "far"];

impl Viewer {
    /// Reads the viewer; near and far are `depths` times the target's distance where they are not given.
    pub fn read(table: &Table, depths: [f64; 2]) -> Result<Viewer> {
        let pose = match Pose::read_rotation(table)? {
            Some(pose) => pose,
            None => {
                let eye = table.or("eye", DVec3::new(0.0, 0.0, 4.0), Field::vec3)?;
                let target = table.or("target", DVec3::ZERO, Field::vec3)?;
                Pose::look_at(eye, target, table.or("up", DVec3::Y, Field::vec3)?)
            }
        };
        let (eye, view, distance) = (pose.eye, pose.view()?, pose.distance());
        let near = table.or("near", depths[0] * distance, Field::number)?;
        let far = table.or("far", depths[1] * distance, Field::number)?;
        if !(near >= 0.0 && far > near) {
            let message =
                format_args!("near {near} and far {far} are depths from the eye: near 0 or more, far beyond it");
            return Err(table
                .get("far")
                .or(table.get("near"))
                .map_or_else(|| table.error(message), |f| f.error(message)));
        }
        Ok(Viewer { eye, view, distance, near, far })
    }

    /// The tangent of half of the table's `vfov`, 40 degrees where it is not given.
    pub fn half_height(table: &Table) -> Result<f64> {
        table.or("vfov", 20f64.to_radians().tan(), half_tangent)
    }

    /// The point `q.x` to the right of and `q.y` above the view's axis at a depth.
    pub fn point(&self, q: DVec2, depth: f64) -> DVec3 {
        self.eye + depth * self.view.forward + self.across(q)
    }

    fn across(&self, q: DVec2) -> DVec3 {
        q.x * self.view.right + q.y * self.view.up
    }

    /// The plane at a depth that shows `m` of [-1/2, 1/2]^2, y up, the first corner of the image at (-1/2, 1/2), moved by
    /// `shift`.
    pub fn plane(&self, depth: f64, m: DMat2, shift: DVec2) -> Plane {
        let origin = self.point(m * DVec2::new(-0.5, 0.5) + shift, depth);
        Plane { origin, u: self.across(m.x_axis), v: -self.across(m.y_axis) }
    }
}

/// The map of [-1/2, 1/2]^2 to a rectangle of a height and of the image's aspect.
pub fn upright(height: f64, aspect: f64) -> DMat2 {
    DMat2::from_diagonal(DVec2::new(height * aspect, height))
}

/// Width over height.
pub fn aspect((width, height): (u32, u32)) -> f64 {
    f64::from(width) / f64::from(height)
}

/// The keys of a viewer and `own` ones are all that the table may have.
pub fn allow(table: &Table, own: &[&str]) -> Result<()> {
    table.allow(&[&KEYS[..], &POSE, own].concat())
}

//! `twist`: the far surface rotated against the near one (Brosz et al. 2007, Figure 7), and `curved_convergence`: the
//! surface between them shifted sideways (Figure 9).

use super::viewer::{Viewer, allow, aspect, upright};
use crate::camera::projector::Volume;
use crate::camera::recipe::{Built, Recipe, Setting};
use crate::camera::tessellate::Tessellation;
use crate::input::Result;
use crate::input::reader::{Field, Table};
use glam::{DMat2, DVec2};
use std::sync::Arc;

/// The volume of a pinhole between near and far, its picture rotated by `angle` from near to far.
///
/// Straight (degree 1), projectors come together by cos(angle / 2) in the middle, as strings of a twisted bundle do. Of
/// degree 2 the middle surface is rotated by half the angle and larger by `1 / cos(angle / 2)`: the projectors leave the near
/// surface and reach the far one along circles about the axis. Of degree 3 their legs are those of the usual cubic arc,
/// `4/3 tan(angle / 4)` of the radius, each at its surface's own: half-way they are as far from the axis as untwisted ones.
#[derive(Debug, PartialEq)]
struct Twist {
    viewer: Viewer,
    half_height: f64,
    /// Of the far surface against the near one, counter-clockwise as the viewer sees it, radians.
    angle: f64,
    degree: u64,
}

pub fn read(table: &Table) -> Result<Arc<dyn Recipe>> {
    allow(table, &["angle", "degree"])?;
    let viewer = Viewer::read(table, [0.5, 1.5])?;
    let angle = table.or("angle", 60.0, Field::number)?;
    let degree = table.or("degree", 1, |field| field.integer(1, 3))?;
    let limit = [f64::INFINITY, 180.0, 360.0][degree as usize - 1];
    if angle.abs() >= limit {
        return Err(
            table.error(format_args!("angle {angle}: must be below {limit} either way where degree = {degree}"))
        );
    }
    let half_height = Viewer::half_height(table)?;
    Ok(Arc::new(Twist { viewer, half_height, angle: angle.to_radians(), degree }))
}

impl Recipe for Twist {
    fn build(&self, setting: &Setting) -> Result<Built> {
        let aspect = aspect(setting.size()?);
        // at the share s of the way, rotated by an angle, sheared along the circle by `leg` of the radius, enlarged
        let surface = |s: f64, angle: f64, leg: f64, larger: f64| {
            let depth = self.viewer.near + s * (self.viewer.far - self.viewer.near);
            let along = DMat2::from_cols(DVec2::new(1.0, leg), DVec2::new(-leg, 1.0));
            let m = DMat2::from_angle(angle) * along * upright(2.0 * depth * self.half_height * larger, aspect);
            self.viewer.plane(depth, m, DVec2::ZERO).into()
        };
        let angle = self.angle;
        let (near, far) = (surface(0.0, 0.0, 0.0, 1.0), surface(1.0, angle, 0.0, 1.0));
        let surfaces = match self.degree {
            1 => vec![near, far],
            2 => vec![near, surface(0.5, angle / 2.0, 0.0, 1.0 / (angle / 2.0).cos()), far],
            _ => {
                let leg = 4.0 / 3.0 * (angle / 4.0).tan();
                vec![near, surface(1.0 / 3.0, 0.0, leg, 1.0), surface(2.0 / 3.0, angle, -leg, 1.0), far]
            }
        };
        Volume::over(surfaces)?.build(setting, Tessellation::Exact)
    }
}

/// The volume of a pinhole between near and far whose projectors, of degree 2, bow sideways: lines along the view, which a
/// pinhole shows straight towards the middle, converge along curves.
#[derive(Debug, PartialEq)]
struct CurvedConvergence {
    viewer: Viewer,
    half_height: f64,
    /// How far the middle surface is moved to the right and up, in its own height.
    bend: DVec2,
}

pub fn read_curved_convergence(table: &Table) -> Result<Arc<dyn Recipe>> {
    allow(table, &["bend"])?;
    let viewer = Viewer::read(table, [0.1, 3.0])?;
    let pair = |field: &Field| Ok(DVec2::from(field.numbers::<2>("two numbers: to the right and up")?));
    let bend = table.or("bend", DVec2::new(0.5, 0.0), pair)?;
    Ok(Arc::new(CurvedConvergence { viewer, half_height: Viewer::half_height(table)?, bend }))
}

impl Recipe for CurvedConvergence {
    fn build(&self, setting: &Setting) -> Result<Built> {
        let aspect = aspect(setting.size()?);
        let plane = |depth: f64, bend: DVec2| {
            let height = 2.0 * depth * self.half_height;
            self.viewer.plane(depth, upright(height, aspect), height * bend).into()
        };
        let Viewer { near, far, .. } = self.viewer;
        let middle = plane(0.5 * (near + far), self.bend);
        let surfaces = vec![plane(near, DVec2::ZERO), middle, plane(far, DVec2::ZERO)];
        Volume::over(surfaces)?.build(setting, Tessellation::Exact)
    }
}

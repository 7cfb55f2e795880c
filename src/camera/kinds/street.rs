//! `street`: the houses along a street in one picture, with perspective views down its crossings (Brosz et al. 2007,
//! Figure 11).
//!
//! The viewer walks `from` .. `to`, the left and right borders of the image, and looks across: a pushbroom (the figure's
//! linear projectors). With `views` the projectors are curves of degree 2 over the line of the walk, the plane of the
//! facades and a far surface, whose places are moved along the street by
//! `(far - facade) tan(turn + q angle / 2) (1 - q^2)^2`, q = -1 .. 1 across the view: around the middle of a view they fan
//! out by `angle`, rotated by `turn`, and at its borders they join the others smoothly. Between views that lean to each other
//! the projectors cross, hidden by the facades. The far surface is a cubic B-spline along the street, so the moves are those
//! of its control points.

use crate::camera::projector::Volume;
use crate::camera::projector::patch::Patch;
use crate::camera::projector::surface::{Plane, Surface};
use crate::camera::recipe::{Built, Recipe, Setting};
use crate::camera::tessellate::Tessellation;
use crate::camera::values::{half_tangent, length};
use crate::input::Result;
use crate::input::reader::{Field, Table};
use glam::DVec3;
use std::sync::Arc;

#[derive(Debug, PartialEq)]
struct Street {
    from: DVec3,
    /// Of the walk.
    along: DVec3,
    /// Unit.
    right: DVec3,
    up: DVec3,
    forward: DVec3,
    /// Distances from the walk.
    facade: f64,
    far: f64,
    /// Tangent of half of the angle between the image's upper and lower border; `None`: so that the facades have the image's
    /// aspect.
    half_height: Option<f64>,
    views: Vec<View>,
}

/// A view down a crossing.
#[derive(Debug, PartialEq)]
struct View {
    /// Image coordinate a of its middle, and its share of the image's width.
    at: f64,
    width: f64,
    /// Radians; `turn` is a rotation to the right.
    angle: f64,
    turn: f64,
}

/// The far surface has this many control points for each width of the narrowest view.
const POINTS_A_VIEW: f64 = 16.0;

/// The narrowest view, in widths of the image.
const WIDTH_MIN: f64 = 0.01;

pub fn read(table: &Table) -> Result<Arc<dyn Recipe>> {
    table.allow(&["kind", "from", "to", "up", "vfov", "facade", "far", "views"])?;
    let from = table.or("from", DVec3::new(-2.0, 0.0, 4.0), Field::vec3)?;
    let to = table.or("to", DVec3::new(2.0, 0.0, 4.0), Field::vec3)?;
    let right = (to - from).try_normalize().ok_or_else(|| table.error("from and to are the same point; move one"))?;
    let up = table.or("up", DVec3::Y, Field::vec3)?;
    let across = up.normalize_or_zero().cross(right);
    if across.length() < crate::camera::view::UP_SINE_MIN {
        return Err(table.error("up is zero or along the walk; give another up"));
    }
    let forward = across.normalize();
    let facade = table.or("facade", 3.0, length)?;
    let far = table.or("far", 3.0 * facade, length)?;
    if far <= facade {
        return Err(table.error(format_args!("far {far} must be beyond facade {facade}")));
    }
    let half_height = table.optional("vfov", half_tangent)?;
    let views = match table.get("views") {
        Some(field) => field.items("a list of views")?.map(|view| read_view(&view)).collect::<Result<_>>()?,
        None => Vec::new(),
    };
    let (along, up) = (to - from, right.cross(forward));
    Ok(Arc::new(Street { from, along, right, up, forward, facade, far, half_height, views }))
}

fn read_view(field: &Field) -> Result<View> {
    let table = field.table()?;
    table.allow(&["at", "width", "angle", "turn"])?;
    let width = table.or("width", 0.3, Field::number)?;
    if !(WIDTH_MIN..=2.0).contains(&width) {
        return Err(field.error(format_args!("width {width} must lie between {WIDTH_MIN} and 2 widths of the image")));
    }
    let (angle, turn) = (table.or("angle", 60.0, Field::number)?, table.or("turn", 0.0, Field::number)?);
    if !(angle >= 0.0 && turn.abs() + angle / 2.0 < 90.0) {
        return Err(field.error(format_args!(
            "angle {angle} must not be below 0, and with turn {turn} must stay within 90 degrees of the view across"
        )));
    }
    let at = table.need("at", "0.5")?.number()?;
    Ok(View { at, width, angle: angle.to_radians(), turn: turn.to_radians() })
}

impl Recipe for Street {
    fn build(&self, setting: &Setting) -> Result<Built> {
        let (w, h) = setting.size()?;
        let undistorted = 0.5 * self.along.length() * f64::from(h) / f64::from(w) / self.facade;
        let half_height = self.half_height.unwrap_or(undistorted);
        let plane = |distance: f64| {
            let half = distance * half_height * self.up;
            Plane { origin: self.from + distance * self.forward + half, u: self.along, v: -2.0 * half }
        };
        let surfaces = if self.views.is_empty() {
            vec![plane(0.0).into(), plane(self.far).into()]
        } else {
            vec![plane(0.0).into(), plane(self.facade).into(), self.fanned(plane(self.far))]
        };
        Volume::over(surfaces)?.build(setting, Tessellation::Exact)
    }
}

impl Street {
    /// The plane with its places moved along the street.
    fn fanned(&self, plane: Plane) -> Surface {
        let narrowest = self.views.iter().fold(1.0, |least: f64, view| least.min(view.width));
        // at least the four of one cubic span
        let places = Patch::greville(3, (POINTS_A_VIEW / narrowest).ceil() as usize + 3);
        let point = |a: f64, b: f64| plane.at(glam::DVec2::new(a, b)) + self.moved(a) * self.right;
        let points: Vec<DVec3> = [0.0, 1.0].iter().flat_map(|b| places.iter().map(|a| point(*a, *b))).collect();
        Surface::Patch(Patch::uniform([3, 1], places.len(), &points))
    }

    /// How far the far end of the projectors at `a` is moved to the right.
    fn moved(&self, a: f64) -> f64 {
        let by = |view: &View| {
            let q = 2.0 * (a - view.at) / view.width;
            let share = (1.0 - q * q).max(0.0).powi(2);
            share * (self.far - self.facade) * (view.turn + q.clamp(-1.0, 1.0) * view.angle / 2.0).tan()
        };
        self.views.iter().map(by).sum()
    }
}

//! `cross_slit`: every ray meets two slits.
//!
//! Zomet, Feldman, Peleg and Weinshall 2003, and Yu, Yu and McMillan 2009, section 3.1. Through the image place X goes one line
//! that meets the slits `p1 + s d1` and `p2 + s d2`: the planes of X with each slit cut each other in it.

use super::{POSE, Pose};
use crate::arrays::MapEach;
use crate::camera::recipe::{Built, Recipe, Setting};
use crate::camera::tessellate::{self, Tessellation};
use crate::camera::values::{direction, length};
use crate::camera::view::View;
use crate::camera::{Bundle, Pieces, Ray, RayMap, Rays};
use crate::input::reader::{Field, Table};
use crate::input::{Error, Result};
use glam::DVec3;
use std::sync::Arc;

#[derive(Debug, PartialEq)]
struct CrossSlit {
    window: Window,
    slits: [SlitSpec; 2],
    tessellation: Tessellation,
}

/// Where the image lies in the world.
#[derive(Debug, PartialEq)]
enum Window {
    /// Its middle, and the vectors from there to the middles of its right and upper borders.
    Plane(Plane),
    /// Through the target, across the view; `height` in world units.
    View { pose: Pose, height: f64 },
}

#[derive(Debug, PartialEq)]
enum SlitSpec {
    /// A point and the slit's unit direction.
    Line(DVec3, DVec3),
    /// Parallel to the image plane: how far before it, and degrees from the image's right towards its top.
    Facing { distance: f64, angle: f64 },
}

/// X = center + (2a - 1) right + (1 - 2b) up.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Plane {
    center: DVec3,
    right: DVec3,
    up: DVec3,
}

/// The rays by their geometry alone.
#[derive(Debug)]
struct Lines {
    plane: Plane,
    /// The unit normal, away from the viewer.
    forward: DVec3,
    /// A point and the unit direction each.
    slits: [(DVec3, DVec3); 2],
}

/// Sine of an angle under which two directions are parallel. Directions written with 12 digits that are meant to be so pass;
/// taking such slits for parallel ones moves rays by 1e-11 of the scene's size.
const PARALLEL_SINE: f64 = 1e-11;

pub fn read(table: &Table) -> Result<Arc<dyn Recipe>> {
    let window = if table.has("right") || table.has("center") {
        table.allow(&[&["kind", "t_range", "center", "right", "up", "slits"][..], &tessellate::KEYS].concat())?;
        let vector = |key, example| table.need(key, example)?.vec3();
        let center = vector("center", "[0, 0, 0]")?;
        let plane = Plane { center, right: vector("right", "[4, 0, 0]")?, up: vector("up", "[0, 3, 0]")? };
        let sine = plane.right.normalize_or_zero().cross(plane.up.normalize_or_zero()).length();
        if sine <= PARALLEL_SINE {
            return Err(table.error("right and up span no plane; give two directions of some length"));
        }
        Window::Plane(plane)
    } else {
        table.allow(&[&["kind", "t_range", "height", "slits"][..], &POSE, &tessellate::KEYS].concat())?;
        Window::View { pose: Pose::read(table)?, height: length(&table.need("height", "3")?)? }
    };
    let expected = "two slits, as [{ distance = 8, angle = 90 }, { distance = 5, angle = 0 }]";
    let slits = table.need("slits", "[{ distance = 8, angle = 90 }, { distance = 5, angle = 0 }]")?;
    let [first, second] = slits.array::<2>(expected)?;
    Ok(Arc::new(CrossSlit {
        window,
        slits: [read_slit(&first)?, read_slit(&second)?],
        tessellation: Tessellation::read(table)?,
    }))
}

fn read_slit(field: &Field) -> Result<SlitSpec> {
    let table = field.table()?;
    if table.has("point") || table.has("direction") {
        table.allow(&["point", "direction"])?;
        let point = table.need("point", "[0, 0, 8]")?.vec3()?;
        return Ok(SlitSpec::Line(point, direction(&table.need("direction", "[0, 1, 0]")?)?));
    }
    table.allow(&["distance", "angle"])?;
    let distance = table.need("distance", "8")?.number()?;
    Ok(SlitSpec::Facing { distance, angle: table.need("angle", "90")?.number()? })
}

impl CrossSlit {
    fn lines(&self, plane: Plane, view: View) -> Result<Lines> {
        let slits = [0, 1].map_each(|k| match self.slits[k] {
            SlitSpec::Line(point, direction) => (point, direction),
            SlitSpec::Facing { distance, angle } => {
                let (sin, cos) = angle.to_radians().sin_cos();
                (plane.center - distance * view.forward, cos * view.right + sin * view.up)
            }
        });
        if slits[0].1.cross(slits[1].1).length() <= PARALLEL_SINE {
            return Err(Error::input("camera.slits: the two are parallel, so they fix no rays; turn one of them"));
        }
        Ok(Lines { plane, forward: view.forward, slits })
    }

    /// Returns the pose, if the image and both slits move with it.
    fn common_pose(&self) -> Option<&Pose> {
        let Window::View { pose, .. } = &self.window else { return None };
        let is_common = self.slits.iter().all(|slit| matches!(slit, SlitSpec::Facing { .. }));
        (is_common && pose.target.is_finite()).then_some(pose)
    }
}

impl Recipe for CrossSlit {
    /// One piece where both slits are parallel to the image plane, else a ray map.
    fn build(&self, setting: &Setting) -> Result<Built> {
        let size = setting.size()?;
        let common = self.common_pose();
        let (plane, view) = match &self.window {
            Window::Plane(plane) => (*plane, plane.view()),
            Window::View { pose, height } => {
                let view = pose.view()?;
                let (center, view) = common.map_or((pose.target, view), |_| (DVec3::ZERO, View::UNTURNED));
                let (half, [w, h]) = (height / 2.0, [size.0, size.1].map_each(f64::from));
                (Plane { center, right: half * w / h * view.right, up: half * view.up }, view)
            }
        };
        let lines = self.lines(plane, view)?;
        let side = |k: usize| lines.forward.dot(lines.plane.center - lines.slits[k].0);
        if lines.slits.iter().any(|s| s.1.dot(lines.forward).abs() > PARALLEL_SINE) {
            return self.tessellation.build(Arc::new(lines), setting);
        }
        if side(0) <= 0.0 {
            return Err(Error::input("camera.slits.0: rays start on it, so it must lie before the image plane"));
        }
        // a slit in the image plane takes in the rays of one line of the image alone
        let [at_0, at_x, at_y] = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)].map_each(|(x, y)| lines.at(x, y));
        let (Some(o), Some(x), Some(y)) = (at_0, at_x, at_y) else {
            return Err(Error::input("camera.slits.1: it lies in the image plane; move it out"));
        };
        let (px, py) = (x.origin - o.origin, y.origin - o.origin);
        let bundle = Bundle::over_image([o.origin, px, py], [o.direction, plane.right - px, plane.up - py], size);
        let pieces = match common {
            // the frame's origin is the target: the rays do not depend on how far away the eye is
            Some(pose) => Pieces::whole_turned_by(pose.view()?, pose.target, bundle, size),
            None => Pieces::whole(bundle, size.0, size.1),
        };
        Ok(Built::new(size, Rays::Pieces(pieces)))
    }
}

impl Plane {
    /// Returns the axes of its viewer.
    fn view(&self) -> View {
        let forward = self.up.cross(self.right).normalize();
        let right = self.right.normalize();
        View { forward, right, up: right.cross(forward).normalize() }
    }
}

impl Lines {
    /// From the first slit at t = 0 to the image plane at t = 1; `None` where the line meets the first slit behind the image
    /// plane, or not at all.
    fn at(&self, x: f64, y: f64) -> Option<Ray> {
        let place = self.plane.center + x * self.plane.right + y * self.plane.up;
        let [(p1, d1), (p2, d2)] = self.slits;
        let normal = (p2 - place).cross(d2);
        let origin = p1 + (place - p1).dot(normal) / d1.dot(normal) * d1;
        let direction = place - origin;
        (origin.is_finite() && direction.dot(self.forward) > 0.0).then_some(Ray { origin, direction })
    }
}

impl RayMap for Lines {
    fn ray(&self, a: f64, b: f64) -> Option<Ray> {
        self.at(2.0 * a - 1.0, 1.0 - 2.0 * b)
    }
}

//! `fisheye`: the angle from the view direction becomes a distance from the image's middle.

use super::{Lens, POSE, Pose, Posed};
use crate::camera::recipe::{Built, Recipe, Setting};
use crate::camera::tessellate::{KEYS, Tessellation};
use crate::camera::values::word;
use crate::input::Result;
use crate::input::reader::{Field, Table};
use glam::{DVec2, DVec3};
use std::sync::Arc;

/// How far from the middle of the image, in focal lengths, an angle from the view direction is seen
/// (Kannala and Brandt 2006, equations 2 to 5).
#[derive(Debug, Clone, Copy, PartialEq)]
enum Mapping {
    /// `r = theta`
    Equidistant,
    /// `r = 2 sin(theta / 2)`
    Equisolid,
    /// `r = 2 tan(theta / 2)`
    Stereographic,
    /// `r = sin(theta)`
    Orthographic,
}

impl Mapping {
    fn read(field: &Field) -> Result<Mapping> {
        let all = [
            ("equidistant", Mapping::Equidistant),
            ("equisolid", Mapping::Equisolid),
            ("stereographic", Mapping::Stereographic),
            ("orthographic", Mapping::Orthographic),
        ];
        word(field, &all, "use \"equidistant\", \"equisolid\", \"stereographic\" or \"orthographic\"")
    }

    fn radius(self, theta: f64) -> f64 {
        match self {
            Mapping::Equidistant => theta,
            Mapping::Equisolid => 2.0 * (theta / 2.0).sin(),
            Mapping::Stereographic => 2.0 * (theta / 2.0).tan(),
            Mapping::Orthographic => theta.sin(),
        }
    }

    fn angle(self, r: f64) -> f64 {
        match self {
            Mapping::Equidistant => r,
            Mapping::Equisolid => 2.0 * (r / 2.0).asin(),
            Mapping::Stereographic => 2.0 * (r / 2.0).atan(),
            Mapping::Orthographic => r.asin(),
        }
    }

    /// The widest field of view in degrees, and whether it may be reached: up to there `radius` grows.
    fn widest(self) -> (f64, bool) {
        match self {
            Mapping::Equidistant | Mapping::Equisolid => (360.0, true),
            Mapping::Stereographic => (360.0, false),
            Mapping::Orthographic => (180.0, true),
        }
    }
}

#[derive(Debug, PartialEq)]
struct Fisheye {
    pose: Pose,
    mapping: Mapping,
    /// Radians; of the circle or of the image's diagonal.
    fov: f64,
    /// The circle fits the shorter side of the image, and no ray lies outside.
    circular: bool,
    tessellation: Tessellation,
}

pub fn read(table: &Table) -> Result<Arc<dyn Recipe>> {
    table.allow(&[&["kind", "t_range", "fov", "mapping", "frame"][..], &POSE, &KEYS].concat())?;
    let mapping = table.or("mapping", Mapping::Equidistant, Mapping::read)?;
    let fov = table.need("fov", "180")?;
    let (widest, reached) = mapping.widest();
    let degrees = fov.number()?;
    if !(degrees > 0.0 && (degrees < widest || reached && degrees == widest)) {
        let to = if reached { "to" } else { "to under" };
        return Err(fov.error(format_args!("{degrees} degrees; this mapping shows from over 0 {to} {widest}")));
    }
    let frames = [("circular", true), ("full", false)];
    let circular = table.or("frame", true, |field| word(field, &frames, "use \"circular\" or \"full\""))?;
    let (pose, fov, tessellation) = (Pose::read(table)?, degrees.to_radians(), Tessellation::read(table)?);
    Ok(Arc::new(Fisheye { pose, mapping, fov, circular, tessellation }))
}

impl Recipe for Fisheye {
    fn build(&self, setting: &Setting) -> Result<Built> {
        let (w, h) = setting.size()?;
        let size = DVec2::new(w.into(), h.into());
        let radius_px = if self.circular { size.min_element() / 2.0 } else { size.length() / 2.0 };
        let lens = Circle {
            mapping: self.mapping,
            edge: self.mapping.radius(self.fov / 2.0),
            half: size / (2.0 * radius_px),
            circular: self.circular,
        };
        self.tessellation.build(Arc::new(Posed::new(&self.pose, lens)?), setting)
    }
}

/// Unit directions over the image.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Circle {
    mapping: Mapping,
    /// The mapping's radius at half the field of view.
    edge: f64,
    /// Half the image's sides, in radii of the circle.
    half: DVec2,
    circular: bool,
}

impl Lens for Circle {
    fn direction(&self, a: f64, b: f64) -> Option<DVec3> {
        let q = DVec2::new(2.0 * a - 1.0, 1.0 - 2.0 * b) * self.half;
        let rho = q.length();
        if self.circular && rho > 1.0 + RIM_ROUNDING * self.half.max_element() {
            return None;
        }
        // the corners of a full frame are at 1 but for rounding
        let (sin, cos) = self.mapping.angle(rho.min(1.0) * self.edge).sin_cos();
        let across = if rho > 0.0 { q * (sin / rho) } else { DVec2::ZERO };
        Some(across.extend(cos))
    }
}

/// Bound on the rounding of a place's radius, relative to the larger of `half`: a and b are rounded (half an epsilon) and doubled, and q
/// and its length take two roundings each, under 5 epsilons in all. No pixel centre outside the rim is this near to it: the square
/// of its distance from the middle, in half pixels, is a whole number.
const RIM_ROUNDING: f64 = 8.0 * f64::EPSILON;

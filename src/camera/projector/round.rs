//! Round control surfaces: cylinder, sphere, disc. The formulas are those of the `projector` camera's description.

use crate::arrays::MapEach;
use crate::camera::curve::Bend;
use crate::camera::values::{direction, number_if};
use crate::input::Result;
use crate::input::reader::{Field, Table};
use glam::{DVec2, DVec3};
use std::f64::consts::TAU;

/// `center + radius (cos th e1 + sin th e2) + height (v - 1/2) axis`, `th = from + u (to - from)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cylinder {
    center: DVec3,
    /// Unit.
    axis: DVec3,
    e1: DVec3,
    e2: DVec3,
    radius: f64,
    /// Negative: the image is turned over.
    height: f64,
    /// Radians.
    from: f64,
    to: f64,
}

/// `center + radius (cos p sin l, sin p, cos p cos l)`, `l = lon0 + u (lon1 - lon0)`, `p = lat0 + v (lat1 - lat0)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sphere {
    center: DVec3,
    radius: f64,
    /// Radians.
    lon: [f64; 2],
    lat: [f64; 2],
}

/// `center + v radius (cos 2 pi u e1 + sin 2 pi u e2)`: polar.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Disc {
    center: DVec3,
    e1: DVec3,
    e2: DVec3,
    radius: f64,
}

/// Above this cosine between the axis and world z, angles are counted from world x instead.
const AXIS_ALONG_Z: f64 = 0.999;

impl Cylinder {
    pub(super) fn read(table: &Table) -> Result<Cylinder> {
        table.allow(&["kind", "center", "axis", "radius", "height", "from", "to"])?;
        let center = table.need("center", "[0, 0, 0]")?.vec3()?;
        let axis = direction(&table.need("axis", "[0, 1, 0]")?)?;
        let start = if axis.z.abs() > AXIS_ALONG_Z { DVec3::X } else { DVec3::Z };
        let e1 = start.reject_from_normalized(axis).normalize();
        let degrees = |field: &Field| Ok(field.number()?.to_radians());
        Ok(Cylinder {
            center,
            axis,
            e1,
            e2: axis.cross(e1),
            radius: read_radius(table)?,
            height: table.need("height", "2")?.number()?,
            from: table.or("from", 0.0, degrees)?,
            to: table.or("to", TAU, degrees)?,
        })
    }

    pub fn at(&self, uv: DVec2) -> DVec3 {
        let (sin, cos) = (self.from + uv.x * (self.to - self.from)).sin_cos();
        self.center + self.radius * (cos * self.e1 + sin * self.e2) + self.height * (uv.y - 0.5) * self.axis
    }

    pub(super) fn bend(&self) -> Bend {
        Bend { aaa: self.radius * (self.to - self.from).abs().powi(3), ..Bend::default() }
    }
}

impl Sphere {
    pub(super) fn read(table: &Table) -> Result<Sphere> {
        table.allow(&["kind", "center", "radius", "lon", "lat"])?;
        let center = table.need("center", "[0, 0, 0]")?.vec3()?;
        let degrees = |field: &Field| Ok(field.numbers::<2>("two angles in degrees")?.map_each(f64::to_radians));
        Ok(Sphere {
            center,
            radius: read_radius(table)?,
            lon: degrees(&table.need("lon", "[-180, 180]")?)?,
            lat: degrees(&table.need("lat", "[90, -90]")?)?,
        })
    }

    pub fn at(&self, uv: DVec2) -> DVec3 {
        let (sin_l, cos_l) = (self.lon[0] + uv.x * (self.lon[1] - self.lon[0])).sin_cos();
        let (sin_p, cos_p) = (self.lat[0] + uv.y * (self.lat[1] - self.lat[0])).sin_cos();
        self.center + self.radius * DVec3::new(cos_p * sin_l, sin_p, cos_p * cos_l)
    }

    pub(super) fn bend(&self) -> Bend {
        let of_angles = Bend { aaa: self.radius, aab: self.radius, abb: self.radius, bbb: self.radius };
        of_angles.scaled(self.lon[1] - self.lon[0], self.lat[1] - self.lat[0])
    }
}

impl Disc {
    pub(super) fn read(table: &Table) -> Result<Disc> {
        table.allow(&["kind", "center", "normal", "radius", "up"])?;
        let center = table.need("center", "[0, 0, 0]")?.vec3()?;
        let normal = direction(&table.need("normal", "[0, 0, 1]")?)?;
        let up = table.or("up", DVec3::Y, direction)?;
        let e1 = up.reject_from_normalized(normal);
        if e1.length() < super::super::view::UP_SINE_MIN {
            return Err(table.error("up is parallel to normal; give another up"));
        }
        let e1 = e1.normalize();
        Ok(Disc { center, e1, e2: normal.cross(e1), radius: read_radius(table)? })
    }

    pub fn at(&self, uv: DVec2) -> DVec3 {
        let (sin, cos) = (TAU * uv.x).sin_cos();
        self.center + uv.y * self.radius * (cos * self.e1 + sin * self.e2)
    }

    /// Over a rectangle of (u, v).
    pub(super) fn bend(&self, [lo, hi]: [DVec2; 2]) -> Bend {
        let turned = self.radius * TAU * TAU;
        Bend { aaa: lo.y.abs().max(hi.y.abs()) * turned * TAU, aab: turned, ..Bend::default() }
    }
}

/// A length of 0 or more.
fn read_radius(table: &Table) -> Result<f64> {
    number_if(&table.need("radius", "1")?, |radius| radius >= 0.0, "is below 0; a radius is a length")
}

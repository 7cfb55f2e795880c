//! The control surfaces of a projector: a point of space for every (u, v) (Brosz et al. 2007, sections 3.2 and 4.1).

use super::facets::Facets;
use super::patch::Patch;
use super::round::{Cylinder, Disc, Sphere};
use crate::input::Result;
use crate::input::reader::{Field, Table};
use glam::{DVec2, DVec3};

/// A surface, world units; u and v are [0, 1] over its natural extent, and it goes on beyond that.
#[derive(Debug, Clone, PartialEq)]
pub enum Surface {
    Plane(Plane),
    /// The corners at (u, v) = (0, 0), (1, 0), (0, 1), (1, 1).
    Bilinear([DVec3; 4]),
    Cylinder(Cylinder),
    Sphere(Sphere),
    Disc(Disc),
    Patch(Patch),
    Pieces(Facets),
    /// Not of scene files.
    Pulled(Pulled),
}

/// `origin + u U + v V`. A point is a plane without extent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plane {
    pub origin: DVec3,
    pub u: DVec3,
    pub v: DVec3,
}

impl Plane {
    pub fn point(at: DVec3) -> Plane {
        Plane { origin: at, u: DVec3::ZERO, v: DVec3::ZERO }
    }

    pub fn at(&self, uv: DVec2) -> DVec3 {
        self.origin + uv.x * self.u + uv.y * self.v
    }
}

/// A plane whose places are drawn towards a pole by `pull`, and those nearer than that to the pole itself: the radial
/// distortion of an occlusion camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pulled {
    pub plane: Plane,
    /// (u, v).
    pub pole: DVec2,
    /// In units of v.
    pub pull: f64,
    /// How many units of v there are in one of u.
    pub aspect: f64,
}

impl Pulled {
    pub fn at(&self, uv: DVec2) -> DVec3 {
        let away = uv - self.pole;
        let distance = (away * DVec2::new(self.aspect, 1.0)).length();
        let left = if distance > self.pull { 1.0 - self.pull / distance } else { 0.0 };
        self.plane.at(self.pole + left * away)
    }
}

impl From<Plane> for Surface {
    fn from(plane: Plane) -> Surface {
        Surface::Plane(plane)
    }
}

/// The names of all kinds, and their readers.
const KINDS: &[Reader<Surface>] = &[
    ("plane", read_plane),
    ("bilinear", read_bilinear),
    ("point", read_point),
    ("cylinder", |t| Cylinder::read(t).map(Surface::Cylinder)),
    ("sphere", |t| Sphere::read(t).map(Surface::Sphere)),
    ("disc", |t| Disc::read(t).map(Surface::Disc)),
    ("bezier", |t| Patch::read_bezier(t).map(Surface::Patch)),
    ("bspline", |t| Patch::read_bspline(t).map(Surface::Patch)),
    ("nurbs", |t| Patch::read_nurbs(t).map(Surface::Patch)),
    ("pieces", |t| Facets::read(t).map(Surface::Pieces)),
];

impl Surface {
    pub(super) fn read(field: &Field) -> Result<Surface> {
        let table = field.table()?;
        read_kind(&table, "plane", KINDS)
    }

    /// The point at (u, v), and its piece (0 but for a `pieces` surface); `None`: the surface has no point there.
    pub fn at(&self, uv: DVec2) -> Option<(u32, DVec3)> {
        let point = match self {
            Surface::Plane(s) => s.at(uv),
            Surface::Bilinear(c) => c[0].lerp(c[1], uv.x).lerp(c[2].lerp(c[3], uv.x), uv.y),
            Surface::Cylinder(s) => s.at(uv),
            Surface::Sphere(s) => s.at(uv),
            Surface::Disc(s) => s.at(uv),
            Surface::Patch(s) => s.at(uv)?,
            Surface::Pieces(s) => return s.at(uv),
            Surface::Pulled(s) => s.at(uv),
        };
        Some((0, point))
    }

    /// The surface as a plane, where it is exactly one.
    pub(super) fn plane(&self) -> Option<Plane> {
        match self {
            Surface::Plane(plane) => Some(*plane),
            Surface::Bilinear([c00, c10, c01, c11]) => {
                let plane = Plane { origin: *c00, u: *c10 - *c00, v: *c01 - *c00 };
                (*c11 - *c01 == plane.u && *c11 - *c10 == plane.v).then_some(plane)
            }
            _ => None,
        }
    }
}

/// A kind's name, and what reads its table.
pub(super) type Reader<T> = (&'static str, fn(&Table) -> Result<T>);

/// Reads a table by its `kind`, one of `kinds`.
pub(super) fn read_kind<T>(table: &Table, example: &str, kinds: &[Reader<T>]) -> Result<T> {
    let kind = table.need("kind", &format!("{example:?}"))?;
    let name = kind.text()?;
    let Some((_, read)) = kinds.iter().find(|k| k.0 == name) else {
        let known: Vec<&str> = kinds.iter().map(|k| k.0).collect();
        return Err(kind.error(format_args!("unknown kind {name:?}; use one of {}", known.join(", "))));
    };
    read(table)
}

fn read_plane(table: &Table) -> Result<Surface> {
    table.allow(&["kind", "origin", "u", "v"])?;
    let origin = table.need("origin", "[-1, 1, 0]")?.vec3()?;
    let (u, v) = (table.need("u", "[2, 0, 0]")?.vec3()?, table.need("v", "[0, -2, 0]")?.vec3()?);
    Ok(Surface::Plane(Plane { origin, u, v }))
}

fn read_bilinear(table: &Table) -> Result<Surface> {
    table.allow(&["kind", "corners"])?;
    let corners = table.need("corners", "[[-1, 1, 0], [1, 1, 0], [-1, -1, 0], [1, -1, 0]]")?;
    let [c00, c10, c01, c11] = corners.array::<4>("four points: at (u, v) = (0, 0), (1, 0), (0, 1), (1, 1)")?;
    Ok(Surface::Bilinear([c00.vec3()?, c10.vec3()?, c01.vec3()?, c11.vec3()?]))
}

fn read_point(table: &Table) -> Result<Surface> {
    table.allow(&["kind", "at"])?;
    Ok(Surface::Plane(Plane::point(table.need("at", "[0, 0, 5]")?.vec3()?)))
}

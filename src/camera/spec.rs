//! `[camera]`: the kind's own keys, each checked to be a finite value of its type. What the values
//! mean together (eye = target, overlapping pieces) is the camera's to check when it is built.

use std::path::PathBuf;
use std::sync::Arc;

use glam::DVec3;

use crate::camera::kinds::NAMED;
use crate::camera::mesh::spec::{MeshCameraSpec, read_mesh_camera};
use crate::camera::pose::{self, Pose};
use crate::camera::recipe::Recipe;
use crate::input::Result;
use crate::input::reader::{Field, Table};
use crate::input::tree::{nearest, quote};

/// The camera as written; section 2 of the contract has each kind's mapping.
#[derive(Debug, Clone, PartialEq)]
pub struct CameraSpec {
    pub kind: CameraKind,
    /// The ends of t, inclusive; the first finite or -inf, the second finite or +inf, in order.
    pub t_range: [f64; 2],
}

impl CameraKind {
    /// The name in a scene file.
    pub fn name(&self) -> &'static str {
        match self {
            CameraKind::Pinhole { .. } => "pinhole",
            CameraKind::Orthographic { .. } => "orthographic",
            CameraKind::Glc { .. } => "glc",
            CameraKind::Mesh(_) => "mesh",
            CameraKind::Raymap { .. } => "raymap",
            CameraKind::Named(named) => named.name,
        }
    }
}

#[derive(Debug, Clone, PartialEq)]
pub enum CameraKind {
    /// `vfov` in degrees.
    Pinhole {
        eye: DVec3,
        target: DVec3,
        up: DVec3,
        vfov: f64,
    },
    /// `height` of the image in world units.
    Orthographic {
        eye: DVec3,
        target: DVec3,
        up: DVec3,
        height: f64,
    },
    /// Near and far points at the image's (0, 0), (a = 1) and (b = 1) corners.
    Glc {
        near: [DVec3; 3],
        far: [DVec3; 3],
    },
    Mesh(MeshCameraSpec),
    /// Two H x W x 3 float files, .npy or EXR.
    Raymap {
        origins: PathBuf,
        directions: PathBuf,
    },
    /// Any other kind: see [`crate::camera::kinds`].
    Named(Named),
}

/// A camera of a kind that the camera module reads and builds by itself.
#[derive(Debug, Clone)]
pub struct Named {
    pub name: &'static str,
    pub recipe: Arc<dyn Recipe>,
}

impl PartialEq for Named {
    /// Recipes hold what was read, and print all of it.
    fn eq(&self, other: &Named) -> bool {
        self.name == other.name && format!("{:?}", self.recipe) == format!("{:?}", other.recipe)
    }
}

/// The kinds that are read here.
const PLAIN: [&str; 5] = ["pinhole", "orthographic", "glc", "mesh", "raymap"];

pub(crate) fn read_camera(field: &Field) -> Result<CameraSpec> {
    let table = field.table()?;
    let Some(kind) = table.get("kind") else {
        return Err(table.error(format_args!("kind is missing; add kind = one of {}", names().join(", "))));
    };
    let kind = match kind.text()? {
        "pinhole" => read_pinhole(&table)?,
        "orthographic" => read_orthographic(&table)?,
        "glc" => read_glc(&table)?,
        "mesh" => read_mesh_kind(&table)?,
        "raymap" => read_raymap(&table)?,
        other => {
            let named = NAMED.iter().find(|k| k.name == other).ok_or_else(|| unknown_kind(&kind, other))?;
            CameraKind::Named(Named { name: named.name, recipe: (named.read)(&table)? })
        }
    };
    Ok(CameraSpec { kind, t_range: table.or("t_range", [0.0, f64::INFINITY], read_t_range)? })
}

/// The names of all kinds.
fn names() -> Vec<&'static str> {
    PLAIN.into_iter().chain(NAMED.iter().map(|k| k.name)).collect()
}

fn unknown_kind(field: &Field, kind: &str) -> crate::input::Error {
    let names = names();
    let near = nearest(kind, &names).unwrap_or_default();
    let known = names.join(", ");
    field.error(format_args!("unknown camera kind {}; nearest known: {near:?} (known: {known})", quote(kind)))
}

fn read_pinhole(table: &Table) -> Result<CameraKind> {
    table.allow(&[&["kind", "t_range"], &pose::KEYS[..], &["vfov"]].concat())?;
    let (eye, target, up) = Pose::read(table)?.directed();
    Ok(CameraKind::Pinhole { eye, target, up, vfov: table.need("vfov", "40")?.number()? })
}

fn read_orthographic(table: &Table) -> Result<CameraKind> {
    table.allow(&[&["kind", "t_range"], &pose::KEYS[..], &["height"]].concat())?;
    let (eye, target, up) = Pose::read(table)?.directed();
    Ok(CameraKind::Orthographic { eye, target, up, height: table.need("height", "10")?.number()? })
}

fn read_glc(table: &Table) -> Result<CameraKind> {
    table.allow(&["kind", "t_range", "near", "far"])?;
    let near = read_corners(&table.need("near", "[[-1, 1, 0], [1, 1, 0], [-1, -1, 0]]")?)?;
    let far = read_corners(&table.need("far", "[[-2, 2, -1], [2, 2, -1], [-2, -2, -1]]")?)?;
    Ok(CameraKind::Glc { near, far })
}

fn read_corners(field: &Field) -> Result<[DVec3; 3]> {
    let [at_0, at_a, at_b] = field.array::<3>("three points, as [[x, y, z], [x, y, z], [x, y, z]]")?;
    Ok([at_0.vec3()?, at_a.vec3()?, at_b.vec3()?])
}

fn read_mesh_kind(table: &Table) -> Result<CameraKind> {
    table.allow(&["kind", "t_range", "vertices", "triangles", "file", "normalize"])?;
    Ok(CameraKind::Mesh(read_mesh_camera(table)?))
}

fn read_raymap(table: &Table) -> Result<CameraKind> {
    table.allow(&["kind", "t_range", "origins", "directions"])?;
    let origins = table.need("origins", "\"origins.npy\"")?.path()?;
    let directions = table.need("directions", "\"directions.npy\"")?.path()?;
    Ok(CameraKind::Raymap { origins, directions })
}

fn read_t_range(field: &Field) -> Result<[f64; 2]> {
    let expected = "a number, inf or -inf";
    let [first, last] = field.array::<2>("the two ends of t, as [0, inf]")?;
    let (first, last) = (first.number_or_inf(expected)?, last.number_or_inf(expected)?);
    if first > last {
        return Err(field.error(format_args!("the first end {first} is above the second {last}; swap them")));
    }
    if first == f64::INFINITY || last == f64::NEG_INFINITY {
        return Err(field.error("the range holds no finite t; use e.g. [0, inf]"));
    }
    Ok([first, last])
}

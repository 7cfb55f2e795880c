//! `[[mesh]]`: where triangles come from and how they are placed.

use std::path::PathBuf;

use glam::DVec3;

use super::node::{nearest, quote};
use super::reader::{Field, Table};
use crate::error::Result;
use crate::scene::generate::Builtin;

/// One `[[mesh]]`: a source of triangles, placed by scale, then rotation, then translation.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshSpec {
    pub source: MeshSource,
    /// What it is called; `None`: as its file or builtin.
    pub name: Option<String>,
    /// World units.
    pub translate: DVec3,
    /// Degrees about x, then y, then z (world axes).
    pub rotate: DVec3,
    pub scale: DVec3,
    /// Both faces are visible.
    pub two_sided: bool,
    /// Linear RGB in [0, 1] for the whole mesh; `None` keeps the source's materials.
    pub color: Option<[f32; 3]>,
}

#[derive(Debug, Clone, PartialEq)]
pub enum MeshSource {
    /// An .obj, .gltf or .glb file, already relative to the working directory.
    File(PathBuf),
    Builtin(Builtin),
}

impl MeshSpec {
    /// Its name, its file's without folder and extension, or its builtin's.
    pub fn called(&self) -> String {
        match (&self.name, &self.source) {
            (Some(name), _) => name.clone(),
            (None, MeshSource::File(path)) => path.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
            (None, MeshSource::Builtin(builtin)) => builtin.name().into(),
        }
    }
}

/// The keys that every mesh may have, whatever its source.
const PLACING: [&str; 6] = ["name", "translate", "rotate", "scale", "two_sided", "color"];

const BUILTINS: [&str; 11] =
    ["teapot", "icosphere", "box", "cylinder", "stairs", "cow", "walker", "plane", "city", "terrain", "soup"];

/// `more` are keys that another reader takes.
pub(crate) fn read_mesh(field: &Field, more: &[&str]) -> Result<MeshSpec> {
    let table = field.table()?;
    let source = read_source(&table, more)?;
    Ok(MeshSpec {
        source,
        name: table.optional("name", |f| Ok(f.text()?.to_owned()))?,
        translate: table.or("translate", DVec3::ZERO, Field::vec3)?,
        rotate: table.or("rotate", DVec3::ZERO, Field::vec3)?,
        scale: table.or("scale", DVec3::ONE, read_scale)?,
        two_sided: table.or("two_sided", true, Field::boolean)?,
        color: table.optional("color", Field::color)?,
    })
}

fn read_source(table: &Table, more: &[&str]) -> Result<MeshSource> {
    match (table.get("file"), table.get("builtin")) {
        (Some(_), Some(builtin)) => Err(builtin.error("a mesh has either a file or a builtin; remove one of the two")),
        (Some(file), None) => {
            allow(table, "file", more)?;
            Ok(MeshSource::File(file.path()?))
        }
        (None, Some(builtin)) => Ok(MeshSource::Builtin(read_builtin(table, &builtin, more)?)),
        (None, None) => {
            // A misspelt `file` is found here, before its absence is.
            allow(
                table,
                "file",
                &["builtin", "level", "sides", "steps", "size", "divisions", "seed", "blocks", "triangles"],
            )?;
            Err(table.error("a mesh needs file = \"NAME.obj\" or builtin = \"city\""))
        }
    }
}

fn allow(table: &Table, source: &str, own: &[&str]) -> Result<()> {
    table.allow(&[&[source], own, &PLACING].concat())
}

fn read_builtin(table: &Table, builtin: &Field, more: &[&str]) -> Result<Builtin> {
    // Only what the types hold is checked here: how large a mesh may be is its generator's to say.
    let whole = |key, default| table.or(key, default, |f| f.integer(0, u64::MAX));
    let small = |key, default| table.or(key, default, read_u32);
    let seed = || whole("seed", 1);
    let name = builtin.text()?;
    let own: &[&str] = match name {
        "teapot" | "icosphere" | "cow" | "walker" => &["level"],
        "cylinder" => &["sides"],
        "stairs" => &["steps"],
        "box" => &[],
        "plane" => &["size", "divisions"],
        "city" => &["seed", "blocks", "triangles"],
        "terrain" => &["seed", "size"],
        "soup" => &["seed", "triangles"],
        _ => return Err(unknown_builtin(builtin, name)),
    };
    allow(table, "builtin", &[own, more].concat())?;
    Ok(match name {
        "teapot" => Builtin::Teapot { level: small("level", 10)? },
        "icosphere" => Builtin::Icosphere { level: small("level", 4)? },
        "box" => Builtin::Box,
        "cylinder" => Builtin::Cylinder { sides: small("sides", 32)? },
        "stairs" => Builtin::Stairs { steps: small("steps", 10)? },
        "cow" => Builtin::Cow { level: small("level", 2)? },
        "walker" => Builtin::Walker { level: small("level", 2)? },
        "plane" => Builtin::Plane { size: table.or("size", 10.0, Field::number)?, divisions: small("divisions", 1)? },
        "city" => Builtin::City {
            seed: seed()?,
            blocks: table.optional("blocks", read_u32)?,
            triangles: whole("triangles", 15_000)?,
        },
        "terrain" => Builtin::Terrain { seed: seed()?, size: small("size", 256)? },
        _ => Builtin::Soup { seed: seed()?, triangles: whole("triangles", 10_000)? },
    })
}

fn unknown_builtin(builtin: &Field, name: &str) -> crate::error::Error {
    let near = nearest(name, &BUILTINS).unwrap_or_default();
    builtin.error(format_args!(
        "unknown built-in mesh {}; nearest known: {near:?} (known: {})",
        quote(name),
        BUILTINS.join(", ")
    ))
}

/// One number for all axes, or one an axis.
fn read_scale(field: &Field) -> Result<DVec3> {
    if field.is_list() { field.vec3() } else { Ok(DVec3::splat(field.number()?)) }
}

fn read_u32(field: &Field) -> Result<u32> {
    // In range of u32 by the limit given.
    Ok(field.integer(0, u32::MAX.into())? as u32)
}

//! `[[mesh]]`: the source of triangles, and their placement.

use crate::arrays::MapEach;
use std::path::PathBuf;

use glam::{DVec2, DVec3};

use crate::geometry::generate::Builtin;
use crate::geometry::heights::{HeightSpec, is_height_image};
use crate::geometry::mesh::{DIELECTRIC, Material};
use crate::geometry::pattern::{Pattern, read_pattern};
use crate::geometry::place::STRETCHES;
use crate::geometry::places::Places;
use crate::geometry::spheres::{self, SpheresSpec};
use crate::input::Result;
use crate::input::keyframes::BETWEEN;
use crate::input::reader::{Field, Table};
use crate::input::tree::{Value, nearest, quote};

/// One `[[mesh]]`: a source of triangles, placed by scale, then rotation, then translation.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshSpec {
    pub source: MeshSource,
    /// Its name; `None`: that of its file or builtin.
    pub name: Option<String>,
    /// World units.
    pub translate: DVec3,
    /// Degrees about x, then y, then z (world axes).
    pub rotate: DVec3,
    pub scale: DVec3,
    /// Copies of the mesh, each with one of these transforms after the other three; `None`: no copies.
    pub places: Option<Places>,
    /// Both faces are visible; `None`: as its file says.
    pub two_sided: Option<bool>,
    /// The nodes or groups of its file are objects with names of their own.
    pub has_parts: bool,
    /// Materials with an opacity are blended, by samples.
    pub blend: bool,
    /// Corners without a normal get vertex normals.
    pub smooth: bool,
    /// Linear RGB in [0, 1] for the whole mesh, without the images and colours of its file; `None` keeps the source's materials.
    pub color: Option<[f32; 3]>,
    pub texture: TextureSpec,
    /// Pattern that multiplies its colour, by default white.
    pub pattern: Option<Pattern>,
    pub gloss: GlossSpec,
    /// A glTF file may name files outside of its folder.
    pub outside_files: bool,
    /// The animation of a glTF file that it is at a time of.
    pub animation: Option<AnimationSpec>,
}

/// A time of an animation of a glTF file.
#[derive(Debug, Clone, PartialEq)]
pub struct AnimationSpec {
    /// Its name or its number.
    pub name: String,
    /// Seconds.
    pub time: f64,
}

/// Overrides of the material's shininess: see [`crate::geometry::mesh::Material`].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct GlossSpec {
    pub specular: Option<[f32; 3]>,
    pub roughness: Option<f32>,
    pub metallic: Option<f32>,
    pub emissive: Option<[f32; 3]>,
}

impl GlossSpec {
    /// What says how rough or metallic it is reflects as most surfaces do, unless it says that too.
    pub fn apply(&self, material: &mut Material) {
        let shines = self.roughness.is_some() || self.metallic.is_some();
        let plain = if shines && material.specular == [0.0; 3] { [DIELECTRIC; 3] } else { material.specular };
        material.specular = self.specular.unwrap_or(plain);
        material.roughness = self.roughness.unwrap_or(material.roughness);
        material.metallic = self.metallic.unwrap_or(material.metallic);
        material.emissive = self.emissive.unwrap_or(material.emissive);
    }
}

/// Which image lies on a mesh.
#[derive(Debug, Clone, PartialEq)]
pub enum TextureSpec {
    /// Those that its file names.
    OfFile,
    /// None.
    LeftOut,
    /// This one on all of it, times the mesh's `color`.
    Image {
        /// An image file, already relative to the working directory.
        file: PathBuf,
        /// Number of repetitions over texture coordinates from 0 to 1.
        repeat: DVec2,
        /// The least opacity at which there is a surface.
        cutoff: Option<f32>,
    },
}

#[derive(Debug, Clone, PartialEq)]
pub enum MeshSource {
    /// An .obj, .gltf, .glb, .ply, .stl, .off or .dae file, already relative to the working directory.
    File(PathBuf),
    /// On the way from one such file to another of the same triangles, and the share of that way.
    Between([PathBuf; 2], f64),
    /// An .asc, .png or .tif file of heights.
    Heights(HeightSpec),
    Builtin(Builtin),
    /// Spheres, not triangles.
    Spheres(SpheresSpec),
    /// A program's arrays.
    Given,
}

impl MeshSpec {
    /// The mesh of a source, with no other keys.
    pub fn of(source: MeshSource) -> MeshSpec {
        MeshSpec {
            source,
            name: None,
            translate: DVec3::ZERO,
            rotate: DVec3::ZERO,
            scale: DVec3::ONE,
            places: None,
            two_sided: Some(true),
            has_parts: false,
            blend: false,
            smooth: false,
            outside_files: false,
            animation: None,
            color: None,
            texture: TextureSpec::OfFile,
            pattern: None,
            gloss: GlossSpec::default(),
        }
    }

    /// Spheres stay spheres: its scale is one number but 0, or the same for all axes.
    pub fn keeps_spheres(&self) -> bool {
        let size = self.scale.abs();
        size == DVec3::splat(size.x) && size.x > 0.0
    }

    /// Its name, its file's without folder and extension, or its builtin's.
    pub fn called(&self) -> String {
        match (&self.name, &self.source) {
            (Some(name), _) => name.clone(),
            (
                None,
                MeshSource::File(path)
                | MeshSource::Between([path, _], _)
                | MeshSource::Heights(HeightSpec { file: path, .. }),
            ) => path.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
            (None, MeshSource::Builtin(builtin)) => builtin.name().into(),
            (None, MeshSource::Spheres(spheres)) => spheres.name(),
            (None, MeshSource::Given) => "mesh".into(),
        }
    }
}

/// The keys that every mesh may have, whatever its source.
const PLACING: [&str; 15] = [
    "name",
    "translate",
    "rotate",
    "scale",
    "places",
    "two_sided",
    "blend",
    "smooth",
    "color",
    "texture",
    "pattern",
    "specular",
    "roughness",
    "metallic",
    "emissive",
];

/// The keys of meshes from files, of terrain from height images, and of all built-in meshes.
const OF_FILES: [&str; 4] = ["objects", "outside_files", "animation", "animation_time"];
const OF_HEIGHTS: [&str; 2] = ["height_scale", "cell"];
const OF_BUILTINS: [&str; 8] = ["level", "sides", "steps", "size", "divisions", "seed", "blocks", "triangles"];

const BUILTINS: [&str; 11] =
    ["teapot", "icosphere", "box", "cylinder", "stairs", "cow", "walker", "plane", "city", "terrain", "soup"];

/// `more` are keys that another reader takes.
pub(crate) fn read_mesh(field: &Field, more: &[&str]) -> Result<MeshSpec> {
    let table = field.table()?;
    let source = read_source(&table, more)?;
    read_keys(&table, source)
}

/// The keys of a mesh whose triangles are given otherwise.
pub(crate) fn read_look(field: &Field) -> Result<MeshSpec> {
    let table = field.table()?;
    table.allow(&PLACING)?;
    read_keys(&table, MeshSource::Given)
}

/// Keys of meshes that spheres do not have.
const OF_TRIANGLES: [&str; 3] = ["blend", "smooth", "texture"];

/// `[[spheres]]`.
pub(crate) fn read_spheres(field: &Field) -> Result<MeshSpec> {
    let table = field.table()?;
    let placing = PLACING.into_iter().filter(|key| !OF_TRIANGLES.contains(key));
    table.allow(&spheres::KEYS.into_iter().chain(placing).collect::<Vec<_>>())?;
    let spec = read_keys(&table, MeshSource::Spheres(spheres::read(&table)?))?;
    match table.get("scale").filter(|_| !spec.keeps_spheres()) {
        Some(scale) => Err(scale.error(format_args!("the scale {STRETCHES}"))),
        None => Ok(spec),
    }
}

fn read_keys(table: &Table, source: MeshSource) -> Result<MeshSpec> {
    Ok(MeshSpec {
        source,
        name: table.optional("name", |f| Ok(f.text()?.to_owned()))?,
        translate: table.or("translate", DVec3::ZERO, Field::vec3)?,
        rotate: table.or("rotate", DVec3::ZERO, Field::vec3)?,
        scale: table.or("scale", DVec3::ONE, read_scale)?,
        places: table.optional("places", Places::read)?,
        two_sided: table.or("two_sided", Some(true), read_sides)?,
        has_parts: table.or("objects", false, read_objects)?,
        blend: table.or("blend", false, Field::boolean)?,
        smooth: table.or("smooth", false, Field::boolean)?,
        color: table.optional("color", Field::color)?,
        texture: table.or("texture", TextureSpec::OfFile, read_texture)?,
        pattern: table.optional("pattern", read_pattern)?,
        gloss: GlossSpec {
            specular: table.optional("specular", read_reflectance)?,
            roughness: table.optional("roughness", read_share)?,
            metallic: table.optional("metallic", read_share)?,
            emissive: table.optional("emissive", read_radiance)?,
        },
        outside_files: table.or("outside_files", false, Field::boolean)?,
        animation: read_animation(table)?,
    })
}

/// `true`, `false`, or "file" for what the file says.
fn read_sides(field: &Field) -> Result<Option<bool>> {
    match &field.node().value {
        Value::Text(text) if text == "file" => Ok(None),
        Value::Text(_) => Err(field.error("expected true, false or \"file\", which takes what the file says")),
        _ => field.boolean().map(Some),
    }
}

/// "one" for a mesh that is one object, "file" for an object each of the file's nodes or groups.
fn read_objects(field: &Field) -> Result<bool> {
    match field.text()? {
        "one" => Ok(false),
        "file" => Ok(true),
        other => {
            let other = quote(other);
            Err(field.error(format_args!(
                "{other} is neither \"one\" nor \"file\", which makes an object of each node or group"
            )))
        }
    }
}

fn read_animation(table: &Table) -> Result<Option<AnimationSpec>> {
    let time = table.optional("animation_time", Field::number)?;
    let Some(animation) = table.get("animation") else {
        return match table.get("animation_time") {
            Some(time) => Err(time.error("names no animation; add animation = \"NAME\" or its number")),
            None => Ok(None),
        };
    };
    let name = match animation.node().value {
        Value::Int(_) => animation.integer(0, u32::MAX.into())?.to_string(),
        _ => animation.text()?.to_owned(),
    };
    Ok(Some(AnimationSpec { name, time: time.unwrap_or(0.0) }))
}

/// `true` for those of its file, `false` for none, a file's name, or a table.
fn read_texture(field: &Field) -> Result<TextureSpec> {
    match &field.node().value {
        Value::Bool(true) => Ok(TextureSpec::OfFile),
        Value::Bool(false) => Ok(TextureSpec::LeftOut),
        Value::Table(_) => {
            let table = field.table()?;
            table.allow(&["file", "repeat", "cutoff"])?;
            Ok(TextureSpec::Image {
                file: table.need("file", "\"NAME.png\"")?.path()?,
                repeat: table.or("repeat", DVec2::ONE, read_repeat)?,
                cutoff: table.optional("cutoff", read_share)?,
            })
        }
        _ => Ok(TextureSpec::Image { file: field.path()?, repeat: DVec2::ONE, cutoff: None }),
    }
}

fn read_source(table: &Table, more: &[&str]) -> Result<MeshSource> {
    match (table.get("file"), table.get("builtin")) {
        (Some(_), Some(builtin)) => Err(builtin.error("a mesh has either a file or a builtin; remove one of the two")),
        (Some(file), None) if file.is_table() => {
            allow(table, "file", &[&["outside_files", "objects"], more].concat())?;
            read_between(&file)
        }
        (Some(file), None) => {
            let path = file.path()?;
            if !is_height_image(&path) {
                allow(table, "file", &[&OF_FILES[..], more].concat())?;
                return Ok(MeshSource::File(path));
            }
            allow(table, "file", &[&OF_HEIGHTS, more].concat())?;
            Ok(MeshSource::Heights(HeightSpec {
                file: path,
                height_scale: table.or("height_scale", 1.0, Field::number)?,
                cell: table.optional("cell", read_cell)?,
            }))
        }
        (None, Some(builtin)) => Ok(MeshSource::Builtin(read_builtin(table, &builtin, more)?)),
        (None, None) => {
            // A misspelt `file` is found here, before its absence is.
            allow(table, "file", &[&["builtin"], &OF_FILES[..], &OF_HEIGHTS, &OF_BUILTINS].concat())?;
            Err(table.error("a mesh needs file = \"NAME.obj\" or builtin = \"city\""))
        }
    }
}

/// What keyframes of files come to between two of them.
fn read_between(file: &Field) -> Result<MeshSource> {
    let table = file.table()?;
    table.allow(&BETWEEN)?;
    let path = |key: &str| table.need(key, "\"NAME.obj\"")?.path();
    let files = [path("from")?, path("to")?];
    if let Some(heights) = files.iter().find(|path| is_height_image(path)) {
        let name = heights.display();
        return Err(
            file.error(format_args!("{name} has heights, which have no keyframes; use meshes of the same triangles"))
        );
    }
    Ok(MeshSource::Between(files, table.need("share", "0.5")?.number()?))
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

fn unknown_builtin(builtin: &Field, name: &str) -> crate::input::Error {
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

/// A number for both directions, or [x, z].
fn read_cell(field: &Field) -> Result<DVec2> {
    let cell = match field.is_list() {
        true => DVec2::from(field.numbers::<2>("the size of a cell, as [x, z]")?),
        false => DVec2::splat(field.number()?),
    };
    if cell.min_element() > 0.0 { Ok(cell) } else { Err(field.error("the size of a cell must be above 0")) }
}

/// From 0 to 1.
fn read_share(field: &Field) -> Result<f32> {
    Ok(field.number_if(|value| (0.0..=1.0).contains(&value), "does not lie in [0, 1]")? as f32)
}

/// One number for all colours, or a colour.
fn read_reflectance(field: &Field) -> Result<[f32; 3]> {
    if field.is_list() { field.color() } else { Ok([read_share(field)?; 3]) }
}

/// Linear RGB, 0 and above.
pub fn read_radiance(field: &Field) -> Result<[f32; 3]> {
    let rgb: [f64; 3] = field.numbers("linear RGB of 0 and above, as [r, g, b]")?;
    match rgb.iter().all(|c| (0.0..=f64::from(f32::MAX)).contains(c)) {
        true => Ok(rgb.map_each(|c| c as f32)),
        false => Err(field.error("there is no less light than none and no more than f32 holds")),
    }
}

/// One number for both directions, or one for each.
fn read_repeat(field: &Field) -> Result<DVec2> {
    match field.is_list() {
        true => Ok(DVec2::from(field.numbers::<2>("how often to the right and upwards, as [u, v]")?)),
        false => Ok(DVec2::splat(field.number()?)),
    }
}

fn read_u32(field: &Field) -> Result<u32> {
    // In range of u32 by the limit given.
    Ok(field.integer(0, u32::MAX.into())? as u32)
}

//! `[volume]`: where its numbers come from, where it lies, and what it looks like.

use super::load::{DESCRIBED, RawGrid};
use super::{ControlPoint, Mode, POINTS_MAX, SIDE_MAX};
use crate::arrays::MapEach;
use crate::image::{NumberFormat, NumberType};
use crate::input::Result;
use crate::input::reader::{Field, Table};
use glam::DVec3;
use std::path::PathBuf;

/// A volume as written, checked value by value.
#[derive(Debug, Clone, PartialEq)]
pub struct VolumeSpec {
    pub grid: GridSpec,
    /// By increasing value, at least one.
    pub transfer: Vec<ControlPoint>,
    pub mode: Mode,
    pub is_lit: bool,
}

/// Its numbers, and where they lie.
#[derive(Debug, Clone, PartialEq)]
pub struct GridSpec {
    pub source: GridSource,
    /// `None`: where the file's header says.
    pub placement: Option<Placement>,
    /// Degrees about x, then y, then z (world axes), about the middle of the box.
    pub rotate: DVec3,
}

#[derive(Debug, Clone, PartialEq)]
pub enum GridSource {
    /// An array, a NRRD or a MetaImage; already relative to the working directory.
    Described(PathBuf),
    /// Numbers without a header.
    Raw(PathBuf, RawGrid),
    /// A program's array.
    Given,
}

impl GridSource {
    /// It is a file that may say where its numbers lie.
    fn may_say_where(&self) -> bool {
        let is_npy = |path: &PathBuf| path.extension().is_some_and(|e| e.eq_ignore_ascii_case("npy"));
        matches!(self, GridSource::Described(path) if !is_npy(path))
    }
}

/// Where the first node lies, and the others; world units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Placement {
    /// The first and the last node.
    Box { min: DVec3, max: DVec3 },
    /// The first node, and the distances between neighbours.
    Nodes { origin: DVec3, spacing: DVec3 },
}

impl Placement {
    /// The places of the first and of the last node, of so many along z, y and x.
    #[cfg(feature = "cli")]
    pub fn ends(self, [z, y, x]: [u64; 3]) -> [DVec3; 2] {
        match self {
            Placement::Box { min, max } => [min, max],
            Placement::Nodes { origin, spacing } => {
                [origin, origin + spacing * DVec3::from([x, y, z].map_each(|n| (n - 1) as f64))]
            }
        }
    }
}

const LOOK: [&str; 8] = ["min", "max", "origin", "spacing", "rotate", "transfer", "mode", "lit"];
const OF_FILE: [&str; 4] = ["file", "shape", "type", "endian"];

pub(crate) fn read_volume(field: &Field) -> Result<VolumeSpec> {
    let table = field.table()?;
    table.allow(&[&OF_FILE[..], &LOOK].concat())?;
    let source = read_source(&table)?;
    read_all(&table, source)
}

/// The same of a program's array: all keys but those that say where numbers come from.
pub(crate) fn read_volume_look(field: &Field) -> Result<VolumeSpec> {
    let table = field.table()?;
    table.allow(&LOOK)?;
    read_all(&table, GridSource::Given)
}

fn read_all(table: &Table, source: GridSource) -> Result<VolumeSpec> {
    let placement = read_placement(table, source.may_say_where())?;
    let rotate = table.or("rotate", DVec3::ZERO, Field::vec3)?;
    let example = "[[0, 0, 0, 0, 0], [1, 1, 1, 1, 10]]: value, red, green, blue and extinction";
    let transfer = read_transfer(&table.need("transfer", example)?)?;
    let mode = table
        .or("mode", Mode::Composite, |f| f.choice([("composite", Mode::Composite), ("maximum", Mode::Maximum)]))?;
    let is_lit = table.or("lit", false, Field::boolean)?;
    if let (true, Mode::Maximum, Some(lit)) = (is_lit, mode, table.get("lit")) {
        return Err(lit.error("light shines on a volume of mode \"composite\" alone; remove lit or mode"));
    }
    Ok(VolumeSpec { grid: GridSpec { source, placement, rotate }, transfer, mode, is_lit })
}

fn read_source(table: &Table) -> Result<GridSource> {
    let field = table.need("file", "\"smoke.npy\"")?;
    let file = field.path()?;
    let ending = file.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
    match ending.as_str() {
        known if DESCRIBED.contains(&known) => match OF_FILE[1..].iter().find_map(|key| table.get(key)) {
            Some(key) => Err(key.error(format_args!("a .{ending} file says this itself; remove the key"))),
            None => Ok(GridSource::Described(file)),
        },
        "raw" => {
            let shape = table.need("shape", "[128, 256, 256]: as many along z, y and x")?;
            let sides = shape.array::<3>("three whole numbers, as [128, 256, 256]: along z, y and x")?;
            let mut sizes = [0; 3];
            for (size, side) in sizes.iter_mut().zip(&sides) {
                *size = side.integer(2, SIDE_MAX)?;
            }
            let number = table.need("type", "\"u16\"; or \"u8\", \"i16\", \"f32\"")?;
            let name = number.text()?;
            let other = || number.error(format_args!("use one of {}", NumberType::names().join(", ")));
            let number = NumberType::named(name, NumberFormat::Scene).ok_or_else(other)?;
            let big_endian = table.or("endian", false, |f| f.choice([("little", false), ("big", true)]))?;
            Ok(GridSource::Raw(file, RawGrid { shape: sizes, number, big_endian }))
        }
        _ => Err(field.error("a volume is read from a .npy, .nrrd, .nhdr, .mhd, .mha or .raw file")),
    }
}

/// `None` if the table says nothing and the file may.
fn read_placement(table: &Table, has_header: bool) -> Result<Option<Placement>> {
    let [min, max, origin, spacing] = ["min", "max", "origin", "spacing"].map_each(|key| table.get(key));
    match (min, max, origin, spacing) {
        (Some(min), Some(max), None, None) => {
            let (lo, hi) = (min.vec3()?, max.vec3()?);
            if lo.cmplt(hi).all() {
                Ok(Some(Placement::Box { min: lo, max: hi }))
            } else {
                Err(max.error("each number of max must be above that of min"))
            }
        }
        (None, None, Some(origin), Some(spacing)) => {
            let (first, apart) = (origin.vec3()?, spacing.vec3()?);
            if apart.cmpgt(DVec3::ZERO).all() {
                Ok(Some(Placement::Nodes { origin: first, spacing: apart }))
            } else {
                Err(spacing.error("distances must be above 0"))
            }
        }
        (None, None, None, None) if has_header => Ok(None),
        (None, None, None, None) => {
            Err(table.error("the volume lies nowhere; add e.g. min = [-1, -1, -1] and max = [1, 1, 1]"))
        }
        _ => Err(table.error("give min and max, or origin and spacing")),
    }
}

fn read_transfer(field: &Field) -> Result<Vec<ControlPoint>> {
    let items = field.items("a list of [value, r, g, b, extinction]")?;
    let count = items.len();
    if count == 0 || count > POINTS_MAX {
        return Err(field.error(format_args!("{count} control points; there may be 1 to {POINTS_MAX}")));
    }
    let mut points: Vec<ControlPoint> = Vec::with_capacity(count);
    for item in items {
        let numbers: [f64; 5] = item.numbers("five numbers, as [value, r, g, b, extinction]")?;
        let [value, r, g, b, extinction] = numbers.map(|x| x as f32);
        if [r, g, b].iter().any(|c| !(0.0..=1.0).contains(c)) {
            return Err(item.error("colours lie in [0, 1]"));
        }
        if !(0.0..=EXTINCTION_MAX).contains(&extinction) {
            return Err(item.error(format_args!("extinction lies from 0 to {EXTINCTION_MAX}")));
        }
        if value.abs() > VALUE_MAX || points.last().is_some_and(|last| last.value >= value) {
            return Err(item.error(format_args!("values must increase, from -{VALUE_MAX} to {VALUE_MAX}")));
        }
        points.push(ControlPoint { value, colour: [r, g, b], extinction });
    }
    Ok(points)
}

/// Largest extinction and value: products of them stay far inside f32.
const EXTINCTION_MAX: f32 = 1e9;
pub const VALUE_MAX: f32 = 1e9;

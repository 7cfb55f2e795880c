//! `[camera]`: the keys of a kind, each checked to be a finite value of its type. Combinations (eye = target, overlapping
//! pieces) are checked when the camera is built.

use super::exposure::{self, Readout};
use super::kinds::KINDS;
use super::recipe::Recipe;
use crate::input::reader::{Field, Table};
use crate::input::tree::{nearest, quote};
use crate::input::{Error, Result};
use std::any::Any;
use std::sync::Arc;

/// The camera as written; `docs/reference/definitions.md` has each kind's mapping.
#[derive(Debug, Clone, PartialEq)]
pub struct CameraSpec {
    pub kind: CameraKind,
    /// The ends of t, inclusive; the first finite or -inf, the second finite or +inf, in order.
    pub t_range: [f64; 2],
}

/// A kind of camera with the values of its keys.
#[derive(Debug, Clone)]
pub struct CameraKind {
    /// The name in a scene file.
    pub name: &'static str,
    pub recipe: Arc<dyn Recipe>,
}

impl CameraKind {
    pub fn new(name: &'static str, recipe: impl Recipe) -> CameraKind {
        CameraKind { name, recipe: Arc::new(recipe) }
    }

    /// The recipe, if it is of this type: [`super::kinds::pinhole::Pinhole`], for example.
    pub fn recipe<R: Recipe>(&self) -> Option<&R> {
        (&*self.recipe as &dyn Any).downcast_ref()
    }
}

impl PartialEq for CameraKind {
    fn eq(&self, other: &CameraKind) -> bool {
        self.name == other.name && self.recipe.equals(&*other.recipe)
    }
}

pub(crate) fn read_camera(field: &Field) -> Result<CameraSpec> {
    read_kind(&field.table()?)
}

/// A camera that is part of another, whose pixels have no times of their own.
pub(crate) fn read_part(field: &Field) -> Result<CameraSpec> {
    let table = field.table()?;
    let spec = read_kind(&table)?;
    match ["line_time", "period"]
        .into_iter()
        .find_map(|key| table.get(key))
        .filter(|_| spec.kind.recipe.lines().is_some())
    {
        Some(key) => Err(key
            .error("a camera in another one has no times of its own; leave it out, or give the outer one a line_time")),
        None => Ok(spec),
    }
}

/// The camera of a scene: its kind, and when its pixels are read in an image of this size, with so many frames a second.
pub(crate) fn read_camera_and_readout(
    field: &Field,
    size: (Option<u32>, Option<u32>),
    frame_rate: f64,
) -> Result<(CameraSpec, Readout)> {
    let table = field.table()?.with_keys_read_elsewhere(&exposure::KEYS);
    let spec = read_kind(&table)?;
    let readout = exposure::read_readout(&table, spec.kind.recipe.lines(), size, frame_rate)?;
    Ok((spec, readout))
}

/// The camera alone of a scene, whatever is said about when its pixels are read.
pub(crate) fn read_camera_of_scene(field: &Field) -> Result<CameraSpec> {
    read_kind(&field.table()?.with_keys_read_elsewhere(&exposure::KEYS))
}

fn read_kind(table: &Table) -> Result<CameraSpec> {
    let names = || KINDS.iter().map(|k| k.name).collect::<Vec<_>>();
    let Some(key) = table.get("kind") else {
        return Err(table.error(format_args!("kind is missing; add kind = one of {}", names().join(", "))));
    };
    let name = key.text()?;
    let kind = KINDS.iter().find(|k| k.name == name).ok_or_else(|| unknown_kind(&key, name, &names()))?;
    let kind = CameraKind { name: kind.name, recipe: (kind.read)(table)? };
    Ok(CameraSpec { kind, t_range: table.or("t_range", [0.0, f64::INFINITY], read_t_range)? })
}

fn unknown_kind(field: &Field, kind: &str, names: &[&str]) -> Error {
    let near = nearest(kind, names).unwrap_or_default();
    let known = names.join(", ");
    field.error(format_args!("unknown camera kind {}; nearest known: {near:?} (known: {known})", quote(kind)))
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

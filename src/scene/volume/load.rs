//! The numbers of a volume, from files.

use super::header::read_headed;
use super::spec::{GridSource, GridSpec, Placement, VALUE_MAX};
use super::{Grid, SIDE_MAX, placed};
use crate::arrays::MapEach;
use crate::geometry::place::rotation_xyz;
use crate::image::{NumberType, read_npy_volume};
use crate::input::{Error, Limits, Loading, Result};
use glam::DVec3;
use std::io::Read;
use std::path::Path;

/// The numbers of a file.
pub struct Numbers {
    /// How many along z, y and x.
    pub shape: [u64; 3],
    /// x fastest.
    pub values: Vec<f32>,
    /// Where they lie, if the file says so.
    pub placement: Option<Placement>,
}

/// The endings of files that say themselves what they hold.
pub const DESCRIBED: [&str; 5] = ["npy", "nrrd", "nhdr", "mhd", "mha"];

/// Reads such a file.
///
/// # Errors
/// [`Error::Missing`] or [`Error::Read`] if it cannot be read; [`Error::Input`] naming it: another shape or type, or it ends early.
pub fn read_described(path: &Path, loading: &Loading) -> Result<Numbers> {
    if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("npy")) {
        let (shape, values) = read_npy_volume(path, SIDE_MAX, loading)?;
        return Ok(Numbers { shape, values, placement: None });
    }
    read_headed(path, loading)
}

/// The grid of a table. `given` are the numbers of [`GridSource::Given`]: how many along z, y and x, and they, x fastest.
///
/// # Errors
/// [`Error::Input`] naming the file, or "volume": another shape or type, too short or too long, or a number that is not finite.
pub fn load_grid(spec: &GridSpec, given: Option<([u64; 3], Vec<f32>)>, loading: &Loading) -> Result<Grid> {
    let of_shape = |(shape, values)| Numbers { shape, values, placement: None };
    let (name, numbers) = match &spec.source {
        GridSource::Described(path) => (path.display().to_string(), read_described(path, loading)?),
        GridSource::Raw(path, grid) => {
            (path.display().to_string(), of_shape((grid.shape, read_raw(path, grid, loading)?)))
        }
        GridSource::Given => ("volume".into(), of_shape(given.unwrap_or(([0; 3], Vec::new())))),
    };
    let Numbers { shape, values, placement: own } = numbers;
    let wrong = |why: String| Error::input(format!("{name}: {why}"));
    let [nz, ny, nx] = shape;
    if shape.iter().any(|n| !(2..=SIDE_MAX).contains(n)) || nz * ny * nx != values.len() as u64 {
        return Err(wrong(format!("the array's shape is {shape:?}; it must have three sides of 2 to {SIDE_MAX}")));
    }
    if let Some(at) = values.iter().position(|v| v.is_nan() || v.abs() > VALUE_MAX) {
        let [i, j, k] = [at as u64 % nx, at as u64 / nx % ny, at as u64 / nx / ny];
        let value = values[at];
        return Err(wrong(format!(
            "the number [{k}][{j}][{i}] is {value}; use numbers from -{VALUE_MAX} to {VALUE_MAX}"
        )));
    }
    let sides = [nx, ny, nz].map_each(|n| n as u32);
    let placement = spec.placement.or(own).ok_or_else(|| {
        wrong("the file does not say where its numbers lie along the world's axes; add min and max to [volume]".into())
    })?;
    let (first, spacing) = match placement {
        Placement::Box { min, max } => (min, (max - min) / DVec3::from(sides.map_each(|n| f64::from(n - 1)))),
        Placement::Nodes { origin, spacing } => (origin, spacing),
    };
    let to_world = placed(sides, first, spacing, rotation_xyz(spec.rotate));
    if !to_world.inverse().is_finite() {
        return Err(wrong("the volume is too small or too large to be placed".into()));
    }
    Ok(Grid { sides, values, to_world })
}

/// How numbers lie in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RawGrid {
    /// As NumPy has it: along z, y and x; 2 to [`SIDE_MAX`] each.
    pub shape: [u64; 3],
    pub number: NumberType,
    pub big_endian: bool,
}

impl RawGrid {
    /// Of all its numbers.
    pub fn bytes(&self) -> u64 {
        self.shape.iter().product::<u64>() * self.number.size() as u64
    }
}

/// Reads a file of numbers alone. It must be as long as its shape says.
fn read_raw(path: &Path, grid: &RawGrid, loading: &Loading) -> Result<Vec<f32>> {
    let unreadable = |e: std::io::Error| Error::unreadable(path, format_args!("{e}; check the path"));
    let mut file = loading.open(path).map_err(unreadable)?;
    let has = file.metadata().map_err(unreadable)?.len();
    if has != grid.bytes() {
        let ([z, y, x], each) = (grid.shape, grid.number.size());
        return Err(Error::input(format!(
            "{}: the file has {has} bytes; {z} x {y} x {x} numbers of {each} are {}: check shape and type",
            path.display(),
            grid.bytes()
        )));
    }
    read_numbers(&mut file, grid, loading.limits()).map_err(|e| e.at(path.display()))
}

/// Refuses fewer bytes than the grid's numbers have.
pub(super) fn check_length(has: u64, grid: &RawGrid) -> Result<()> {
    let all = grid.bytes();
    if has < all {
        return Err(Error::input(format!("the file ends early: {has} bytes of numbers, {all} are promised")));
    }
    Ok(())
}

/// Reads as many numbers as the grid has, and nothing behind them.
pub(super) fn read_numbers(reader: &mut impl Read, grid: &RawGrid, limits: Limits) -> Result<Vec<f32>> {
    let RawGrid { number, big_endian, .. } = *grid;
    let count = grid.bytes() / number.size() as u64;
    limits.check_memory(grid.bytes() + 4 * count, format_args!("a volume of {count} numbers"), "use a coarser one")?;
    let mut bytes = Vec::new();
    reader.take(grid.bytes()).read_to_end(&mut bytes).map_err(|e| Error::input(format!("the numbers: {e}")))?;
    check_length(bytes.len() as u64, grid)?;
    Ok(bytes.chunks_exact(number.size()).map(|bytes| number.read(bytes, big_endian) as f32).collect())
}

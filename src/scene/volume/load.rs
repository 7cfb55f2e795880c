//! The numbers of a volume, from files.

use super::spec::{GridSource, GridSpec, Placement, RawNumber, VALUE_MAX};
use super::{Grid, SIDE_MAX, placed};
use crate::geometry::place::rotation_xyz;
use crate::image::read_npy_volume;
use crate::input::limits::memory;
use crate::input::{Error, Result, files};
use glam::DVec3;
use std::io::Read;
use std::path::Path;

/// The grid of a table. `given` are the numbers of [`GridSource::Given`]: how many along z, y and x, and they, x fastest.
///
/// # Errors
/// [`Error::Input`] naming the file, or "volume": another shape or type, too short or too long, or a number that is not finite.
pub fn load_grid(spec: &GridSpec, given: Option<([u64; 3], Vec<f32>)>) -> Result<Grid> {
    let (name, (shape, values)) = match &spec.source {
        GridSource::Npy(path) => (path.display().to_string(), read_npy_volume(path, SIDE_MAX)?),
        GridSource::Raw { file, shape, number, big_endian } => {
            let shape = shape.map(u64::from);
            (file.display().to_string(), (shape, read_raw(file, shape, *number, *big_endian)?))
        }
        GridSource::Given => ("volume".into(), given.unwrap_or(([0; 3], Vec::new()))),
    };
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
    let sides = [nx, ny, nz].map(|n| n as u32);
    let (first, spacing) = match spec.placement {
        Placement::Box { min, max } => (min, (max - min) / DVec3::from(sides.map(|n| f64::from(n - 1)))),
        Placement::Nodes { origin, spacing } => (origin, spacing),
    };
    let to_world = placed(sides, first, spacing, rotation_xyz(spec.rotate));
    if !to_world.inverse().is_finite() {
        return Err(wrong("the volume is too small or too large to be placed".into()));
    }
    Ok(Grid { sides, values, to_world })
}

/// Reads a file of numbers alone. It must be as long as its shape says.
fn read_raw(path: &Path, shape: [u64; 3], number: RawNumber, big_endian: bool) -> Result<Vec<f32>> {
    let unreadable = |e: std::io::Error| Error::unreadable(path, format_args!("{e}; check the path"));
    let mut file = files::open(path).map_err(unreadable)?;
    let each = match number {
        RawNumber::F32 => 4,
        RawNumber::U8 => 1,
        RawNumber::U16 => 2,
    };
    // sides of at most 2^12 each
    let count: u64 = shape.iter().product();
    let has = file.metadata().map_err(unreadable)?.len();
    if has != count * each {
        let [z, y, x] = shape;
        return Err(Error::input(format!(
            "{}: the file has {has} bytes; {z} x {y} x {x} numbers of {each} are {}: check shape and type",
            path.display(),
            count * each
        )));
    }
    memory::check(count * (4 + each), format_args!("a volume of {count} numbers"), "use a coarser one")?;
    let mut bytes = Vec::new();
    file.read_to_end(&mut bytes).map_err(unreadable)?;
    let two = |b: &[u8]| if big_endian { u16::from_be_bytes([b[0], b[1]]) } else { u16::from_le_bytes([b[0], b[1]]) };
    let four = |b: &[u8]| {
        let b = [b[0], b[1], b[2], b[3]];
        if big_endian { f32::from_be_bytes(b) } else { f32::from_le_bytes(b) }
    };
    Ok(match number {
        RawNumber::F32 => bytes.chunks_exact(4).map(four).collect(),
        RawNumber::U8 => bytes.iter().map(|b| f32::from(*b)).collect(),
        RawNumber::U16 => bytes.chunks_exact(2).map(|b| f32::from(two(b))).collect(),
    })
}

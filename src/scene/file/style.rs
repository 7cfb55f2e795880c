//! `[style]`: lines and strokes, and the patterns of meshes.

use crate::input::Result;
use crate::input::reader::Field;
use crate::scene::style::{Hatching, Line, Outline, Style};

/// Pixels that a line may be wide.
const WIDTH_MAX: f64 = 32.0;

pub fn read_style(field: &Field) -> Result<Style> {
    let table = field.table()?;
    table.allow(&["wireframe", "outline", "borders", "hatching"])?;
    Ok(Style {
        wireframe: table.optional("wireframe", |f| read_line(f, &["width", "color", "depth"]))?,
        outline: table.optional("outline", read_outline)?,
        borders: table.optional("borders", |f| read_line(f, &["width", "color"]))?,
        hatching: table.optional("hatching", read_hatching)?,
    })
}

/// A table, or its width alone.
fn read_line(field: &Field, keys: &[&str]) -> Result<Line> {
    let black = Line { width: 1.0, colour: [0.0; 3], depth: f64::INFINITY };
    if !field.is_table() {
        return Ok(Line { width: read_width(field)?, ..black });
    }
    let table = field.table()?;
    table.allow(keys)?;
    Ok(Line {
        width: table.or("width", black.width, read_width)?,
        colour: table.or("color", black.colour, Field::color)?,
        depth: table.or("depth", black.depth, Field::above_zero)?,
    })
}

fn read_outline(field: &Field) -> Result<Outline> {
    let line = read_line(field, &["width", "color", "depth", "crease"])?;
    let wrong = "is no angle between normals; use 0 to 180 degrees";
    let crease = |f: &Field| f.number_if(|angle| (0.0..=180.0).contains(&angle), wrong);
    let given = if field.is_table() { field.table()?.optional("crease", crease)? } else { None };
    Ok(Outline { line, crease: given.unwrap_or(40.0) })
}

/// A table, or its spacing alone.
fn read_hatching(field: &Field) -> Result<Hatching> {
    let plain = Hatching { spacing: 6.0, ink: [0.0; 3], paper: [1.0; 3] };
    if !field.is_table() {
        return Ok(Hatching { spacing: field.above_zero()?, ..plain });
    }
    let table = field.table()?;
    table.allow(&["spacing", "color", "paper"])?;
    Ok(Hatching {
        spacing: table.or("spacing", plain.spacing, Field::above_zero)?,
        ink: table.or("color", plain.ink, Field::color)?,
        paper: table.or("paper", plain.paper, Field::color)?,
    })
}

fn read_width(field: &Field) -> Result<f64> {
    let wrong = format_args!("is no width; use pixels above 0, {WIDTH_MAX} at most");
    field.number_if(|width| width > 0.0 && width <= WIDTH_MAX, wrong)
}

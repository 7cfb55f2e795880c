//! `camera_texture`: a perspective view deformed by a grid of offsets (Lorenz and Doellner 2009, section 3.2).

mod bilinear;

use super::pinhole;
use super::strips::central;
use super::{POSE, Pose};
use crate::arrays::MapEach;
use crate::camera::Rays;
use crate::camera::bundle::Bundle;
use crate::camera::pieces::{Piece, Pieces, side};
use crate::camera::recipe::{Built, Recipe, Setting};
use crate::camera::tessellate::{KEYS, Tessellation};
use crate::camera::values::word;
use crate::image::read_pairs;
use crate::input::limits::CELLS;
use crate::input::reader::{Field, Table};
use crate::input::{Error, Result};
use bilinear::Inverse;
use glam::{DVec2, DVec3};
use std::sync::Arc;

#[derive(Debug, PartialEq)]
struct CameraTexture {
    pose: Pose,
    vfov: f64,
    grid: Offsets,
    scale: f64,
    /// Each cell is a bilinear map instead of two affine ones.
    bilinear: bool,
    tessellation: Tessellation,
}

/// Offsets at the crossings of a grid that spans the image, corner to corner, row by row from the top; image coordinates.
#[derive(Debug, Clone, PartialEq)]
struct Offsets {
    columns: u32,
    rows: u32,
    at: Vec<DVec2>,
}

pub fn read(table: &Table) -> Result<Arc<dyn Recipe>> {
    let own = ["vfov", "file", "offsets", "scale", "mode"];
    table.allow(&[&["kind", "t_range"], &POSE[..], &own, &KEYS].concat())?;
    let modes = [("affine", false), ("bilinear", true)];
    let bilinear = table.or("mode", false, |field| word(field, &modes, "use \"affine\" or \"bilinear\""))?;
    if let (Some(pieces), false) = (table.get("pieces"), bilinear) {
        return Err(pieces.error("the affine mode has pieces of its own; leave this out or use mode = \"bilinear\""));
    }
    Ok(Arc::new(CameraTexture {
        pose: Pose::read(table)?,
        vfov: table.need("vfov", "40")?.number()?,
        grid: read_offsets(table)?,
        scale: table.or("scale", 1.0, Field::number)?,
        bilinear,
        tessellation: Tessellation::read(table)?,
    }))
}

fn read_offsets(table: &Table) -> Result<Offsets> {
    let (field, grid) = match (table.get("file"), table.get("offsets")) {
        (Some(file), None) => {
            let (columns, rows, at) = read_pairs(&file.path()?, file.loading())?;
            (file, Offsets { columns, rows, at })
        }
        (None, Some(offsets)) => {
            let grid = read_inline(&offsets)?;
            (offsets, grid)
        }
        _ => return Err(table.error("give either file = \"offsets.npy\" or offsets = [[[0, 0], ...], ...]")),
    };
    let size = format!("{} x {} offsets", grid.columns, grid.rows);
    if grid.columns < 2 || grid.rows < 2 {
        return Err(field.error(format_args!("{size} make no cell; give at least 2 x 2")));
    }
    let size = format!("{} x {}", grid.columns - 1, grid.rows - 1);
    field.limits().check_as(CELLS, grid.at.len() as u64, size).map_err(|e| field.error(e))?;
    if grid.at.iter().any(|o| !o.is_finite()) {
        return Err(field.error("an offset is not finite; use finite numbers"));
    }
    Ok(grid)
}

fn read_inline(field: &Field) -> Result<Offsets> {
    let mut grid = Offsets { columns: 0, rows: 0, at: Vec::new() };
    for row in field.items("rows of offsets, as [[[0, 0], [0, 0]], [[0, 0], [0, 0]]]")? {
        let before = grid.at.len();
        for offset in row.items("a row of offsets, as [[0, 0], [0, 0]]")? {
            grid.at.push(DVec2::from(offset.numbers::<2>("an offset, as [right, down]")?));
        }
        let columns = (grid.at.len() - before) as u32;
        if grid.rows > 0 && columns != grid.columns {
            return Err(row.error(format_args!("{columns} offsets; the rows before have {}", grid.columns)));
        }
        (grid.columns, grid.rows) = (columns, grid.rows + 1);
    }
    Ok(grid)
}

impl Recipe for CameraTexture {
    fn build(&self, setting: &Setting) -> Result<Built> {
        let (w, h) = setting.size()?;
        let base = Base { bundle: pinhole::bundle(&self.pose, self.vfov, h)?, size: DVec2::new(w.into(), h.into()) };
        let cells = self.cells();
        if !self.bilinear {
            return affine(&cells, &base, self.pose.eye, (w, h));
        }
        let inverse = Inverse::new(cells, base);
        let (folded, all) = (inverse.folded(), inverse.len());
        let built = self.tessellation.build(Arc::new(inverse), setting)?;
        Ok(Built { notes: fold_notes(folded, all, "cells").into(), ..built })
    }
}

impl CameraTexture {
    /// Every cell's corners in image coordinates, row by row.
    fn cells(&self) -> Vec<Cell> {
        let Offsets { columns, rows, at } = &self.grid;
        let steps = DVec2::new(f64::from(columns - 1), f64::from(rows - 1));
        let cell = |i: u32, j: u32| {
            let from = [(i, j), (i + 1, j), (i, j + 1), (i + 1, j + 1)];
            let place = from.map_each(|(i, j)| DVec2::new(i.into(), j.into()) / steps);
            let offset = from.map_each(|(i, j)| at[(j * columns + i) as usize]);
            Cell { from: place, to: std::array::from_fn(|k| place[k] + self.scale * offset[k]) }
        };
        (0..rows - 1).flat_map(|j| (0..columns - 1).map(move |i| (i, j))).map(|(i, j)| cell(i, j)).collect()
    }
}

/// A cell of the grid by its corners top left, top right, bottom left, bottom right, in image coordinates.
#[derive(Debug, Clone, Copy)]
struct Cell {
    /// In the undeformed view.
    from: [DVec2; 4],
    /// Where they are displaced to.
    to: [DVec2; 4],
}

/// The undeformed view.
#[derive(Debug)]
struct Base {
    bundle: Bundle,
    /// Of the image, px.
    size: DVec2,
}

impl Base {
    /// The direction at image coordinates.
    fn direction(&self, place: DVec2) -> DVec3 {
        let from_middle = (place - 0.5) * self.size;
        self.bundle.ray(from_middle.x, from_middle.y).direction
    }
}

/// Two pieces a cell, cut from its upper right to its lower left corner, each where it is displaced to.
fn affine(cells: &[Cell], base: &Base, eye: DVec3, (w, h): (u32, u32)) -> Result<Built> {
    let triangles =
        cells.iter().flat_map(|cell| [[0, 1, 2], [3, 2, 1]].map_each(|t| t.map_each(|k| (cell.from[k], cell.to[k]))));
    let (mut pieces, mut folded): (Vec<Piece>, usize) = (Vec::new(), 0);
    for triangle in triangles {
        let corners = triangle.map_each(|(_, to)| to * base.size);
        let area = side(corners[0], corners[1], corners[2]);
        // undisplaced, both go round the way in which the sign is positive
        folded += usize::from(area <= 0.0);
        if area != 0.0 {
            pieces.push(central(eye, corners, triangle.map_each(|(from, _)| base.direction(from))));
        }
    }
    if pieces.is_empty() {
        return Err(Error::input(
            "camera.offsets: every cell is displaced to a line or a point; change the offsets or scale",
        ));
    }
    let built = Built::new((w, h), Rays::Pieces(Pieces::new(pieces, w, h)));
    Ok(Built { notes: fold_notes(folded, 2 * cells.len(), "pieces").into(), ..built })
}

fn fold_notes(folded: usize, all: usize, what: &str) -> Vec<String> {
    let note = format!(
        "{folded} of {all} {what} are folded over or have no area; where {what} overlap the lowest-numbered shows"
    );
    if folded == 0 { Vec::new() } else { vec![note] }
}

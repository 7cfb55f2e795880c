//! Height images as terrain: ESRI ASCII grids, gray PNGs and GeoTIFFs.
//!
//! Each sample becomes a vertex, with +x to the east, +y up and +z to the south. The centre of the grid is at x = z = 0, because
//! coordinates of some millions, as eastings and northings are, would lose digits.

mod asc;
mod geotiff;

use super::mesh::{MAX_TRIANGLES, Material, Mesh, check_memory};
use crate::arrays::MapEach;
use crate::input::{Error, Limits, Loading, Result};
use crate::parallel;
use glam::{DVec2, DVec3, Vec2, Vec3};
use image::{DynamicImage, ImageReader};
use std::io::Cursor;
use std::path::{Path, PathBuf};

/// A height image and how it becomes triangles.
#[derive(Debug, Clone, PartialEq)]
pub struct HeightSpec {
    /// Already relative to the working directory.
    pub file: PathBuf,
    /// World units per unit of the samples.
    pub height_scale: f64,
    /// Distance of samples along x and z in world units; `None`: that of the file, or 1.
    pub cell: Option<DVec2>,
}

/// A grid of heights, row 0 in the north, and its place on the map.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    pub columns: usize,
    pub rows: usize,
    /// Row by row from the west; NaN: no data.
    pub samples: Vec<f64>,
    pub georeference: Option<Georeference>,
}

/// The place of a grid on the map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Georeference {
    /// Distance of samples to the east and to the south; both positive.
    pub cell: DVec2,
    /// Easting and northing of the centre of the grid.
    pub middle: DVec2,
    /// `cell` and `middle` are in degrees.
    pub in_degrees: bool,
}

/// Length of a degree on a sphere with the Earth's volume.
const METRES_A_DEGREE: f64 = 6_371_000.8 * std::f64::consts::PI / 180.0;

impl Georeference {
    /// The approximate size of a cell in metres, if `cell` is in degrees.
    pub fn cell_in_metres(&self) -> DVec2 {
        self.cell * METRES_A_DEGREE * DVec2::new(self.middle.y.to_radians().cos(), 1.0)
    }

    /// The unit may be degrees: ASCII grids do not say. A guess, which can be wrong for a small local map.
    #[cfg(feature = "cli")]
    pub fn may_be_degrees(&self) -> bool {
        self.in_degrees || self.middle.x.abs() <= 360.0 && self.middle.y.abs() <= 90.0 && self.cell.max_element() < 0.1
    }
}

/// Marks a sample without data, which has no vertex.
const NO_VERTEX: u32 = u32::MAX;

/// Whether the file has an extension that [`read`] knows.
pub fn is_height_image(path: &Path) -> bool {
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    matches!(extension.as_str(), "asc" | "png" | "tif" | "tiff")
}

/// The samples of a file.
///
/// # Errors
/// [`Error::Missing`] or [`Error::Read`] if the file cannot be read; [`Error::Input`] naming it: it is damaged, is no height image, or is too large.
pub fn read(path: &Path, loading: &Loading) -> Result<Grid> {
    let unreadable = |e| Error::unreadable(path, format_args!("{e}; check the path"));
    let wrong = |why| Error::input(format!("{}: {why}", path.display()));
    let start = loading.prefix(path).map_err(unreadable)?;
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    let may_be_grid = match extension.as_str() {
        "asc" => !start.has_zero() && asc::check_start(start.bytes(), start.length()).map(|()| true).map_err(wrong)?,
        "png" => start.bytes().starts_with(b"\x89PNG"),
        // TIFF and BigTIFF
        _ => matches!(start.bytes(), [b'I', b'I', b'*' | b'+', 0, ..] | [b'M', b'M', 0, b'*' | b'+', ..]),
    };
    let bytes = start.read_if(may_be_grid).map_err(unreadable)?;
    let grid = match extension.as_str() {
        "asc" => asc::read(&bytes),
        "png" => read_png(&bytes),
        _ => geotiff::read(&bytes),
    };
    grid.map_err(wrong)
}

/// The triangles of a height image.
///
/// # Errors
/// Those of [`read`] and [`mesh`].
pub fn load(spec: &HeightSpec, loading: &Loading) -> Result<Mesh> {
    mesh(&read(&spec.file, loading)?, spec, loading.limits())
}

/// Two triangles for each cell between four samples, row by row from the north-west, facing up. Triangles with a corner without data are
/// left out. Normals are central differences. Texture coordinates put the centre of a texel on each sample, for an image as large as the
/// grid.
///
/// # Errors
/// [`Error::Input`] if the cells are in degrees and `spec` has no `cell`, or no triangle is left; [`Error::Work`] if the mesh does not fit
/// the free memory.
pub fn mesh(grid: &Grid, spec: &HeightSpec, limits: Limits) -> Result<Mesh> {
    let wrong = |why: String| Error::input(format!("{}: {why}", spec.file.display()));
    let cell = match (spec.cell, grid.georeference) {
        (Some(cell), _) => cell,
        (None, Some(place)) if place.in_degrees => {
            let ([x, y], [mx, my]) = (place.cell.to_array(), place.cell_in_metres().to_array());
            return Err(wrong(format!(
                "its cells are {x} x {y} degrees; add their size to the mesh, in metres: cell = [{mx:.3}, {my:.3}]"
            )));
        }
        (None, Some(place)) => place.cell,
        (None, None) => DVec2::ONE,
    };
    let (columns, rows) = (grid.columns, grid.rows);
    let triangles = 2 * (columns as u64 - 1) * (rows as u64 - 1);
    let what = format_args!("terrain of {columns} x {rows} heights");
    check_memory(limits, (triangles, (columns * rows) as u64), what, "resample it more coarsely")?;
    let terrain = Terrain { grid, cell, scale: spec.height_scale };
    // the samples with data, and the vertex of each sample
    let valid: Vec<u32> = (0..columns * rows).filter(|&k| grid.samples[k].is_finite()).map(|k| k as u32).collect();
    let mut vertex_of = vec![NO_VERTEX; columns * rows];
    valid.iter().enumerate().for_each(|(vertex, &k)| vertex_of[k as usize] = vertex as u32);
    let in_row = |row: usize| {
        let cells = (0..columns - 1).flat_map(move |column| {
            let a = row * columns + column;
            [[a, a + columns, a + columns + 1], [a, a + columns + 1, a + 1]]
        });
        let complete = cells.map(|t| t.map_each(|k| vertex_of[k])).filter(|t| !t.contains(&NO_VERTEX));
        complete.collect::<Vec<[u32; 3]>>()
    };
    let triangles: Vec<[u32; 3]> = parallel::flat_map(0..rows - 1, in_row);
    if triangles.is_empty() {
        return Err(wrong("no cell has heights at three corners, so there is no surface".into()));
    }
    let at = |k: &u32| (*k as usize % columns, *k as usize / columns);
    Ok(Mesh {
        positions: parallel::map(&valid, |k| terrain.position(at(k))),
        normals: parallel::map(&valid, |k| terrain.normal(at(k))),
        uvs: parallel::map(&valid, |k| terrain.uv(at(k))),
        corner_normals: triangles.clone(),
        corner_uvs: triangles.clone(),
        material_of: vec![0; triangles.len()],
        materials: vec![Material::default()],
        triangles,
        ..Mesh::default()
    })
}

/// A grid with the scales of its mesh.
struct Terrain<'a> {
    grid: &'a Grid,
    cell: DVec2,
    scale: f64,
}

impl Terrain<'_> {
    fn height(&self, column: usize, row: usize) -> f64 {
        self.scale * self.grid.samples[row * self.grid.columns + column]
    }

    fn position(&self, (column, row): (usize, usize)) -> DVec3 {
        let from_middle = |k: usize, n: usize| k as f64 - (n - 1) as f64 / 2.0;
        let x = self.cell.x * from_middle(column, self.grid.columns);
        DVec3::new(x, self.height(column, row), self.cell.y * from_middle(row, self.grid.rows))
    }

    /// From central differences; one-sided where a neighbour is missing.
    fn normal(&self, (column, row): (usize, usize)) -> Vec3 {
        let Grid { columns, rows, .. } = *self.grid;
        let here = self.height(column, row);
        let slope = |before: Option<f64>, after: Option<f64>, cell: f64| {
            let [before, after] = [before, after].map_each(|h| h.filter(|h| h.is_finite()));
            let steps = usize::from(before.is_some()) + usize::from(after.is_some());
            (after.unwrap_or(here) - before.unwrap_or(here)) / (steps.max(1) as f64 * cell)
        };
        let west = (column > 0).then(|| self.height(column - 1, row));
        let east = (column + 1 < columns).then(|| self.height(column + 1, row));
        let north = (row > 0).then(|| self.height(column, row - 1));
        let south = (row + 1 < rows).then(|| self.height(column, row + 1));
        let up = DVec3::new(-slope(west, east, self.cell.x), 1.0, -slope(north, south, self.cell.y));
        // scaled first, as squares of steep slopes may overflow
        (up / up.abs().max_element()).normalize_or(DVec3::Y).as_vec3()
    }

    fn uv(&self, (column, row): (usize, usize)) -> Vec2 {
        let place = |k: usize, n: usize| (k as f64 + 0.5) / n as f64;
        Vec2::new(place(column, self.grid.columns) as f32, 1.0 - place(row, self.grid.rows) as f32)
    }
}

/// # Errors
/// The grid has no cell, or too many.
fn check_sides(columns: u64, rows: u64) -> std::result::Result<(), String> {
    if columns < 2 || rows < 2 {
        return Err(format!("{columns} x {rows} heights make no cell; at least 2 x 2 are needed"));
    }
    match (columns - 1).checked_mul(rows - 1).and_then(|cells| cells.checked_mul(2)) {
        Some(triangles) if triangles <= MAX_TRIANGLES as u64 => Ok(()),
        _ => Err(format!(
            "{columns} x {rows} heights make over 2^28 triangles, the most of a scene; resample it more coarsely"
        )),
    }
}

/// A gray PNG of 8 or 16 bits. Fully transparent samples have no data.
fn read_png(bytes: &[u8]) -> std::result::Result<Grid, String> {
    let wrong = |e: &dyn std::fmt::Display| format!("is no PNG that can be read: {e}");
    let mut header = png::Decoder::new(Cursor::new(bytes));
    let header = header.read_header_info().map_err(|e| wrong(&e))?;
    let (columns, rows) = header.size();
    check_sides(columns.into(), rows.into())?;
    // decoding would scale these to 8 bits
    if (header.bit_depth as u8) < 8 {
        return Err("has fewer than 8 bits a sample; a height image is a gray PNG of 8 or 16 bits".into());
    }
    let image = ImageReader::with_format(Cursor::new(bytes), image::ImageFormat::Png).decode();
    let samples: Vec<f64> = match image.map_err(|e| wrong(&e))? {
        DynamicImage::ImageLuma8(image) => image.into_raw().into_iter().map(f64::from).collect(),
        DynamicImage::ImageLuma16(image) => image.into_raw().into_iter().map(f64::from).collect(),
        DynamicImage::ImageLumaA8(image) => {
            image.pixels().map(|p| unless_transparent(p.0[0].into(), p.0[1].into())).collect()
        }
        DynamicImage::ImageLumaA16(image) => {
            image.pixels().map(|p| unless_transparent(p.0[0].into(), p.0[1].into())).collect()
        }
        _ => return Err("is in colour; a height image is a gray PNG of 8 or 16 bits".into()),
    };
    Ok(Grid { columns: columns as usize, rows: rows as usize, samples, georeference: None })
}

fn unless_transparent(height: f64, alpha: f64) -> f64 {
    if alpha > 0.0 { height } else { f64::NAN }
}

#[cfg(test)]
mod tests;

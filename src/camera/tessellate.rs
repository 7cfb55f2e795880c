//! Tessellation of a ray field into bilinear pieces: `pieces = "exact"`, a number, or `"auto"` with an error in pixels.
//!
//! A piece is an image triangle whose corners have the map's own rays; P and D are affine between them, so pieces that share an
//! edge share its rays. The bound in the notes comes from [`bound`]: the largest image distance, in pixels, between a
//! place of the piece and the position at which the exact camera sees a point of that place's ray, over the t range of the scene.

pub mod bend;
mod bound;
mod grid;
mod refine;

use super::Rays;
use super::field::{Field, RayMap};
use super::notes::Notes;
use super::pieces::Pieces;
use super::recipe::{Built, Setting};
use crate::camera::values::number_if;
use crate::input::limits::PIECES;
use crate::input::reader::Table;
use crate::input::{Error, Result};
use crate::parallel;
use bound::{Judge, Verdict};
use glam::DVec2;
use grid::Cells;
use std::sync::Arc;

/// The keys that a kind with tessellation allows besides its own.
pub const KEYS: [&str; 2] = ["pieces", "error"];

/// Default error of `"auto"`, px.
const ERROR_PX: f64 = 0.25;

/// How a ray field is tessellated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Tessellation {
    /// Every pixel has the formula's own ray.
    Exact,
    /// This many strips of two image triangles if the rays bend only along one axis of the image; else about this many
    /// triangles in equal cells, as square as possible.
    Count(u32),
    /// As many pieces as needed for this error, px.
    Auto { error_px: f64 },
}

impl Tessellation {
    /// Reads [`KEYS`]; exact where they are absent.
    pub fn read(table: &Table) -> Result<Tessellation> {
        let error_px = table.optional("error", |field| {
            number_if(field, |error| error > 0.0, "is no error in pixels; give one above 0, as 0.25")
        })?;
        let tessellation = match table.get("pieces") {
            None => Tessellation::Exact,
            Some(field) => match field.text() {
                Ok("exact") => Tessellation::Exact,
                Ok("auto") => Tessellation::Auto { error_px: error_px.unwrap_or(ERROR_PX) },
                Ok(_) => return Err(field.error("is \"exact\", \"auto\" or a number of pieces")),
                Err(_) => {
                    // pieces, and up to twice as many triangles during refinement, have 32-bit numbers
                    let pieces = field.integer(1, 1 << 30)?;
                    field.limits().check(PIECES, pieces).map_err(|e| field.error(e))?;
                    Tessellation::Count(pieces as u32)
                }
            },
        };
        match table.get("error") {
            Some(field) if !matches!(tessellation, Tessellation::Auto { .. }) => {
                Err(field.error("goes with pieces = \"auto\"; leave it out"))
            }
            _ => Ok(tessellation),
        }
    }

    /// The camera of a formula's rays over the setting's image.
    ///
    /// # Errors
    /// [`Error::Input`] if no pixel, or no corner of a piece, has a ray.
    pub fn build(self, map: Arc<dyn RayMap>, setting: &Setting) -> Result<Built> {
        let size = setting.size()?;
        if self == Tessellation::Exact {
            return Ok(Built::new(size, Rays::Field(Field::of_map(size.0, size.1, map)?)));
        }
        let judge = Judge::new(map, setting, size);
        let (pieces, notes) = match self {
            Tessellation::Auto { error_px } => {
                let cells = refine::refine(&judge, error_px);
                (Pieces::new(cells.pieces(), size.0, size.1), notes(&cells, self).into())
            }
            Tessellation::Count(n) => {
                let viewer = judge.map.viewer();
                let cells = match &viewer {
                    Some(viewer) => grid::of_count(&Judge::new(Arc::new(viewer.unturned()), setting, size), n),
                    None => grid::of_count(&judge, n),
                };
                let pieces = match &viewer {
                    Some(viewer) => Pieces::turned_by(viewer.view, viewer.eye, cells.pieces(), size),
                    None => Pieces::new(cells.pieces(), size.0, size.1),
                };
                // the bound on the error takes more time than the pieces
                let notes = Notes::later(move || {
                    let rays = cells.places.iter().map(|place| judge.ray(*place)).collect();
                    notes(&judged(&judge, Cells { rays, ..cells }), self)
                });
                (pieces, notes)
            }
            Tessellation::Exact => unreachable!("built above"),
        };
        if pieces.pieces.is_empty() {
            return Err(Error::input(
                "camera.pieces: no piece has a ray at each of its corners; use more, or \"exact\"",
            ));
        }
        Ok(Built { notes, ..Built::new(size, Rays::Pieces(pieces)) })
    }
}

/// Most cells that are judged one by one; more are judged in groups of neighbours.
const JUDGED_MAX: usize = 1 << 13;

/// The cells with their verdicts. Of many cells, those of a group share the bound over the group, which holds for each.
fn judged(judge: &Judge, mut cells: Cells) -> Cells {
    let (columns, rows) = cells.size;
    let (mut wide, mut high) = (1, 1);
    while columns.div_ceil(wide) * rows.div_ceil(high) > JUDGED_MAX {
        if columns.div_ceil(wide) >= rows.div_ceil(high) { wide *= 2 } else { high *= 2 }
    }
    if wide * high == 1 {
        cells.verdicts = parallel::map(&cells.triangles, |t| cells.judge(judge, t));
        return cells;
    }
    let groups = (columns.div_ceil(wide), rows.div_ceil(high));
    let of_group = |k: usize| cells.judge_group(judge, (k % groups.0 * wide, k / groups.0 * high), (wide, high));
    let verdicts: Vec<Verdict> = parallel::map(0..groups.0 * groups.1, of_group);
    let of_triangle = |k: usize| {
        let (i, j) = (k / 2 % columns, k / 2 / columns);
        let has_rays = cells.triangles[k].iter().all(|&c| cells.rays[c as usize].is_some());
        if has_rays { verdicts[j / high * groups.0 + i / wide] } else { Verdict::RIM }
    };
    cells.verdicts = (0..cells.triangles.len()).map(of_triangle).collect();
    cells
}

/// Notes for the user: piece count, error bound, and pieces without a bound.
fn notes(cells: &Cells, tessellation: Tessellation) -> Vec<String> {
    let error_px = if let Tessellation::Auto { error_px } = tessellation { error_px } else { f64::INFINITY };
    // pieces of the smallest size that still exceed the error
    let is_jump = |corners: &[DVec2; 3], v: &Verdict| {
        let extent = corners[0].max(corners[1]).max(corners[2]) - corners[0].min(corners[1]).min(corners[2]);
        !v.rim && (v.error_px.is_infinite() || v.error_px > error_px && extent.min_element() <= refine::PIECE_MIN_PX)
    };
    let pieces: Vec<(bool, Verdict)> = cells.verdicts().map(|(q, v)| (is_jump(&q, &v), v)).collect();
    let bound = pieces.iter().filter(|(jump, v)| !jump && !v.rim).fold(0f64, |m, (_, v)| m.max(v.error_px));
    // rounded up
    let shown = if bound < 0.01 { format!("{:.2e}", 1.005 * bound) } else { format!("{}", (1e3 * bound).ceil() / 1e3) };
    let bounded = pieces.iter().any(|(jump, v)| !jump && !v.rim);
    let error = if bounded { format!("image error at most {shown} px") } else { "no bound on the image error".into() };
    let mut notes = vec![format!("{} pieces, {error}", pieces.len())];
    if bound > error_px {
        notes.push(format!(
            "the error asked for, {error_px} px, is not met: {} pieces are the most there are",
            PIECES.most
        ));
    }
    let count = |what: fn(&(bool, Verdict)) -> bool| pieces.iter().filter(|p| what(p)).count();
    let jumps = "of them have no such bound: the rays jump there, or bend too much over a piece";
    let folds = "of them have a focus or fold in range; near it, where a pixel is narrower than 1/16 of its ray's widest, the bound \
                 does not hold";
    for (n, text) in [
        (count(|p| p.0), jumps),
        (count(|p| p.1.rim), "of them lie at the rim of the rays and have no such bound"),
        (count(|p| p.1.fold), folds),
        (cells.triangles.len() - pieces.len(), "more were left out: a corner has no ray"),
    ] {
        if n > 0 {
            notes.push(format!("{n} {text}"));
        }
    }
    notes
}

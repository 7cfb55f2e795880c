//! How finely a ray field is cut into bilinear pieces: `pieces = "exact"`, a number, or `"auto"` with an error in pixels.

use super::Rays;
use super::field::{Field, RayMap};
use super::recipe::{Built, Setting};
use crate::error::Result;
use crate::scene::file::reader::Table;
use std::sync::Arc;

/// The keys that a kind whose rays may be cut allows besides its own.
pub const KEYS: [&str; 2] = ["pieces", "error"];

/// What to do with a ray field.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Cut {
    /// Every pixel has the formula's own ray.
    Exact,
    /// About this many pieces.
    Count(u32),
    /// As many pieces as the error, in pixels, needs.
    Auto { error_px: f64 },
}

impl Cut {
    /// Reads [`KEYS`]; exact where they are absent.
    pub fn read(table: &Table) -> Result<Cut> {
        let Some(pieces) = table.get("pieces") else { return Ok(Cut::Exact) };
        match pieces.text() {
            Ok("exact") => Ok(Cut::Exact),
            _ => Err(pieces.error("only pieces = \"exact\" is available in this version")),
        }
    }

    /// The rays of a formula over the setting's image, cut as asked.
    pub fn build(self, map: Arc<dyn RayMap>, setting: &Setting) -> Result<Built> {
        let size = setting.size()?;
        Ok(Built::new(size, Rays::Field(Field::of_map(size.0, size.1, map)?)))
    }
}

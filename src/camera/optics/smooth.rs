//! Smooth surfaces, which rays intersect exactly, without facets.

use super::{Quadric, Torus, Wave};
use glam::DVec3;

#[derive(Debug, Clone, PartialEq)]
pub enum Smooth {
    Quadrics(Vec<Quadric>),
    Torus(Torus),
    Wave(Wave),
}

impl Smooth {
    /// Number of its parts; each has its own id.
    pub fn count(&self) -> usize {
        match self {
            Smooth::Quadrics(list) => list.len(),
            Smooth::Torus(_) | Smooth::Wave(_) => 1,
        }
    }

    /// Outward normal at `place` on a part, of any length.
    pub fn normal(&self, part: usize, place: DVec3) -> DVec3 {
        match self {
            Smooth::Quadrics(list) => list[part].normal(place),
            Smooth::Torus(torus) => torus.normal(place),
            Smooth::Wave(wave) => wave.normal(place),
        }
    }

    /// Its name in notes.
    pub fn name(&self) -> String {
        match self {
            Smooth::Quadrics(list) if list.len() == 1 => "1 quadric".into(),
            Smooth::Quadrics(list) => format!("{} quadrics", list.len()),
            Smooth::Torus(_) => "a torus".into(),
            Smooth::Wave(_) => "a wave".into(),
        }
    }
}

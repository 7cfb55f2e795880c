//! Surfaces that every ray meets where they are, not where facets are.

use super::{Quadric, Torus, Wave};
use glam::DVec3;

#[derive(Debug, Clone, PartialEq)]
pub enum Smooth {
    Quadrics(Vec<Quadric>),
    Torus(Torus),
    Wave(Wave),
}

impl Smooth {
    /// Its parts, each with an id of its own.
    pub fn count(&self) -> usize {
        match self {
            Smooth::Quadrics(list) => list.len(),
            Smooth::Torus(_) | Smooth::Wave(_) => 1,
        }
    }

    /// At `place` on a part, of any length; points out.
    pub fn normal(&self, part: usize, place: DVec3) -> DVec3 {
        match self {
            Smooth::Quadrics(list) => list[part].normal(place),
            Smooth::Torus(torus) => torus.normal(place),
            Smooth::Wave(wave) => wave.normal(place),
        }
    }

    /// In words, as notes give it.
    pub fn name(&self) -> String {
        match self {
            Smooth::Quadrics(list) if list.len() == 1 => "1 quadric".into(),
            Smooth::Quadrics(list) => format!("{} quadrics", list.len()),
            Smooth::Torus(_) => "a torus".into(),
            Smooth::Wave(_) => "a wave".into(),
        }
    }
}

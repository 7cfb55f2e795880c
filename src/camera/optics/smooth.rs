//! Smooth surfaces, which rays intersect exactly, without facets.

use super::{Quadric, Torus, Wave};
use crate::geometry::bvh::Aabb;
use glam::DVec3;

#[derive(Debug, Clone, PartialEq)]
pub enum Smooth {
    Quadrics(Vec<Quadric>),
    Torus(Torus),
    Wave(Wave),
}

impl Smooth {
    /// A box around it.
    pub fn bounds(&self) -> Aabb {
        let about = |centre: DVec3, half: DVec3| Aabb::around(&[centre - half, centre + half]);
        match self {
            Smooth::Quadrics(list) => {
                Aabb::around(&list.iter().map(Quadric::bounds).flat_map(|b| [b.lo, b.hi]).collect::<Vec<_>>())
            }
            Smooth::Torus(torus) => about(torus.centre, DVec3::splat(torus.size())),
            Smooth::Wave(wave) => {
                about(wave.centre, DVec3::new(wave.size / 2.0, wave.amplitude.abs(), wave.size / 2.0))
            }
        }
    }

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

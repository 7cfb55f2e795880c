//! Solid patterns: the colour of a surface is a function of its world position.

use crate::arrays::MapEach;
use crate::input::Result;
use crate::input::reader::Field;
use glam::{DVec3, IVec3};

/// A pattern between two colours.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pattern {
    pub kind: PatternKind,
    /// World units of a cell, of a grain, or between rings.
    pub size: f64,
    /// Linear RGB.
    pub light: [f32; 3],
    pub dark: [f32; 3],
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum PatternKind {
    /// Cubes.
    Checker = 1,
    /// Grains of noise over noise, each half as large.
    Stone,
    /// Rings about the y axis.
    Wood,
}

impl PatternKind {
    pub const ALL: [PatternKind; 3] = [PatternKind::Checker, PatternKind::Stone, PatternKind::Wood];

    /// The name in a scene file.
    pub fn name(self) -> &'static str {
        match self {
            PatternKind::Checker => "checker",
            PatternKind::Stone => "stone",
            PatternKind::Wood => "wood",
        }
    }
}

/// So that faces at round places are not between cells.
const CHECKER_OFFSET: f64 = 0.3717;

const STONE_OCTAVES: u32 = 5;

/// Of noises that hardly ever add up to more than one half over this.
const STONE_CONTRAST: f64 = 0.5;

impl Pattern {
    /// White and nearly black squares of a size, grey stone, or wood.
    pub fn new(kind: PatternKind, size: f64) -> Pattern {
        let (light, dark) = match kind {
            PatternKind::Checker => ([0.8; 3], [0.05; 3]),
            PatternKind::Stone => ([0.75, 0.73, 0.7], [0.18, 0.18, 0.2]),
            PatternKind::Wood => ([0.55, 0.3, 0.13], [0.2, 0.085, 0.03]),
        };
        Pattern { kind, size, light, dark }
    }

    /// Linear RGB at a place of the world.
    pub fn at(&self, p: DVec3) -> [f64; 3] {
        let p = p / self.size;
        let share = match self.kind {
            PatternKind::Checker => {
                let cell = (p + CHECKER_OFFSET).floor();
                let is_odd = (cell.x + cell.y + cell.z).rem_euclid(2.0) >= 1.0;
                if is_odd { 0.0 } else { 1.0 }
            }
            PatternKind::Stone => {
                let octave = |k: u32| {
                    let times = f64::from(1u32 << k);
                    noise(times * p + 17.0 * f64::from(k)) / times
                };
                (0.5 + STONE_CONTRAST * (0..STONE_OCTAVES).map(octave).sum::<f64>()).clamp(0.0, 1.0)
            }
            PatternKind::Wood => 0.5 + 0.5 * (std::f64::consts::TAU * rings(p)).cos(),
        };
        [0, 1, 2].map_each(|k| {
            let [light, dark] = [self.light[k], self.dark[k]].map_each(f64::from);
            dark + share * (light - dark)
        })
    }
}

/// How many rings of wood about the y axis a place is away from it.
fn rings(p: DVec3) -> f64 {
    p.x.hypot(p.z) + 0.4 * noise(DVec3::new(0.7, 0.15, 0.7) * p)
}

/// Values at whole places, cubic between them, within [-1, 1].
fn noise(p: DVec3) -> f64 {
    let whole = p.floor();
    let f = p - whole;
    let s = f * f * (3.0 - 2.0 * f);
    let corner = |x: i32, y: i32, z: i32| value(whole.as_ivec3().wrapping_add(IVec3::new(x, y, z)));
    let along = |y: i32, z: i32| corner(0, y, z) + s.x * (corner(1, y, z) - corner(0, y, z));
    let across = |z: i32| along(0, z) + s.y * (along(1, z) - along(0, z));
    across(0) + s.z * (across(1) - across(0))
}

fn value(at: IVec3) -> f64 {
    let by = |v: i32, factor: u32| (v as u32).wrapping_mul(factor);
    let mut h = by(at.x, 0x8da6_b343) ^ by(at.y, 0xd816_3841) ^ by(at.z, 0xcb1a_b31f);
    h = (h ^ (h >> 16)).wrapping_mul(0x7feb_352d);
    h = (h ^ (h >> 15)).wrapping_mul(0x846c_a68b);
    h ^= h >> 16;
    f64::from(h >> 8) / 8_388_608.0 - 1.0
}

/// `{ kind, size, light, dark }`.
pub fn read_pattern(field: &Field) -> Result<Pattern> {
    let table = field.table()?;
    table.allow(&["kind", "size", "light", "dark"])?;
    let key = table.need("kind", "\"checker\"")?;
    let name = key.text()?;
    let known = || PatternKind::ALL.map_each(|k| format!("{:?}", k.name())).join(", ");
    let kind = PatternKind::ALL.into_iter().find(|k| k.name() == name);
    let kind = kind.ok_or_else(|| key.error(format_args!("{name:?} is no pattern; known: {}", known())))?;
    let plain = Pattern::new(kind, table.or("size", 1.0, Field::above_zero)?);
    Ok(Pattern {
        light: table.or("light", plain.light, Field::color)?,
        dark: table.or("dark", plain.dark, Field::color)?,
        ..plain
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patterns_stay_between_their_colours_and_show_both() {
        for kind in PatternKind::ALL {
            let pattern = Pattern { light: [1.0; 3], dark: [0.0; 3], ..Pattern::new(kind, 0.5) };
            let values: Vec<f64> = (0..20_000)
                .map(f64::from)
                .map(|k| pattern.at(DVec3::new((k * 0.377).sin(), (k * 0.217).cos(), (k * 0.913).sin()) * 20.0)[0])
                .collect();
            let mean = values.iter().sum::<f64>() / values.len() as f64;
            let [least, most] = [f64::min, f64::max].map(|f| values.iter().copied().reduce(f).unwrap());
            assert!(least >= 0.0 && most <= 1.0 && least < 0.25 && most > 0.75, "{kind:?}: {least} to {most}");
            assert!((mean - 0.5).abs() < 0.03, "{kind:?}: {mean}");
        }
    }

    #[test]
    fn checkers_are_cubes_and_do_not_end_on_round_places() {
        let pattern = Pattern { light: [1.0; 3], dark: [0.0; 3], ..Pattern::new(PatternKind::Checker, 2.0) };
        for y in [-4.0, 0.0, 2.0] {
            let p = DVec3::new(0.5, y, 0.5);
            assert_eq!(pattern.at(p - 1e-9), pattern.at(p + 1e-9));
            assert_ne!(pattern.at(p), pattern.at(p + 2.0 * DVec3::X));
            assert_eq!(pattern.at(p), pattern.at(p + 2.0 * DVec3::new(1.0, 0.0, 1.0)));
        }
    }
}

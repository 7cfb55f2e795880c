//! Built-in meshes, each a function of its parameters alone, with an exact number of triangles.

mod boxes;
mod city;
mod cylinder;
mod figures;
mod icosphere;
mod plane;
mod random;
mod soup;
mod stairs;
mod teapot;
mod terrain;
#[cfg(test)]
mod testing;

use crate::geometry::mesh::{MAX_TRIANGLES, Material, Mesh, check_memory};
use crate::input::{Error, Limits, Result};
use std::ops::RangeInclusive;

pub use boxes::cube;
pub use city::city;
pub use cylinder::cylinder;
pub use figures::{cow, walker};
pub use icosphere::icosphere;
pub use plane::plane;
pub use soup::soup;
pub use stairs::stairs;
pub use teapot::teapot;
pub use terrain::terrain;

/// 20 * 4^11 triangles are the most under 2^28.
const MAX_ICOSPHERE_LEVEL: u64 = 11;
/// A figure's parts have 20 * 4^level triangles each: under 2^28 for up to 50 parts.
const MAX_FIGURE_LEVEL: u64 = 9;
/// 4 sides - 4 triangles are under 2^27.
const MAX_SIDES: u64 = 1 << 25;
/// 12 triangles each: under 2^28.
const MAX_STEPS: u64 = 1 << 24;
/// 64 * 2048^2 = 2^28 triangles.
const MAX_TEAPOT_LEVEL: u64 = 2048;
/// 2 * 11585^2 triangles are the most under 2^28.
const MAX_CELLS: u64 = 11585;
/// Blocks of a city a side: their plan takes some hundred bytes each.
const MAX_BLOCKS: u64 = 1024;

/// A built-in mesh and its parameters. All stand with +y up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Builtin {
    /// [`teapot`]: 64 level^2 triangles.
    Teapot { level: u32 },
    /// [`icosphere`]: 20 * 4^level triangles.
    Icosphere { level: u32 },
    /// [`cube`]: 12 triangles.
    Box,
    /// [`cylinder`]: 4 sides - 4 triangles.
    Cylinder { sides: u32 },
    /// [`stairs`]: 12 triangles a step.
    Stairs { steps: u32 },
    /// [`cow`]: 28 * 20 * 4^level triangles.
    Cow { level: u32 },
    /// [`walker`]: 22 * 20 * 4^level triangles.
    Walker { level: u32 },
    /// [`plane`]: 2 divisions^2 triangles.
    Plane { size: f64, divisions: u32 },
    /// [`city`]: `triangles` triangles; the number of blocks a side follows from it where none is given.
    City { seed: u64, blocks: Option<u32>, triangles: u64 },
    /// [`terrain`]: 2 size^2 triangles.
    Terrain { seed: u64, size: u32 },
    /// [`soup`]: `triangles` triangles.
    Soup { seed: u64, triangles: u64 },
}

impl Builtin {
    /// The name in a scene file.
    pub fn name(&self) -> &'static str {
        match self {
            Builtin::Teapot { .. } => "teapot",
            Builtin::Icosphere { .. } => "icosphere",
            Builtin::Box => "box",
            Builtin::Cylinder { .. } => "cylinder",
            Builtin::Stairs { .. } => "stairs",
            Builtin::Cow { .. } => "cow",
            Builtin::Walker { .. } => "walker",
            Builtin::Plane { .. } => "plane",
            Builtin::City { .. } => "city",
            Builtin::Terrain { .. } => "terrain",
            Builtin::Soup { .. } => "soup",
        }
    }

    /// The number of triangles and about that of vertices. Does not overflow, whatever the parameters.
    fn size(&self) -> (u64, u64) {
        let spheres = |count: u64, level: u32| {
            let triangles = (20 * count).saturating_mul(4u64.saturating_pow(level));
            (triangles, triangles / 2)
        };
        let grid = |cells: u64| (2 * cells, cells);
        match *self {
            Builtin::Teapot { level } => grid(32 * u64::from(level).pow(2)),
            Builtin::Icosphere { level } => spheres(1, level),
            Builtin::Box => (12, 8),
            Builtin::Cylinder { sides } => (4 * u64::from(sides), 2 * u64::from(sides)),
            Builtin::Stairs { steps } => (12 * u64::from(steps), 8 * u64::from(steps)),
            Builtin::Cow { level } => spheres(28, level),
            Builtin::Walker { level } => spheres(22, level),
            Builtin::Plane { divisions, .. } => grid(u64::from(divisions).pow(2)),
            Builtin::City { triangles, .. } => (triangles, triangles / 2),
            Builtin::Terrain { size, .. } => grid(u64::from(size).pow(2)),
            Builtin::Soup { triangles, .. } => (triangles, 3 * triangles),
        }
    }

    /// Keys that are whole numbers, with their values and ranges.
    fn ranges(&self) -> Vec<(&'static str, u64, RangeInclusive<u64>)> {
        let one = |key, value: u32, range| vec![(key, value.into(), range)];
        match *self {
            Builtin::Teapot { level } => one("level", level, 1..=MAX_TEAPOT_LEVEL),
            Builtin::Icosphere { level } => one("level", level, 0..=MAX_ICOSPHERE_LEVEL),
            Builtin::Box => Vec::new(),
            Builtin::Cylinder { sides } => one("sides", sides, 3..=MAX_SIDES),
            Builtin::Stairs { steps } => one("steps", steps, 1..=MAX_STEPS),
            Builtin::Cow { level } | Builtin::Walker { level } => one("level", level, 0..=MAX_FIGURE_LEVEL),
            Builtin::Plane { divisions, .. } => one("divisions", divisions, 1..=MAX_CELLS),
            Builtin::City { blocks, triangles, .. } => {
                let blocks = blocks.map(|blocks| ("blocks", blocks.into(), 1..=MAX_BLOCKS));
                [("triangles", triangles, 1..=MAX_TRIANGLES as u64)].into_iter().chain(blocks).collect()
            }
            Builtin::Terrain { size, .. } => one("size", size, 1..=MAX_CELLS),
            Builtin::Soup { triangles, .. } => vec![("triangles", triangles, 1..=MAX_TRIANGLES as u64)],
        }
    }

    /// Refuses a mesh that does not fit the free memory, before it is made.
    fn check_memory(&self, limits: Limits) -> Result<()> {
        let (triangles, vertices) = self.size();
        let what = format_args!("{} of {triangles} triangles", self.name());
        check_memory(limits, (triangles, vertices), what, "make it coarser")
    }
}

/// Makes a built-in mesh.
///
/// # Errors
/// [`Error::Work`] if it does not fit the free memory; [`Error::Input`] naming the key whose value gives no triangles, more than 2^28, or
/// (`city`) fewer than the plainest city has.
pub fn generate(builtin: &Builtin, limits: Limits) -> Result<Mesh> {
    if let Builtin::Plane { size, .. } = *builtin
        && !(size > 0.0 && size.is_finite())
    {
        return Err(Error::input(format!("size = {size}: use a finite length above 0")));
    }
    for (key, value, range) in builtin.ranges() {
        if !range.contains(&value) {
            let (least, most) = range.into_inner();
            return Err(Error::input(format!("{key} = {value}: use {least} to {most}")));
        }
    }
    // a box is never too large
    if *builtin != Builtin::Box {
        builtin.check_memory(limits)?;
    }
    Ok(match *builtin {
        Builtin::Teapot { level } => teapot(level),
        Builtin::Icosphere { level } => icosphere(level),
        Builtin::Box => cube(),
        Builtin::Cylinder { sides } => cylinder(sides),
        Builtin::Stairs { steps } => stairs(steps),
        Builtin::Cow { level } => cow(level),
        Builtin::Walker { level } => walker(level),
        Builtin::Plane { size, divisions } => plane(size, divisions),
        Builtin::City { seed, blocks, triangles } => return city(seed, blocks, triangles),
        Builtin::Terrain { seed, size } => terrain(seed, size),
        Builtin::Soup { seed, triangles } => soup(seed, triangles),
    })
}

/// Materials of these names and diffuse colours.
fn materials(all: &[(&str, [f32; 3])]) -> Vec<Material> {
    all.iter().map(|&(name, diffuse)| Material { name: name.into(), diffuse, ..Material::default() }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_out_of_range_name_their_key() {
        for (builtin, expected) in [
            (Builtin::Teapot { level: 0 }, "level = 0: use 1 to 2048"),
            (Builtin::Icosphere { level: 12 }, "level = 12: use 0 to 11"),
            (Builtin::Cow { level: 10 }, "level = 10: use 0 to 9"),
            (Builtin::Walker { level: 10 }, "level = 10: use 0 to 9"),
            (Builtin::Cylinder { sides: 2 }, "sides = 2: use 3 to 33554432"),
            (Builtin::Stairs { steps: 0 }, "steps = 0: use 1 to 16777216"),
            (Builtin::Plane { size: 0.0, divisions: 1 }, "size = 0: "),
            (Builtin::Plane { size: f64::NAN, divisions: 1 }, "size = NaN: "),
            (Builtin::Plane { size: 1.0, divisions: 0 }, "divisions = 0: "),
            (Builtin::City { seed: 0, blocks: Some(0), triangles: 10_000 }, "blocks = 0: "),
            (Builtin::City { seed: 0, blocks: Some(16), triangles: 100 }, "triangles = 100: "),
            (Builtin::City { seed: 0, blocks: None, triangles: 1 }, "triangles = 1: "),
            (Builtin::City { seed: 0, blocks: None, triangles: 1 << 29 }, "triangles = 536870912: "),
            (Builtin::Terrain { seed: 0, size: 11586 }, "size = 11586: use 1 to 11585"),
            (Builtin::Soup { seed: 0, triangles: 0 }, "triangles = 0: "),
        ] {
            let message = generate(&builtin, Limits::default()).unwrap_err().to_string();
            assert!(message.starts_with(expected), "{message}");
        }
    }

    #[test]
    fn limits_are_the_last_values_under_2_to_the_28() {
        let over = |triangles: u64| triangles > MAX_TRIANGLES as u64;
        assert!(!over(64 * MAX_TEAPOT_LEVEL.pow(2)) && over(64 * (MAX_TEAPOT_LEVEL + 1).pow(2)));
        assert!(!over(2 * MAX_CELLS.pow(2)) && over(2 * (MAX_CELLS + 1).pow(2)));
        assert!(!over(20 << (2 * MAX_ICOSPHERE_LEVEL)) && over(20 << (2 * (MAX_ICOSPHERE_LEVEL + 1))));
    }

    #[test]
    fn every_builtin_has_its_count_and_repeats() {
        for (builtin, triangles) in [
            (Builtin::Teapot { level: 3 }, 576),
            (Builtin::Icosphere { level: 2 }, 320),
            (Builtin::Box, 12),
            (Builtin::Cylinder { sides: 32 }, 124),
            (Builtin::Stairs { steps: 9 }, 108),
            (Builtin::Cow { level: 2 }, 8960),
            (Builtin::Walker { level: 2 }, 7040),
            (Builtin::Plane { size: 4.0, divisions: 3 }, 18),
            (Builtin::City { seed: 1, blocks: None, triangles: 15_001 }, 15_001),
            (Builtin::City { seed: 1, blocks: Some(8), triangles: 35_000 }, 35_000),
            (Builtin::Terrain { seed: 1, size: 17 }, 578),
            (Builtin::Soup { seed: 1, triangles: 77 }, 77),
        ] {
            let mesh = generate(&builtin, Limits::default()).unwrap();
            testing::assert_sound(&mesh);
            assert_eq!(mesh.triangles.len(), triangles, "{builtin:?}");
            let (count, vertices) = builtin.size();
            assert!(count.abs_diff(triangles as u64) <= 4, "{builtin:?}: {count}");
            assert!(mesh.positions.len() as u64 <= 4 * vertices, "{builtin:?}: {vertices}");
            assert_eq!(mesh, generate(&builtin, Limits::default()).unwrap());
        }
    }
}

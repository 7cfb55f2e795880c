//! The plan of a city: its boxes, before windows are added.

use glam::DVec3;

use super::super::boxes::OPEN_BOX_TRIANGLES;
use super::super::random::Random;

/// A block and its share of streets, in scene units.
pub(super) const PITCH: f64 = 6.25;
/// A block's edge.
const BLOCK: f64 = 5.0;
/// Height of a block's slab over the street.
const KERB: f64 = 0.05;
/// Free ground around each building.
const GAP: f64 = 0.2;
/// Share of blocks that are parks.
const PARKS: f64 = 0.08;
/// Heights of buildings: this much at least, and this much more at most at the border and in the centre.
const LOWEST: f64 = 0.8;
const RISE: f64 = 3.0;
const CENTRE_RISE: f64 = 22.0;

pub(super) const STREET: u32 = 0;
const PAVEMENT: u32 = 1;
const PARK: u32 = 2;
const FIRST_WALL: u32 = 3;
pub(super) const GLASS: u32 = 8;

pub(super) const MATERIALS: [(&str, [f32; 3]); 9] = [
    ("asphalt", [0.16, 0.16, 0.18]),
    ("pavement", [0.46, 0.45, 0.43]),
    ("park", [0.24, 0.44, 0.17]),
    ("sandstone", [0.76, 0.63, 0.45]),
    ("brick", [0.55, 0.26, 0.2]),
    ("concrete", [0.62, 0.62, 0.6]),
    ("plaster", [0.85, 0.8, 0.7]),
    ("slate", [0.33, 0.38, 0.45]),
    ("glass", [0.25, 0.42, 0.55]),
];

/// One box without a bottom: a block's slab, or a tier of a building.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Tier {
    pub low: DVec3,
    pub size: DVec3,
    pub material: u32,
    pub has_windows: bool,
}

/// All boxes of a city, block by block.
#[derive(Debug)]
pub(super) struct Plan {
    pub blocks: u32,
    pub tiers: Vec<Tier>,
}

impl Plan {
    pub(super) fn new(seed: u64, blocks: u32) -> Plan {
        let mut plan = Plan { blocks, tiers: Vec::new() };
        for row in 0..blocks {
            for column in 0..blocks {
                let mut random = Random::new(seed, u64::from(row) << 32 | u64::from(column));
                plan.add_block(&mut random, column, row);
            }
        }
        plan
    }

    /// Triangles without windows: the ground's and all boxes'.
    pub(super) fn plain_triangles(&self) -> u64 {
        2 * u64::from(self.blocks).pow(2) + OPEN_BOX_TRIANGLES * self.tiers.len() as u64
    }

    /// The area of all walls that have windows, summed in the order in which they get them.
    pub(super) fn wall_area(&self) -> f64 {
        let walls = self
            .tiers
            .iter()
            .filter(|tier| tier.has_windows)
            .flat_map(|Tier { size, .. }| [size.x * size.y, size.z * size.y, size.x * size.y, size.z * size.y]);
        walls.sum()
    }

    fn add_block(&mut self, random: &mut Random, column: u32, row: u32) {
        let centre = f64::from(self.blocks) / 2.0;
        let place = |k: u32| PITCH * (f64::from(k) - centre) + (PITCH - BLOCK) / 2.0;
        let low = DVec3::new(place(column), 0.0, place(row));
        // The middle block has buildings, so that every city has walls for windows.
        let is_middle = column == self.blocks / 2 && row == self.blocks / 2;
        let is_park = random.unit() < PARKS && !is_middle;
        let material = if is_park { PARK } else { PAVEMENT };
        let size = DVec3::new(BLOCK, KERB, BLOCK);
        self.tiers.push(Tier { low, size, material, has_windows: false });
        if is_park {
            return;
        }
        let offset = |k: u32| (f64::from(k) + 0.5 - centre) / centre;
        let from_centre = (offset(column).powi(2) + offset(row).powi(2)).min(1.0);
        let highest = RISE + CENTRE_RISE * (1.0 - from_centre).powi(2);
        let lots = [1, 2, 2, 2, 3][random.below(5) as usize];
        let lot = BLOCK / f64::from(lots);
        for k in 0..lots * lots {
            let corner = low + DVec3::new(lot * f64::from(k % lots), KERB, lot * f64::from(k / lots));
            self.add_building(random, corner, lot, highest);
        }
    }

    /// One to three tiers, each narrower than the one below, on a square lot. Squaring makes tall ones rare.
    fn add_building(&mut self, random: &mut Random, corner: DVec3, lot: f64, highest: f64) {
        let height = LOWEST + (highest - LOWEST) * random.unit().powi(2);
        let material = FIRST_WALL + random.below(u64::from(GLASS - FIRST_WALL)) as u32;
        let tiers = if height > RISE { 1 + random.below(3) } else { 1 };
        let width = |random: &mut Random| (lot - 2.0 * GAP) * random.between(0.75, 1.0);
        let mut size = DVec3::new(width(random), height / tiers as f64, width(random));
        let mut low = corner + DVec3::new((lot - size.x) / 2.0, 0.0, (lot - size.z) / 2.0);
        for _ in 0..tiers {
            self.tiers.push(Tier { low, size, material, has_windows: true });
            let inset = random.between(0.08, 0.18);
            low += DVec3::new(inset * size.x, size.y, inset * size.z);
            size *= DVec3::new(1.0 - 2.0 * inset, 1.0, 1.0 - 2.0 * inset);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn buildings_stay_on_their_blocks() {
        let plan = Plan::new(11, 6);
        for tier in &plan.tiers {
            let high = tier.low + tier.size;
            assert!(tier.size.min_element() > 0.0);
            for (low, high) in [(tier.low.x, high.x), (tier.low.z, high.z)] {
                let block = (low / PITCH).floor();
                let street = (PITCH - BLOCK) / 2.0;
                // Half a street away from the pitch's lines, to a rounding of coordinates under 32.
                let tolerance = 32.0 * f64::EPSILON;
                assert!(
                    low >= block * PITCH + street - tolerance && high <= (block + 1.0) * PITCH - street + tolerance
                );
            }
        }
    }

    #[test]
    fn the_middle_block_is_built_on() {
        for seed in 0..100 {
            assert!(Plan::new(seed, 1).wall_area() > 0.0);
        }
    }
}

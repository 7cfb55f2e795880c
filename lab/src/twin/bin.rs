//! bin in f64: which triangles cover a pixel of which tiles, found by testing every pixel.

use super::cull::Address;
use super::edge::side_over;
use super::raster::{Corners, test};
use super::rays::{Cast, owned};
use super::{KernelInputs, Real};
use anamorph::internals::camera::TILE;
use anamorph::internals::gpu::layout::Cell;
use glam::DVec3;
use rayon::prelude::*;
use std::collections::HashMap;

/// A pair as stored in the lists: a triangle's slot, a tile, and the box of its pixels to test.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Pair {
    pub slot: u32,
    pub tile: u32,
    /// First column and row.
    pub from: [u32; 2],
    /// Last column and row.
    pub to: [u32; 2],
}

impl Pair {
    /// 28 bits of slot and 24 of tile, then four numbers of 3 bits: columns from and to, rows from and to.
    pub fn pack(&self) -> [u32; 2] {
        let box_bits = self.from[0] | self.to[0] << 3 | self.from[1] << 6 | self.to[1] << 9;
        [self.slot | (box_bits & 15) << 28, self.tile | (box_bits >> 4) << 24]
    }

    pub fn unpack([lo, hi]: [u32; 2]) -> Pair {
        let box_bits = lo >> 28 | hi >> 24 << 4;
        let number = |place: u32| box_bits >> place & 7;
        Pair {
            slot: lo & 0x0fff_ffff,
            tile: hi & 0x00ff_ffff,
            from: [number(0), number(6)],
            to: [number(3), number(9)],
        }
    }

    /// The pixels of the box, bit 8 y + x.
    pub fn pixels(&self) -> u64 {
        let inside = |bit: &u32| {
            let (x, y) = (bit % TILE, bit / TILE);
            (self.from[0]..=self.to[0]).contains(&x) && (self.from[1]..=self.to[1]).contains(&y)
        };
        (0..64).filter(inside).fold(0, |mask, bit| mask | 1 << bit)
    }
}

/// A triangle and a tile in which it covers pixels, at a t in range, on a visible face.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Binned {
    pub slot: u32,
    pub tile: u32,
    /// Pixels that it certainly covers.
    pub certain: u64,
    /// Pixels that it may cover: their rays pass an edge within rounding.
    pub possible: u64,
}

impl Binned {
    /// The pair whose box just holds the possible pixels.
    pub fn pair(&self) -> Pair {
        let bits = || (0..64u32).filter(|b| self.possible >> b & 1 == 1);
        let ends = |f: fn(u32) -> u32| (bits().map(f).min().unwrap_or(0), bits().map(f).max().unwrap_or(0));
        let ((x0, x1), (y0, y1)) = (ends(|b| b % TILE), ends(|b| b / TILE));
        Pair { slot: self.slot, tile: self.tile, from: [x0, y0], to: [x1, y1] }
    }
}

/// The cells below a node.
pub fn cells_below(input: &KernelInputs, node: Address) -> Vec<u32> {
    match node.cell() {
        Some(cell) => vec![cell],
        None => input.children(node).into_iter().flat_map(|child| cells_below(input, child)).collect(),
    }
}

/// Every triangle of every item's cluster against every pixel below its node, but for tiles that lie beside it whole.
pub fn bin(input: &KernelInputs, work: &[[u32; 2]], real: Real) -> Vec<Binned> {
    work.par_iter().flat_map_iter(|&[cluster, node]| bin_item(input, cluster, Address::unpack(node), real)).collect()
}

fn bin_item(input: &KernelInputs, cluster: u32, node: Address, real: Real) -> Vec<Binned> {
    let cluster = &input.clusters[cluster as usize];
    let slots = cluster.first..cluster.first + cluster.count;
    let corners: Vec<_> = slots.map(|slot| (slot, input.corners(slot))).collect();
    let mut found: Vec<Binned> = Vec::new();
    // where each triangle and tile of it is
    let mut place = HashMap::new();
    for cell in cells_below(input, node) {
        let cell = &input.cells[cell as usize];
        let pixels = owned(cell);
        let rays: Vec<_> =
            (0..64).filter(|b| pixels >> b & 1 == 1).map(|bit| (bit, input.cell_cast(cell, bit))).collect();
        for (slot, corners) in &corners {
            if beside(input, cell, corners, real) {
                continue;
            }
            let (certain, possible) = covered(input, &rays, corners, real);
            if possible == 0 {
                continue;
            }
            let same = *place.entry((*slot, cell.tile)).or_insert(found.len());
            match found.get_mut(same) {
                Some(other) => (other.certain, other.possible) = (other.certain | certain, other.possible | possible),
                None => found.push(Binned { slot: *slot, tile: cell.tile, certain, possible }),
            }
        }
    }
    found
}

/// The pixels, each with its rays, that a triangle covers for certain and that it may cover.
pub fn covered(input: &KernelInputs, casts: &[(u32, Cast)], corners: &Corners, real: Real) -> (u64, u64) {
    let (mut certain, mut possible) = (0, 0);
    for (bit, cast) in casts {
        let tested = test(input, cast, corners, real);
        certain |= u64::from(tested.hit.is_some() && !tested.uncertain) << bit;
        possible |= u64::from(tested.hit.is_some() || tested.uncertain) << bit;
    }
    (certain, possible)
}

/// Half of a tile, px: all its pixels' centres lie nearer to its middle pixel's corner.
const TILE_HALF: f64 = TILE as f64 / 2.0;

/// Two edges have all of a cell's tile on different sides: no pixel of it need be tested. Never so in a ray field
/// or among curves, which follow no rule.
pub fn beside(input: &KernelInputs, cell: &Cell, corners: &Corners, real: Real) -> bool {
    if input.rays.is_some() {
        return false;
    }
    let Cast::Ray(rays) = input.cell_cast(cell, (TILE / 2) * TILE + TILE / 2) else { return false };
    let middle = rays.bundle;
    let [v0, v1, v2] = corners.v;
    let side = |from: DVec3, to: DVec3| side_over(&middle, from, to, real, TILE_HALF);
    let sides = [side(v0, v1), side(v1, v2), -side(v0, v2)];
    sides.contains(&1) && sides.contains(&-1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pair_survives_packing() {
        for k in 0..4096u32 {
            let pair = Pair {
                slot: k.wrapping_mul(0x9e37_79b9) >> 4,
                tile: k.wrapping_mul(0x85eb_ca6b) >> 8,
                from: [k & 7, k >> 3 & 7],
                to: [k >> 6 & 7, k >> 9],
            };
            assert_eq!(Pair::unpack(pair.pack()), pair);
        }
    }

    #[test]
    fn a_pair_s_box_just_holds_its_pixels() {
        let binned = Binned { slot: 0, tile: 0, certain: 0, possible: 1 << 10 | 1 << 29 };
        let pair = binned.pair();
        assert_eq!((pair.from, pair.to), ([2, 1], [5, 3]));
        assert_eq!(pair.pixels(), 0b0011_1100 * 0x0101_0100);
    }
}

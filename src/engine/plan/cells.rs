//! Splits a tile into cells where the rays of a field, or the chords of curves, jump inside it, so that each cell has its own, tight bound.

use super::fit::Fit;
use super::tiles::{TileRay, TileRays};
use crate::arrays::MapEach;
use crate::camera::TILE;

/// Pixels of one cell, bit 8 y + x, and their rays.
#[derive(Debug, Clone)]
pub struct Part {
    pub mask: u64,
    pub rays: Vec<TileRay>,
}

/// A cell of this many pixels is split no further: hardly a triangle fewer would be paired with it.
const PIXELS_MIN: usize = 4;

impl Part {
    /// The pixels of a mask, a ray each.
    fn pixels(&self) -> impl Iterator<Item = (u32, &TileRay)> {
        (0..TILE * TILE).filter(|bit| self.mask >> bit & 1 == 1).zip(&self.rays)
    }

    /// Those before column or row `at`, and those from it on.
    fn split(&self, along: fn(u32) -> u32, at: u32) -> [Part; 2] {
        let mut parts = [0, 1].map_each(|_| Part { mask: 0, rays: Vec::new() });
        for (bit, ray) in self.pixels() {
            let part = &mut parts[usize::from(along(bit) >= at)];
            part.mask |= 1 << bit;
            part.rays.push(*ray);
        }
        parts
    }

    fn fit(&self) -> Fit {
        Fit::of(&TileRays { rays: self.rays.clone(), ..TileRays::default() })
    }
}

/// Splits discontinuous rays along the columns or rows that leave them most nearly affine on both sides, until none are discontinuous.
pub fn cells_of(whole: Part) -> Vec<Part> {
    if whole.rays.len() <= PIXELS_MIN || !whole.fit().is_loose() {
        return vec![whole];
    }
    let looseness = |part: &Part| part.rays.len() as f64 * part.fit().looseness();
    let axes: [fn(u32) -> u32; 2] = [|bit| bit % TILE, |bit| bit / TILE];
    let splits = axes.into_iter().flat_map(|along| (1..TILE).map(move |at| (along, at)));
    let splits = splits.map(|(along, at)| whole.split(along, at)).filter(|parts| parts.iter().all(|p| p.mask != 0));
    let cost = |parts: &[Part; 2]| parts.iter().map(looseness).sum::<f64>();
    let best = splits.map(|parts| (cost(&parts), parts)).min_by(|a, b| a.0.total_cmp(&b.0));
    match best {
        Some((_, parts)) => parts.into_iter().flat_map(cells_of).collect(),
        None => vec![whole],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::plan::tiles::place_in_tile;
    use glam::{DVec2, DVec3};

    /// A tile whose directions are affine in the pixel but for the jumps.
    fn tile(jump: impl Fn(u32, u32) -> f64) -> Part {
        let pixel = |bit: u32| (bit % TILE, bit / TILE);
        let ray = |(x, y): (u32, u32)| {
            let place = place_in_tile(x, y);
            TileRay { place, p: DVec3::ONE, d: DVec3::new(0.1 * place.x + jump(x, y), 0.1 * place.y, -1.0) }
        };
        Part { mask: u64::MAX, rays: (0..64).map(pixel).map(ray).collect() }
    }

    #[test]
    fn smooth_rays_stay_together() {
        assert_eq!(cells_of(tile(|_, _| 0.0)).len(), 1);
    }

    #[test]
    fn a_jump_is_split_where_it_is() {
        let parts = cells_of(tile(|_, y| if y < 4 { 0.0 } else { 2.0 }));
        let masks: Vec<u64> = parts.iter().map(|p| p.mask).collect();
        assert_eq!(masks, [0x0000_0000_ffff_ffff, 0xffff_ffff_0000_0000]);
        let parts = cells_of(tile(|x, y| f64::from(x / 3) + 3.0 * f64::from(y / 5)));
        assert_eq!(parts.iter().map(|p| p.mask).fold(0, |all, m| all ^ m), u64::MAX);
        let place = |at: DVec2| (at * 4.0 + 3.5).round().as_uvec2();
        for part in &parts {
            let of = |s: &TileRay| (place(s.place).x / 3, place(s.place).y / 5);
            let first = of(&part.rays[0]);
            assert!(part.rays.iter().all(|s| of(s) == first), "{:#x} holds two views", part.mask);
        }
    }

    #[test]
    fn noise_is_split_into_small_cells_and_no_pixel_is_lost() {
        let parts = cells_of(tile(|x, y| f64::from((x * 37 + y * 101) * (x + 3 * y) % 17)));
        assert_eq!(parts.iter().map(|p| p.mask).fold(0, |all, m| all ^ m), u64::MAX);
        assert_eq!(parts.iter().map(|p| p.mask.count_ones()).sum::<u32>(), 64);
    }
}

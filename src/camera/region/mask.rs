//! Masks: images whose white texels are a region.

use crate::arrays::MapEach;
use crate::geometry::texture::{decoded, has_known_start};
use crate::input::{Error, Loading, Result};
use glam::{DVec2, UVec2};
use std::path::Path;

/// Texels that are inside or outside, over the whole image.
#[derive(Debug, Clone, PartialEq)]
pub struct Mask {
    size: UVec2,
    /// Row by row from the top.
    inside: Vec<bool>,
    /// For each row the columns of the texels that are inside where the one to their left is not, or the other way round; ascending.
    changes: Vec<Vec<u32>>,
    /// The corners of the box around all texels that are inside, image coordinates.
    pub bounds: [DVec2; 2],
}

/// Half of white, of 16 bits: a byte of 128 as 16 bits is over it, one of 127 under.
const HALF: u32 = 1 << 15;

impl Mask {
    /// Of a PNG, JPEG or Radiance file. A texel is inside where R + G + B is at least 3/2 and its opacity at least 1/2, as stored, of 1.
    ///
    /// # Errors
    /// [`Error::Missing`] or [`Error::Read`] if it cannot be read; [`Error::Input`] naming it if it is no image, or no texel is inside.
    pub fn load(path: &Path, loading: &Loading) -> Result<Mask> {
        let unreadable = |e| Error::unreadable(path, e);
        let start = loading.prefix(path).map_err(unreadable)?;
        let is_image = has_known_start(start.bytes());
        let bytes = start.read_if(is_image).map_err(unreadable)?;
        let texels = decoded(&bytes, None).map_err(|e| e.at(path.display()))?.into_rgba16();
        let is_inside = |[r, g, b, opacity]: [u32; 4]| r + g + b >= 3 * HALF && opacity >= HALF;
        let inside: Vec<bool> = texels.pixels().map(|texel| is_inside(texel.0.map_each(u32::from))).collect();
        let size = UVec2::new(texels.width(), texels.height());
        let bounds = bounds(size, &inside).ok_or_else(|| {
            Error::input(format!("{}: no texel is white, so the camera would show nowhere", path.display()))
        })?;
        Ok(Mask { size, changes: changes(size, &inside), inside, bounds })
    }

    /// The texel that holds the place is inside. Places on a border between texels belong to the right and lower one.
    pub fn holds(&self, place: DVec2) -> bool {
        self.is_inside((place * self.size.as_dvec2()).as_uvec2().min(self.size - 1))
    }

    fn is_inside(&self, texel: UVec2) -> bool {
        self.inside[texel.y as usize * self.size.x as usize + texel.x as usize]
    }

    /// The distance from a place of an image of `size` px to the nearest border between texels that are inside and texels that are not, px;
    /// `most` where it is farther.
    pub fn to_border(&self, place_px: DVec2, size: DVec2, most: f64) -> f64 {
        let texel_px = size / self.size.as_dvec2();
        let place = place_px / texel_px;
        let own = self.holds(place_px / size);
        let column = (place.x as u32).min(self.size.x - 1);
        // saturates at the first and last row
        let (first, last) = ((place.y - most / texel_px.y) as u32, (place.y + most / texel_px.y) as u32);
        let mut nearest = most;
        for row in first..=last.min(self.size.y - 1) {
            let top = f64::from(row) - place.y;
            let down = top.max(-1.0 - top).max(0.0);
            let across =
                if self.is_inside(UVec2::new(column, row)) == own { self.to_change(row, place.x) } else { 0.0 };
            nearest = nearest.min((DVec2::new(across, down) * texel_px).length());
        }
        nearest
    }

    /// The distance from a place in a row to its nearest change, texels; infinite without any.
    fn to_change(&self, row: u32, x: f64) -> f64 {
        let changes = &self.changes[row as usize];
        let next = changes.partition_point(|column| f64::from(*column) <= x);
        let beside = [next.checked_sub(1), Some(next)].into_iter().flatten().filter_map(|k| changes.get(k));
        beside.fold(f64::INFINITY, |least, column| least.min((x - f64::from(*column)).abs()))
    }
}

fn changes(size: UVec2, inside: &[bool]) -> Vec<Vec<u32>> {
    let of_row = |row: &[bool]| (1..size.x).filter(|&k| row[k as usize] != row[k as usize - 1]).collect();
    inside.chunks(size.x as usize).map(of_row).collect()
}

fn bounds(size: UVec2, inside: &[bool]) -> Option<[DVec2; 2]> {
    let at = |k: usize| UVec2::new((k % size.x as usize) as u32, (k / size.x as usize) as u32);
    let texels = inside.iter().enumerate().filter(|(_, is_inside)| **is_inside).map(|(k, _)| at(k));
    let [low, high] = texels.map(|q| [q, q + 1]).reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])?;
    Some([low, high].map_each(|q| q.as_dvec2() / size.as_dvec2()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Rng;

    /// Against all texels one by one, of masks that have the same share of both kinds.
    #[test]
    fn the_border_is_that_of_the_nearest_texel_of_the_other_kind() {
        let mut rng = Rng(3);
        for (w, h) in [(1, 1), (2, 1), (7, 5), (16, 9)] {
            let size = UVec2::new(w, h);
            let inside: Vec<bool> = (0..w * h).map(|_| rng.unit() < 0.5).collect();
            let mask = Mask { size, changes: changes(size, &inside), inside, bounds: [DVec2::ZERO, DVec2::ONE] };
            let size_px = DVec2::new(64.0, 48.0);
            for k in 0..200 {
                let place = DVec2::new(rng.unit(), rng.unit()) * size_px;
                let own = mask.holds(place / size_px);
                let texels = (0..h).flat_map(|y| (0..w).map(move |x| UVec2::new(x, y)));
                let distance = |texel: UVec2| {
                    let [low, high] = [texel, texel + 1].map(|q| q.as_dvec2() / size.as_dvec2() * size_px);
                    (place - place.clamp(low, high)).length()
                };
                let others = texels.filter(|texel| mask.is_inside(*texel) != own);
                let nearest = others.map(distance).fold(f64::INFINITY, f64::min);
                let most = [1.0, 10.0, 100.0][k % 3];
                let got = mask.to_border(place, size_px, most);
                // a few roundings of coordinates of up to 64
                assert!((got - nearest.min(most)).abs() < 1e-12, "{w} x {h} {place} {most}: {got}, not {nearest}");
            }
        }
    }
}

//! Simplification of a mesh mirror to fewer facets.

use super::facets::Facets;
use crate::arrays::MapEach;
use crate::camera::mesh::welded;
use crate::input::Result;
use glam::DVec3;
use meshopt::{SimplifyOptions, simplify_decoder};

/// How far simplified facets may lie from the surface, relative to its size: the count decides.
const ANY_ERROR: f32 = f32::MAX;

impl Facets {
    /// At most `count` facets, by collapsing edges. Vertices that are left keep their place; a vertex's normal is the mean of its corners' own.
    pub(super) fn simplified(&self, count: usize) -> Result<Facets> {
        let (positions, indices) = welded(self.triangles.iter().flatten().map(|k| self.positions[*k as usize]));
        let mut sums = vec![DVec3::ZERO; positions.len()];
        for (number, n) in indices.iter().zip(self.corner_normals.iter().flatten()) {
            sums[*number as usize] += self.normals[*n as usize];
        }
        let centre = positions.iter().sum::<DVec3>() / positions.len() as f64;
        let places: Vec<[f32; 3]> = positions.iter().map(|p| (*p - centre).as_vec3().to_array()).collect();
        let options = SimplifyOptions::None;
        let kept = simplify_decoder(&indices, &places, 3 * count, ANY_ERROR, options, None);
        let triangles: Vec<[u32; 3]> = kept.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect();
        let area = |t: &&[u32; 3]| {
            let [a, b, c] = t.map_each(|k| positions[k as usize]);
            (b - a).cross(c - a) != DVec3::ZERO
        };
        let triangles: Vec<[u32; 3]> = triangles.iter().filter(area).copied().collect();
        // normals that cancel out: the first corner's
        let normals = sums.iter().map(|n| n.try_normalize().unwrap_or(DVec3::Y)).collect();
        let simpler = Facets { positions, normals, corner_normals: triangles.clone(), triangles, ..Facets::default() };
        Ok(if simpler.triangles.is_empty() { self.clone() } else { simpler })
    }
}

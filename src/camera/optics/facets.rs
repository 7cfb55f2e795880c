//! A surface of flat triangles with normals at their corners.

use crate::arrays::MapEach;
use crate::camera::mesh::welded;
use crate::geometry::mesh::{Material, Mesh, NO_NORMAL};
use crate::input::{Error, Result};
use glam::DVec3;

/// Triangles, counter-clockwise seen from outside, and a unit normal at every corner. World units.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Facets {
    pub positions: Vec<DVec3>,
    pub normals: Vec<DVec3>,
    /// Three indices into `positions`.
    pub triangles: Vec<[u32; 3]>,
    /// Three indices into `normals`.
    pub corner_normals: Vec<[u32; 3]>,
    /// Set if the normals are those of a coarser copy ([`super::shooting`]).
    pub coarse: Option<CoarseFacets>,
}

/// A coarser copy, whose facets are the optics' pieces.
#[derive(Debug, Clone, PartialEq)]
pub struct CoarseFacets {
    pub copy: Box<Facets>,
    /// For each fine facet, the index of its coarse one.
    pub of: Vec<u32>,
    /// Positions of the corners on that facet: weights of its second and third corner, outside it where they belong to its neighbours.
    pub weights: Vec<[[f64; 2]; 3]>,
}

/// One facet, in f64.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Facet {
    pub corners: [DVec3; 3],
    /// Unit.
    pub normals: [DVec3; 3],
}

impl Facets {
    /// The triangles of a mesh that have an area. A corner's normal is the file's where it has one; else the mean of the
    /// normals of all triangles at its position, each weighted by its angle there.
    ///
    /// # Errors
    /// [`Error::Input`] if no triangle is left, or where a corner's normals cancel.
    pub fn of_mesh(mesh: &Mesh) -> Result<Facets> {
        let cross = |t: &[u32; 3]| {
            let [a, b, c] = t.map_each(|k| mesh.positions[k as usize]);
            (b - a).cross(c - a)
        };
        let has_area = |id: &usize| cross(&mesh.triangles[*id]) != DVec3::ZERO;
        let kept: Vec<usize> = (0..mesh.triangles.len()).filter(has_area).collect();
        if kept.is_empty() {
            return Err(Error::input("no triangle with an area; use another mesh"));
        }
        let mut facets = Facets {
            positions: mesh.positions.clone(),
            normals: mesh.normals.iter().map(|n| n.as_dvec3().normalize_or_zero()).collect(),
            triangles: kept.iter().map(|id| mesh.triangles[*id]).collect(),
            ..Facets::default()
        };
        let own = |id: &usize| mesh.corner_normals.get(*id).copied().unwrap_or([NO_NORMAL; 3]);
        let usable = |n: u32| n != NO_NORMAL && facets.normals[n as usize] != DVec3::ZERO;
        facets.corner_normals =
            kept.iter().map(|id| own(id).map_each(|n| if usable(n) { n } else { NO_NORMAL })).collect();
        if facets.corner_normals.iter().flatten().any(|n| *n == NO_NORMAL) {
            facets.add_mean_normals()?;
        }
        Ok(facets)
    }

    /// Fills in the normals of corners without one.
    fn add_mean_normals(&mut self) -> Result<()> {
        let (places, numbers) = welded(self.triangles.iter().flatten().map(|k| self.positions[*k as usize]));
        let mut sums = vec![DVec3::ZERO; places.len()];
        for (t, numbers) in self.triangles.iter().zip(numbers.chunks_exact(3)) {
            let corners = t.map_each(|k| self.positions[k as usize]);
            let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize();
            for k in 0..3 {
                let (p, a, b) = (corners[k], corners[(k + 1) % 3], corners[(k + 2) % 3]);
                sums[numbers[k] as usize] += normal * (a - p).angle_between(b - p);
            }
        }
        let mut normal_of = vec![NO_NORMAL; places.len()];
        let corners = self.corner_normals.iter_mut().flatten().zip(numbers);
        for (normal, number) in corners.filter(|(normal, _)| **normal == NO_NORMAL) {
            let (known, p) = (&mut normal_of[number as usize], places[number as usize]);
            if *known == NO_NORMAL {
                let why = "its triangles there are back to back; mend it";
                let mean = sums[number as usize].try_normalize();
                let mean = mean.ok_or_else(|| Error::input(format!("the mesh has no normal at {p}: {why}")))?;
                *known = self.normals.len() as u32;
                self.normals.push(mean);
            }
            *normal = *known;
        }
        Ok(())
    }

    pub fn facet(&self, k: usize) -> Facet {
        Facet {
            corners: self.triangles[k].map_each(|v| self.positions[v as usize]),
            normals: self.corner_normals[k].map_each(|n| self.normals[n as usize]),
        }
    }

    /// The piece that defines the rays which leave a facet: a facet of a coarser copy, or the facet itself.
    pub fn coarse_of(&self, k: usize) -> u32 {
        self.coarse.as_ref().map_or(k as u32, |c| c.of[k])
    }

    /// Positions of a facet's corners on its piece, as [`CoarseFacets::weights`].
    pub fn coarse_weights(&self, k: usize) -> [[f64; 2]; 3] {
        self.coarse.as_ref().map_or([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], |c| c.weights[k])
    }

    /// The facets that are the optics' pieces: those of the copy, or these.
    pub fn copy(&self) -> &Facets {
        self.coarse.as_ref().map_or(self, |c| &c.copy)
    }

    pub fn piece_count(&self) -> usize {
        self.copy().triangles.len()
    }

    /// The facets as scene triangles of one colour, visible from both sides.
    pub fn mesh(&self, base: [f32; 3]) -> Mesh {
        Mesh {
            positions: self.positions.clone(),
            triangles: self.triangles.clone(),
            materials: vec![Material { name: "optics".into(), diffuse: base, ..Material::default() }],
            material_of: vec![0; self.triangles.len()],
            ..Mesh::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::generate::{cube, icosphere};

    #[test]
    fn normals_of_the_file_are_kept_and_others_are_means_by_angle() {
        let ball = Facets::of_mesh(&icosphere(2)).unwrap();
        for k in 0..ball.triangles.len() {
            let facet = ball.facet(k);
            assert!(facet.corners.iter().zip(facet.normals).all(|(p, n)| (*p - n).length() < 1e-7));
        }
        let mut bare = cube();
        (bare.normals, bare.corner_normals) = (Vec::new(), Vec::new());
        let cube = Facets::of_mesh(&bare).unwrap();
        for k in 0..cube.triangles.len() {
            let facet = cube.facet(k);
            // three right angles meet in every corner, however the faces are split
            assert!(facet.corners.iter().zip(facet.normals).all(|(p, n)| (p.normalize() - n).length() < 1e-15));
        }
        assert_eq!(cube.normals.len(), 8);
    }

    #[test]
    fn a_mesh_without_area_or_back_to_back_is_refused() {
        let mut flat = Mesh {
            positions: vec![DVec3::ZERO, DVec3::X, 2.0 * DVec3::X, DVec3::Y],
            triangles: vec![[0, 1, 2]],
            materials: vec![Material::default()],
            material_of: vec![0],
            ..Mesh::default()
        };
        let message = |mesh: &Mesh| Facets::of_mesh(mesh).unwrap_err().to_string();
        assert!(message(&flat).starts_with("no triangle with an area"));
        flat.triangles = vec![[0, 1, 3], [0, 3, 1]];
        flat.material_of = vec![0, 0];
        assert!(message(&flat).contains("back to back"));
    }
}

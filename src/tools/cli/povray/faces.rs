//! Triangles as a ray tracer without a rule for equal depths needs them: each place once.

use crate::arrays::MapEach;
use crate::geometry::mesh::Mesh;
use glam::DVec3;
use std::collections::HashMap;

/// A triangle, and the lowest id that is seen from either side; `None`: rays go through.
#[derive(Debug, PartialEq)]
pub struct Face {
    pub corners: [DVec3; 3],
    /// From where the corners go counterclockwise.
    pub front: Option<u32>,
    pub back: Option<u32>,
}

impl Face {
    pub fn is_one_sided(&self) -> bool {
        self.front.is_none() || self.back.is_none()
    }
}

/// All triangles of the mesh but those of two corners in one place; coincident ones are one face.
pub fn of(mesh: &Mesh) -> Vec<Face> {
    let mut faces: Vec<Face> = Vec::new();
    let mut known = HashMap::new();
    for (id, triangle) in (0u32..).zip(&mesh.triangles) {
        // -0 is 0
        let mut corners = triangle.map_each(|v| (mesh.positions[v as usize] + 0.0).to_array());
        let mut even = true;
        for (i, j) in [(0, 1), (1, 2), (0, 1)] {
            if corners[j] < corners[i] {
                corners.swap(i, j);
                even = !even;
            }
        }
        if corners[0] == corners[1] || corners[1] == corners[2] {
            continue;
        }
        let face = *known.entry(corners.map_each(|c| c.map_each(f64::to_bits))).or_insert_with(|| {
            faces.push(Face { corners: corners.map_each(DVec3::from), front: None, back: None });
            faces.len() - 1
        });
        let Face { front, back, .. } = &mut faces[face];
        let (own_front, own_back) = if even { (front, back) } else { (back, front) };
        own_front.get_or_insert(id);
        if mesh.materials[mesh.material_of[id as usize] as usize].two_sided {
            own_back.get_or_insert(id);
        }
    }
    faces
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::mesh::Material;

    #[test]
    fn coincident_triangles_are_one_face_with_the_lowest_id_of_each_side() {
        let one_sided = Material { two_sided: false, ..Material::default() };
        let mesh = Mesh {
            positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y, -DVec3::ZERO, DVec3::Z],
            triangles: vec![[1, 1, 2], [0, 1, 2], [2, 1, 3], [1, 2, 0], [2, 4, 0]],
            materials: vec![one_sided, Material::default()],
            material_of: vec![1, 0, 0, 1, 0],
            ..Mesh::default()
        };
        let [a, b, c, d] = [DVec3::ZERO, DVec3::Y, DVec3::X, DVec3::Z];
        // [0, 1, 2] is an odd order of a, b, c and so is seen from the back of these; [2, 4, 0] of a, d, b as well
        let first = Face { corners: [a, b, c], front: Some(2), back: Some(1) };
        let second = Face { corners: [a, d, b], front: None, back: Some(4) };
        assert_eq!(of(&mesh), [first, second]);
        assert!(of(&mesh)[1].is_one_sided() && !of(&mesh)[0].is_one_sided());
    }
}

//! Boxes: the built-in one, and open ones as parts of a city.

use crate::arrays::MapEach;
use glam::{DVec3, Vec2};

use crate::geometry::mesh::{Material, Mesh};

/// Corner k of a box is origin + (bit 0 of k) u + (bit 1) v + (bit 2) w; faces wind outwards for u x v along w.
/// The last face, at the origin's end of w, is the one that open boxes lack.
const FACES: [[usize; 4]; 6] = [[4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5], [0, 2, 3, 1]];

/// Triangles of an open box.
pub(super) const OPEN_BOX_TRIANGLES: u64 = 10;

/// The unit cube [-1/2, 1/2]^3: 12 triangles over 8 shared vertices, closed, facing outwards, no normals. Texture coordinates run
/// from 0 to 1 over each face.
pub fn cube() -> Mesh {
    let mut mesh = Mesh { materials: vec![Material::default()], ..Mesh::default() };
    push_faces(&mut mesh, DVec3::splat(-0.5), [DVec3::Z, DVec3::X, DVec3::Y], &FACES, 0);
    mesh.uvs = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map_each(Vec2::from).to_vec();
    // of two faces the first edge runs upwards
    let first = |face: usize| u32::from(face == 2 || face == 3);
    let corners = |face: usize| [[0, 1, 2], [0, 2, 3]].map_each(|t| t.map_each(|k| (k + first(face)) % 4));
    mesh.corner_uvs = (0..FACES.len()).flat_map(corners).collect();
    mesh
}

/// Appends a box of five faces over the edges u, v, w (u x v along w), without the face that holds u and v at
/// `origin`: [`OPEN_BOX_TRIANGLES`] triangles over 8 vertices.
pub(super) fn push_open_box(mesh: &mut Mesh, origin: DVec3, edges: [DVec3; 3], material: u32) {
    push_faces(mesh, origin, edges, &FACES[..5], material);
}

fn push_faces(mesh: &mut Mesh, origin: DVec3, [u, v, w]: [DVec3; 3], faces: &[[usize; 4]], material: u32) {
    let base = mesh.positions.len() as u32;
    let along = |corner: usize, bit: usize| ((corner >> bit) & 1) as f64;
    mesh.positions.extend((0..8).map(|k| origin + along(k, 0) * u + along(k, 1) * v + along(k, 2) * w));
    for face in faces {
        let [a, b, c, d] = face.map_each(|corner| base + corner as u32);
        mesh.triangles.extend([[a, b, c], [a, c, d]]);
    }
    mesh.material_of.resize(mesh.triangles.len(), material);
}

#[cfg(test)]
mod tests {
    use super::super::testing::{assert_closed, assert_sound, bounds, six_volumes};
    use super::*;

    #[test]
    fn the_cube_is_closed_and_of_unit_volume() {
        let mesh = cube();
        assert_sound(&mesh);
        assert_closed(&mesh);
        assert_eq!(six_volumes(&mesh), 6.0);
        assert_eq!(bounds(&mesh), (DVec3::splat(-0.5), DVec3::splat(0.5)));
    }

    #[test]
    fn an_open_box_lacks_its_base() {
        let mut mesh = Mesh::default();
        push_open_box(&mut mesh, DVec3::ZERO, [DVec3::Z, DVec3::X, DVec3::Y], 0);
        assert_eq!(mesh.triangles.len() as u64, OPEN_BOX_TRIANGLES);
        let is_base = |t: &[u32; 3]| t.iter().all(|&i| mesh.positions[i as usize].y == 0.0);
        assert!(!mesh.triangles.iter().any(is_base));
    }
}

//! A flat square.

use glam::{DVec3, Vec2, Vec3};

use crate::geometry::mesh::{Material, Mesh};

/// The square [-size/2, size/2]^2 on y = 0 facing +y, `divisions` x `divisions` cells of two triangles, row by
/// row along +z, in a row along +x: 2 divisions^2 triangles. Texture coordinates run from 0 to 1 along +x and -z. `divisions` is 1 to
/// 11585.
pub fn plane(size: f64, divisions: u32) -> Mesh {
    let place = |k: u32| size * (f64::from(k) / f64::from(divisions) - 0.5);
    let rows = 0..=divisions;
    let positions = rows.clone().flat_map(|row| rows.clone().map(move |column| (row, column)));
    let triangles = grid_triangles(divisions);
    Mesh {
        positions: positions.map(|(row, column)| DVec3::new(place(column), 0.0, place(row))).collect(),
        normals: vec![Vec3::Y],
        corner_normals: vec![[0; 3]; triangles.len()],
        materials: vec![Material::default()],
        material_of: vec![0; triangles.len()],
        uvs: grid_uvs(divisions),
        corner_uvs: triangles.clone(),
        triangles,
        ..Mesh::default()
    }
}

/// Of each vertex of such a grid, from 0 to 1 along +x and -z.
pub(super) fn grid_uvs(cells: u32) -> Vec<Vec2> {
    let place = |k: u32| k as f32 / cells as f32;
    (0..=cells).flat_map(|row| (0..=cells).map(move |column| Vec2::new(place(column), 1.0 - place(row)))).collect()
}

/// The triangles of a grid of (cells + 1)^2 vertices, row by row along +z, facing +y.
pub(super) fn grid_triangles(cells: u32) -> Vec<[u32; 3]> {
    let mut triangles = Vec::with_capacity(2 * (cells as usize).pow(2));
    for row in 0..cells {
        for column in 0..cells {
            let a = row * (cells + 1) + column;
            let (b, c, d) = (a + 1, a + cells + 1, a + cells + 2);
            triangles.extend([[a, c, d], [a, d, b]]);
        }
    }
    triangles
}

#[cfg(test)]
mod tests {
    use super::super::testing::{assert_sound, bounds};
    use super::*;

    #[test]
    fn triangles_tile_the_square_and_face_up() {
        let mesh = plane(6.0, 5);
        assert_sound(&mesh);
        assert_eq!(mesh.triangles.len(), 50);
        assert_eq!(bounds(&mesh), (DVec3::new(-3.0, 0.0, -3.0), DVec3::new(3.0, 0.0, 3.0)));
        let mut twice_area = 0.0;
        for [a, b, c] in mesh.triangles.iter().map(|t| t.map(|i| mesh.positions[i as usize])) {
            let cross = (b - a).cross(c - a);
            assert!(cross.y > 0.0);
            twice_area += cross.y;
        }
        // 50 sums, each rounded.
        assert!((twice_area - 72.0).abs() < 50.0 * 72.0 * f64::EPSILON);
    }
}

//! A sphere of nearly equal triangles.

use crate::arrays::MapEach;
use std::collections::HashMap;

use glam::DVec3;

use crate::geometry::mesh::{Material, Mesh};

/// The faces of the icosahedron, counter-clockwise from outside, over the vertices of [`corners`].
const FACES: [[u32; 3]; 20] = [
    [0, 11, 5],
    [0, 5, 1],
    [0, 1, 7],
    [0, 7, 10],
    [0, 10, 11],
    [1, 5, 9],
    [5, 11, 4],
    [11, 10, 2],
    [10, 7, 6],
    [7, 1, 8],
    [3, 9, 4],
    [3, 4, 2],
    [3, 2, 6],
    [3, 6, 8],
    [3, 8, 9],
    [4, 9, 5],
    [2, 4, 11],
    [6, 2, 10],
    [8, 6, 7],
    [9, 8, 1],
];

/// The unit sphere about the origin: an icosahedron, each triangle split into four `level` times, vertices pushed
/// out to radius 1. 20 * 4^level triangles over 10 * 4^level + 2 vertices, closed, with smooth normals. `level` is
/// 0 to 11.
pub fn icosphere(level: u32) -> Mesh {
    let mut positions = corners();
    let mut triangles = FACES.to_vec();
    for _ in 0..level {
        triangles = split(&triangles, &mut positions);
    }
    Mesh {
        normals: positions.iter().map(|p| p.as_vec3()).collect(),
        corner_normals: triangles.clone(),
        materials: vec![Material::default()],
        material_of: vec![0; triangles.len()],
        positions,
        triangles,
        ..Mesh::default()
    }
}

/// The icosahedron's twelve vertices: the cyclic shifts of (+-1, +-golden ratio, 0), at length 1.
fn corners() -> Vec<DVec3> {
    let ratio = (1.0 + 5f64.sqrt()) / 2.0;
    let quads = [(-1.0, ratio), (1.0, ratio), (-1.0, -ratio), (1.0, -ratio)];
    let shifts: [fn(f64, f64) -> DVec3; 3] =
        [|a, b| DVec3::new(a, b, 0.0), |a, b| DVec3::new(0.0, a, b), |a, b| DVec3::new(b, 0.0, a)];
    shifts.iter().flat_map(|shift| quads.map_each(|(a, b)| shift(a, b).normalize())).collect()
}

/// Splits each triangle at its edges' midpoints: the middle one last.
fn split(triangles: &[[u32; 3]], positions: &mut Vec<DVec3>) -> Vec<[u32; 3]> {
    let mut middle_of = HashMap::with_capacity(triangles.len() * 3 / 2);
    let mut middle = |a: u32, b: u32| {
        *middle_of.entry((a.min(b), a.max(b))).or_insert_with(|| {
            positions.push((positions[a as usize] + positions[b as usize]).normalize());
            positions.len() as u32 - 1
        })
    };
    let mut finer = Vec::with_capacity(triangles.len() * 4);
    for &[a, b, c] in triangles {
        let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
        finer.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
    }
    finer
}

#[cfg(test)]
mod tests {
    use super::super::testing::{assert_closed, assert_sound, six_volumes};
    use super::*;

    #[test]
    fn spheres_are_closed_round_and_face_outwards() {
        for level in 0..=4 {
            let mesh = icosphere(level);
            assert_sound(&mesh);
            assert_closed(&mesh);
            assert_eq!(mesh.triangles.len(), 20 << (2 * level));
            assert_eq!(mesh.positions.len(), (10 << (2 * level)) + 2);
            for [a, b, c] in mesh.triangles.iter().map(|t| t.map(|i| mesh.positions[i as usize])) {
                assert!((b - a).cross(c - a).dot(a + b + c) > 0.0);
            }
            // A normalised vector's length is right to a few roundings.
            assert!(mesh.positions.iter().all(|p| (p.length() - 1.0).abs() < 4.0 * f64::EPSILON));
        }
        // Inscribed: a little less than the sphere's volume 4 pi / 3.
        let fraction = six_volumes(&icosphere(4)) / (8.0 * std::f64::consts::PI);
        assert!((0.99..1.0).contains(&fraction), "{fraction}");
    }
}

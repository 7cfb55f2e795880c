//! Vertex normals for meshes without them.

use super::mesh::{Mesh, NO_NORMAL};
use super::weld::first_in_place;
use crate::arrays::MapEach;
use glam::DVec3;

/// Gives each corner without a normal the vertex normal at its position: the mean of the normals of all triangles with a corner there,
/// weighted by their angles (Thuermer and Wuethrich 1998). It does not depend on how faces are triangulated. Corners share a vertex if
/// all three coordinates are equal, whatever their indices. Where the mean is zero up to rounding, corners stay without a normal: all
/// triangles there have no area, or each is there twice, with both windings.
pub fn smooth(mesh: &mut Mesh) {
    let vertex_of = first_in_place(mesh.positions.len() as u32, |k| mesh.positions[k as usize]);
    // the sum of weighted normals, and its error bound
    let mut sums = vec![(DVec3::ZERO, 0.0); mesh.positions.len()];
    for triangle in &mesh.triangles {
        let corners = triangle.map_each(|i| mesh.positions[i as usize]);
        for (i, (normal, error)) in triangle.iter().zip(weighted_normals(corners)) {
            let sum = &mut sums[vertex_of[*i as usize] as usize];
            *sum = (sum.0 + normal, sum.1 + error);
        }
    }
    let normal_of: Vec<u32> = sums
        .iter()
        .map(|(sum, error)| match sum.try_normalize() {
            Some(normal) if sum.length() > *error => {
                mesh.normals.push(normal.as_vec3());
                mesh.normals.len() as u32 - 1
            }
            _ => NO_NORMAL,
        })
        .collect();
    if mesh.normals.is_empty() {
        return;
    }
    mesh.corner_normals.resize(mesh.triangles.len(), [NO_NORMAL; 3]);
    for (normals, triangle) in mesh.corner_normals.iter_mut().zip(&mesh.triangles) {
        for (normal, i) in normals.iter_mut().zip(triangle).filter(|(normal, _)| **normal == NO_NORMAL) {
            *normal = normal_of[vertex_of[*i as usize] as usize];
        }
    }
}

/// Rounding error of a weighted normal, as a multiple of `angle * |a| |b| / |a x b| + 1` with the edges a and b that the normal is
/// computed from. With u = EPSILON / 2, edges are off by 2u, their cross product by 11u |a| |b|, the unit normal by 15u |a| |b| / |a x b|
/// and an angle by 20u. The rest, of 64u, is for the rounding of the sum over the triangles of a vertex.
const ERROR: f64 = 32.0 * f64::EPSILON;

/// The triangle's unit normal times its angle at each corner, and an error bound. Zero if the triangle has no area.
fn weighted_normals(corners: [DVec3; 3]) -> [(DVec3, f64); 3] {
    let edges = [0, 1, 2].map_each(|k| corners[(k + 1) % 3] - corners[k]);
    // scaled, as squares of large or small lengths overflow or underflow
    let size = edges.iter().map(|e| e.abs().max_element()).fold(0.0, f64::max);
    let edges = edges.map_each(|e| e / size);
    let cross = edges[0].cross(edges[1]);
    let Some(normal) = cross.try_normalize() else { return [(DVec3::ZERO, 0.0); 3] };
    let condition = edges[0].length() * edges[1].length() / cross.length();
    [0, 1, 2].map_each(|k| {
        let (after, before) = (edges[k], -edges[(k + 2) % 3]);
        let angle = after.cross(before).length().atan2(after.dot(before));
        (angle * normal, ERROR * (angle * condition + 1.0))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::mesh::Material;
    use glam::Vec3;

    /// A cube from -1 to 1 with two triangles per face, which share vertices or not.
    fn cube(shared: bool) -> Mesh {
        let corner = |k: u32| DVec3::new(f64::from(k & 1), f64::from(k >> 1 & 1), f64::from(k >> 2)) * 2.0 - 1.0;
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let triangles: Vec<[u32; 3]> = quads.iter().flat_map(|q| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]).collect();
        let (positions, triangles) = match shared {
            true => ((0..8).map(corner).collect(), triangles),
            false => (
                triangles.iter().flatten().map(|k| corner(*k)).collect(),
                (0..12).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect(),
            ),
        };
        let materials = vec![Material::default()];
        Mesh { positions, triangles, materials, material_of: vec![0; 12], ..Mesh::default() }
    }

    /// Weights by area instead of angle would depend on the diagonals of the faces.
    #[test]
    fn the_normals_of_a_cube_are_its_diagonals() {
        for shared in [false, true] {
            for scale in [1.0, 1e-200, 1e200] {
                let mut mesh = cube(shared);
                mesh.positions.iter_mut().for_each(|p| *p *= scale);
                smooth(&mut mesh);
                assert_eq!(mesh.normals.len(), 8);
                for (triangle, normals) in mesh.triangles.iter().zip(&mesh.corner_normals) {
                    for (i, n) in triangle.iter().zip(normals) {
                        let expected = (mesh.positions[*i as usize] / scale).normalize();
                        let found = mesh.normals[*n as usize].as_dvec3();
                        assert!((found - expected).length() < 1e-6, "{found} for {expected}");
                    }
                }
            }
        }
    }

    #[test]
    fn given_normals_are_kept_and_triangles_without_area_get_none() {
        let mut mesh = cube(true);
        mesh.normals = vec![Vec3::X];
        mesh.corner_normals = vec![[0, NO_NORMAL, 0]];
        // a triangle without area, and one with both windings
        mesh.positions.extend([DVec3::splat(5.0), DVec3::splat(6.0), DVec3::new(5.0, 5.0, 9.0)]);
        mesh.triangles.extend([[8, 8, 9], [8, 9, 10], [8, 10, 9]]);
        mesh.material_of.extend([0; 3]);
        smooth(&mut mesh);
        assert_eq!((mesh.corner_normals[0][0], mesh.corner_normals[0][2]), (0, 0));
        assert!(mesh.corner_normals[..12].iter().flatten().all(|n| *n != NO_NORMAL));
        assert_eq!(mesh.corner_normals[12..], [[NO_NORMAL; 3]; 3]);
        let mut flat = Mesh { positions: vec![DVec3::ZERO], triangles: vec![[0; 3]], ..Mesh::default() };
        smooth(&mut flat);
        assert!(flat.normals.is_empty() && flat.corner_normals.is_empty());
    }

    /// The normals of both windings are computed from different edges, so they cancel up to rounding only.
    #[test]
    fn faces_with_both_windings_get_no_normals() {
        let triangles = vec![[0, 1, 2], [0, 2, 1], [0, 2, 3], [0, 3, 2], [1, 3, 2], [2, 3, 1]];
        for k in 0..1000 {
            let coordinate = |n: i32| f64::from(1 + n + 12 * k).sin() * 10f64.powi(k % 7 - 3);
            let positions = (0..4).map(|v| DVec3::new(coordinate(3 * v), coordinate(3 * v + 1), coordinate(3 * v + 2)));
            let mut mesh = Mesh { positions: positions.collect(), triangles: triangles.clone(), ..Mesh::default() };
            smooth(&mut mesh);
            assert!(mesh.normals.is_empty(), "{k}: {:?}", mesh.normals);
        }
    }
}

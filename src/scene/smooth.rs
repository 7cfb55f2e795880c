//! Normals of corners that have none, from the triangles around them.

use super::mesh::{Mesh, NO_NORMAL};
use glam::DVec3;
use std::collections::HashMap;

/// Gives each corner without a normal the vertex normal of its position: the mean of the normals of all triangles that have a corner there,
/// weighted by their angles at it (Thuermer and Wuethrich 1998), so that it does not depend on how faces are cut into triangles.
/// Corners share a position if all three coordinates are equal, whatever their indices. Where that mean is zero, as it is where all
/// triangles have no area, corners stay without a normal.
pub fn smooth(mesh: &mut Mesh) {
    let mut vertices: HashMap<[u64; 3], usize> = HashMap::new();
    let mut vertex = |p: &DVec3| {
        let next = vertices.len();
        // adding 0 makes -0 and 0 equal
        *vertices.entry(p.to_array().map(|x| (x + 0.0).to_bits())).or_insert(next)
    };
    let vertex_of: Vec<usize> = mesh.positions.iter().map(&mut vertex).collect();
    let mut sums = vec![DVec3::ZERO; vertices.len()];
    for triangle in &mesh.triangles {
        let corners = triangle.map(|i| mesh.positions[i as usize]);
        for (i, part) in triangle.iter().zip(weighted_normals(corners)) {
            sums[vertex_of[*i as usize]] += part;
        }
    }
    let normal_of: Vec<u32> = sums
        .iter()
        .map(|sum| match sum.try_normalize() {
            Some(normal) => {
                mesh.normals.push(normal.as_vec3());
                mesh.normals.len() as u32 - 1
            }
            None => NO_NORMAL,
        })
        .collect();
    if mesh.normals.is_empty() {
        return;
    }
    mesh.corner_normals.resize(mesh.triangles.len(), [NO_NORMAL; 3]);
    for (normals, triangle) in mesh.corner_normals.iter_mut().zip(&mesh.triangles) {
        for (normal, i) in normals.iter_mut().zip(triangle).filter(|(normal, _)| **normal == NO_NORMAL) {
            *normal = normal_of[vertex_of[*i as usize]];
        }
    }
}

/// The triangle's unit normal times its angle at each corner; zeros where it has no area.
fn weighted_normals(corners: [DVec3; 3]) -> [DVec3; 3] {
    let edges = [0, 1, 2].map(|k| corners[(k + 1) % 3] - corners[k]);
    // squares of large or small lengths leave the range of f64
    let size = edges.iter().map(|e| e.abs().max_element()).fold(0.0, f64::max);
    let edges = edges.map(|e| e / size);
    let Some(normal) = edges[0].cross(edges[1]).try_normalize() else { return [DVec3::ZERO; 3] };
    [0, 1, 2].map(|k| {
        let (after, before) = (edges[k], -edges[(k + 2) % 3]);
        after.cross(before).length().atan2(after.dot(before)) * normal
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::mesh::Material;
    use glam::Vec3;

    /// A cube from -1 to 1, each face cut into two triangles, with corners of their own for each where `apart`.
    fn cube(apart: bool) -> Mesh {
        let corner = |k: u32| DVec3::new(f64::from(k & 1), f64::from(k >> 1 & 1), f64::from(k >> 2)) * 2.0 - 1.0;
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let triangles: Vec<[u32; 3]> = quads.iter().flat_map(|q| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]).collect();
        let (positions, triangles) = match apart {
            false => ((0..8).map(corner).collect(), triangles),
            true => (
                triangles.iter().flatten().map(|k| corner(*k)).collect(),
                (0..12).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect(),
            ),
        };
        let materials = vec![Material::default()];
        Mesh { positions, triangles, materials, material_of: vec![0; 12], ..Mesh::default() }
    }

    /// Areas of triangles would turn the normals of a cube to where its faces are cut.
    #[test]
    fn a_cube_has_its_diagonals_however_it_is_cut_and_shared() {
        for apart in [false, true] {
            for scale in [1.0, 1e-200, 1e200] {
                let mut mesh = cube(apart);
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
    fn what_has_a_normal_keeps_it_and_what_can_have_none_stays_without() {
        let mut mesh = cube(false);
        mesh.normals = vec![Vec3::X];
        mesh.corner_normals = vec![[0, NO_NORMAL, 0]];
        // a triangle without area, and one that is there from both sides
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
}

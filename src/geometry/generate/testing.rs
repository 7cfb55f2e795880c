//! Checks that the generators' tests share.

use std::collections::HashSet;

use glam::DVec3;

use crate::geometry::mesh::{Mesh, NO_NORMAL};

/// Lengths match, indices are in range, positions finite, normals of unit length.
pub fn assert_sound(mesh: &Mesh) {
    assert!(mesh.positions.iter().all(|p| p.is_finite()));
    assert!(mesh.normals.iter().all(|n| n.is_normalized()));
    assert!(mesh.triangles.iter().flatten().all(|&i| (i as usize) < mesh.positions.len()));
    let is_normal = |&n: &u32| n == NO_NORMAL || (n as usize) < mesh.normals.len();
    assert!(mesh.corner_normals.iter().flatten().all(is_normal));
    assert_eq!(mesh.corner_normals.len(), if mesh.normals.is_empty() { 0 } else { mesh.triangles.len() });
    assert_eq!(mesh.material_of.len(), mesh.triangles.len());
    assert!(mesh.material_of.iter().all(|&m| (m as usize) < mesh.materials.len()));
}

/// Each half edge has exactly one opposite: the surface is closed and consistently wound.
pub fn assert_closed(mesh: &Mesh) {
    let mut half_edges = HashSet::new();
    for [a, b, c] in &mesh.triangles {
        for edge in [(*a, *b), (*b, *c), (*c, *a)] {
            assert!(half_edges.insert(edge), "half edge {edge:?} twice");
        }
    }
    assert!(half_edges.iter().all(|&(from, to)| half_edges.contains(&(to, from))));
}

/// Six times the volume that the triangles enclose: positive where they face outwards.
pub fn six_volumes(mesh: &Mesh) -> f64 {
    let corner = |i: u32| mesh.positions[i as usize];
    mesh.triangles.iter().map(|&[a, b, c]| corner(a).dot(corner(b).cross(corner(c)))).sum()
}

/// The lowest and highest coordinates.
pub fn bounds(mesh: &Mesh) -> (DVec3, DVec3) {
    let positions = || mesh.positions.iter().copied();
    (positions().reduce(DVec3::min).unwrap(), positions().reduce(DVec3::max).unwrap())
}

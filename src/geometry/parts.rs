//! Nodes and groups of mesh files as objects of their own.

use super::mesh::{Mesh, NO_NORMAL, Part};

/// Gives each part vertices and normals that no other part has, in the order of the parts: an object can then move by itself. Vertices and
/// normals that no triangle has are dropped.
pub(super) fn separate(mesh: &mut Mesh, parts: &[Part]) {
    if parts.len() > 1 {
        separated(&mut mesh.triangles, &mut mesh.positions, parts);
        separated(&mut mesh.corner_normals, &mut mesh.normals, parts);
    }
}

fn separated<T: Copy>(corners: &mut [[u32; 3]], values: &mut Vec<T>, parts: &[Part]) {
    /// Marks a value that the part does not have yet; as an index it is [`NO_NORMAL`], which none has.
    const NEW: u32 = NO_NORMAL;
    let mut place_of = vec![NEW; values.len()];
    let (mut own, mut rest) = (Vec::new(), corners);
    for part in parts {
        let count = part.triangles.min(rest.len());
        let (corners, after) = rest.split_at_mut(count);
        rest = after;
        let first = own.len();
        let mut old = Vec::new();
        for corner in corners.iter_mut().flatten().filter(|c| **c != NO_NORMAL) {
            let place = &mut place_of[*corner as usize];
            if *place == NEW {
                *place = (first + old.len()) as u32;
                old.push(*corner);
            }
            *corner = *place;
        }
        own.extend(old.iter().map(|k| values[*k as usize]));
        old.iter().for_each(|k| place_of[*k as usize] = NEW);
    }
    *values = own;
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DVec3, Vec3};

    #[test]
    fn parts_that_share_a_vertex_get_one_each() {
        let mut mesh = Mesh {
            positions: (0..6).map(|k| DVec3::splat(k.into())).collect(),
            triangles: vec![[1, 2, 3], [3, 2, 1], [3, 4, 1]],
            normals: vec![Vec3::X, Vec3::Y],
            corner_normals: vec![[1, NO_NORMAL, 1], [1; 3], [1, 0, NO_NORMAL]],
            ..Mesh::default()
        };
        let part = |triangles| Part { name: String::new(), triangles };
        separate(&mut mesh, &[part(2), part(1)]);
        assert_eq!(mesh.triangles, [[0, 1, 2], [2, 1, 0], [3, 4, 5]]);
        assert_eq!(mesh.positions, [1.0, 2.0, 3.0, 3.0, 4.0, 1.0].map(DVec3::splat));
        assert_eq!(mesh.corner_normals, [[0, NO_NORMAL, 0], [0; 3], [1, 2, NO_NORMAL]]);
        assert_eq!(mesh.normals, [Vec3::Y, Vec3::Y, Vec3::X]);
    }
}

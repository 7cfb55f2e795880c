//! Tests of clusters, and of triangles that move in them.

use super::*;
use crate::geometry::generate::soup;
use glam::DMat3;

const LIMITS: [u64; 2] = [1 << 27, 1 << 13];

fn mesh() -> Mesh {
    soup(3, 700)
}

fn moved(mesh: &Mesh, to: impl Fn(DVec3) -> DVec3) -> Mesh {
    Mesh { positions: mesh.positions.iter().map(|p| to(*p)).collect(), ..mesh.clone() }
}

/// A triangle as clusters store it: its positions in stored order, and its last word.
fn stored(chunk: &Chunk, slot: u32) -> ([[f64; 3]; 3], u32) {
    let triangle = chunk.triangles[slot as usize];
    ([0, 1, 2].map(|c| chunk.vertices[triangle[c] as usize].position().to_array()), triangle[3])
}

#[test]
fn triangles_that_moved_are_held_as_if_clustered_anew_in_boxes_that_hold_them() {
    let mesh = mesh();
    let rotated = moved(&mesh, |p| DMat3::from_rotation_z(0.4) * p + DVec3::new(0.5, -1.0, 0.0));
    for limit in LIMITS {
        let mut refitted = cluster(&mesh, DVec3::ZERO, SurfaceKind::Plain, limit);
        let slots: Vec<_> = refitted.chunks.iter().map(|c| c.slot_of_id.clone()).collect();
        assert!(refitted.refit(&rotated));
        let anew = cluster(&rotated, DVec3::ZERO, SurfaceKind::Plain, limit).with_vertices(&rotated);
        let refitted = refitted.with_vertices(&rotated);
        assert_eq!(refitted.chunks.len(), anew.chunks.len());
        assert_eq!(anew.chunks.len() > 1, limit == LIMITS[1]);
        for ((a, b), slots) in refitted.chunks.iter().zip(&anew.chunks).zip(slots) {
            assert_eq!(a.slot_of_id, slots);
            let clusters = a.clusters(DVec3::ZERO);
            for (at, anew_at) in a.slot_of_id.iter().zip(b.slot_of_id.iter()).filter(|s| *s.0 != NONE) {
                assert_eq!(stored(a, *at), stored(b, *anew_at));
                let cluster = &clusters[(at / CLUSTER) as usize];
                let within = |p: [f64; 3]| {
                    (0..3).all(|k| (p[k] - f64::from(cluster.centre[k])).abs() <= f64::from(cluster.half[k]))
                };
                assert!(stored(a, *at).0.into_iter().all(within));
            }
        }
    }
}

#[test]
fn triangles_that_lost_their_area_or_moved_away_are_clustered_anew() {
    let mesh = mesh();
    let flat = moved(&mesh, |p| DVec3::new(p.x, 0.0, 0.0));
    let scattered = moved(&mesh, |p| DVec3::new((40.0 * p.x).sin(), (40.0 * p.y).cos(), (40.0 * p.z).sin()) * 9.0);
    for limit in LIMITS {
        assert!(cluster(&mesh, DVec3::ZERO, SurfaceKind::Plain, limit).refit(&mesh));
        for to in [&flat, &scattered] {
            assert!(!cluster(&mesh, DVec3::ZERO, SurfaceKind::Plain, limit).refit(to));
        }
        assert!(!cluster(&flat, DVec3::ZERO, SurfaceKind::Plain, limit).refit(&mesh));
    }
}
#[test]
fn clusters_of_moved_vertices_alone_change() {
    let mesh = mesh();
    // two triangles move
    let mut moved = mesh.clone();
    for v in [3, 500].into_iter().flat_map(|id: usize| mesh.triangles[id]) {
        moved.positions[v as usize] += DVec3::new(0.01, 0.0, -0.02);
    }
    for limit in LIMITS {
        let before = cluster(&mesh, DVec3::ZERO, SurfaceKind::Plain, limit);
        let after = before.moved(&mesh, &moved).unwrap();
        let mut refitted = before.clone();
        assert!(refitted.refit(&moved));
        let [before, refitted] = [before.with_vertices(&mesh), refitted.with_vertices(&moved)];
        let after = after.with_vertices(&moved);
        let changes = &after.moved.as_ref().unwrap().chunks;
        assert!(Arc::ptr_eq(&after.slots, &before.slots) && !Arc::ptr_eq(&after.places, &before.places));
        for (((a, b), old), changed) in after.chunks.iter().zip(&refitted.chunks).zip(&before.chunks).zip(changes) {
            assert_eq!((&a.triangles, &a.vertices), (&b.triangles, &b.vertices));
            assert_eq!(a.clusters(DVec3::ZERO), b.clusters(DVec3::ZERO));
            let groups = [a, b, old].map(|chunk| chunk.triangle_groups(DVec3::ZERO));
            assert_eq!(groups[0], groups[1]);
            let holds = |ranges: &[std::ops::Range<usize>], k: usize| ranges.iter().any(|range| range.contains(&k));
            let same = |k: usize| a.triangles[k] == old.triangles[k];
            assert!((0..a.triangles.len()).all(|k| holds(&changed.slots(), k) || same(k)));
            assert!((0..a.vertices.len()).all(|k| holds(&changed.vertices, k) != (a.vertices[k] == old.vertices[k])));
            let same = |k: usize| groups[0][k] == groups[2][k];
            assert!((0..groups[0].len()).all(|k| holds(&changed.groups(), k) || same(k)));
        }
        let count = |of: fn(&moved::MovedChunk) -> usize| changes.iter().map(of).sum::<usize>();
        let some = count(|changed| changed.clusters.iter().map(ExactSizeIterator::len).sum());
        assert!(some > 0 && some < after.chunks.iter().map(|chunk| chunk.cluster_count()).sum());
    }
}

#[test]
fn other_triangles_are_no_moved_ones() {
    let mesh = mesh();
    let clustered = cluster(&mesh, DVec3::ZERO, SurfaceKind::Plain, LIMITS[0]);
    let mut fewer = mesh.clone();
    fewer.triangles.truncate(600);
    fewer.material_of.truncate(600);
    let flat = moved(&mesh, |p| DVec3::new(p.x, 0.0, 0.0));
    let mut turned = mesh.clone();
    turned.triangles[5].swap(0, 1);
    for other in [fewer, flat, turned] {
        assert!(clustered.moved(&mesh, &other).is_none());
    }
    assert!(clustered.moved(&mesh, &mesh).is_some());
}

#[test]
fn order_codes_are_those_of_the_table_of_the_kernels() {
    for sorted in [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]] {
        // the place of file corner c in the packed triangle
        let place = [0, 1, 2].map(|c| sorted.iter().position(|s| *s == c).unwrap());
        let code = ORDER_CODES[sorted[0]][sorted[1]];
        assert_eq!(CORNER_ORDERS[code as usize], place, "{sorted:?}");
    }
}

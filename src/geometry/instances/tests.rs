use super::*;
use crate::geometry::generate::soup;
use crate::geometry::mesh::{Material, NO_COLOR, NO_UV};
use crate::testing::Rng;
use glam::Vec2;

fn matrices(count: usize) -> Vec<DAffine3> {
    let mut rng = Rng(5);
    let mut vector = |size: f64| DVec3::new(rng.unit() - 0.5, rng.unit() - 0.5, rng.unit() - 0.5) * size;
    (0..count)
        .map(|_| DAffine3 {
            matrix3: DMat3::from_cols(DVec3::X + vector(1.0), DVec3::Y + vector(1.0), DVec3::Z + vector(1.0)),
            translation: vector(30.0),
        })
        .collect()
}

fn triangle() -> Mesh {
    Mesh {
        positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y],
        triangles: vec![[0, 1, 2]],
        normals: vec![Vec3::X],
        corner_normals: vec![[0, 0, NO_NORMAL]],
        uvs: vec![Vec2::Y],
        corner_uvs: vec![[0, NO_UV, 0]],
        colors: vec![[0.5; 3]],
        corner_colors: vec![[NO_COLOR, 0, 0]],
        materials: vec![Material::default()],
        material_of: vec![0],
        ..Mesh::default()
    }
}

#[test]
fn copies_are_in_order_and_share_texture_coordinates_colours_and_materials() {
    let rotated = DMat3::from_cols(DVec3::Y, -DVec3::X, 2.0 * DVec3::Z);
    let mirror = DMat3::from_diagonal(DVec3::new(-1.0, 1.0, 1.0));
    let shear = DMat3::from_cols(DVec3::X, DVec3::Y, DVec3::new(1.0, 0.0, 1.0));
    let matrices = [rotated, mirror, shear].map(|m| DAffine3 { matrix3: m, translation: 5.0 * DVec3::Z });
    let mesh = Instances::new(vec![at_places(triangle(), matrices)]).unwrap().copies();
    let at = |x: f64, y: f64| DVec3::new(x, y, 5.0);
    let corners = [[at(0.0, 0.0), at(0.0, 1.0), at(-1.0, 0.0)], [at(0.0, 0.0), at(-1.0, 0.0), at(0.0, 1.0)]];
    assert_eq!(mesh.positions[..6], corners.concat());
    assert_eq!(mesh.triangles, [[0, 1, 2], [3, 4, 5], [6, 7, 8]]);
    // a mirrored copy keeps the order of corners, so its front and back faces are swapped
    let cross = |t: [u32; 3]| {
        let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
        (b - a).cross(c - a).z
    };
    assert_eq!([cross(mesh.triangles[0]), cross(mesh.triangles[1])], [1.0, -1.0]);
    // normals go by the inverse transpose: a shear of z along x turns the normal of the plane x = 0 towards -z
    let third = Vec3::new(1.0, 0.0, -1.0).normalize();
    assert_eq!(mesh.normals[..2], [Vec3::Y, Vec3::NEG_X]);
    assert!((mesh.normals[2] - third).length() < 1e-7);
    assert_eq!(mesh.corner_normals, [0, 1, 2].map(|k| [k, k, NO_NORMAL]));
    assert_eq!((&mesh.uvs, &mesh.materials), (&triangle().uvs, &triangle().materials));
    assert_eq!((mesh.corner_uvs, mesh.material_of), (vec![[0, NO_UV, 0]; 3], vec![0; 3]));
    assert_eq!((mesh.colors, mesh.corner_colors), (triangle().colors, vec![[NO_COLOR, 0, 0]; 3]));
    assert!(Instances::new(vec![at_places(triangle(), [])]).unwrap().copies().triangles.is_empty());
}

#[test]
fn triangles_are_found_where_their_copies_are() {
    let parts = vec![
        at_places(soup(1, 700), matrices(90)),
        (soup(2, 300), None),
        at_places(soup(4, 10), []),
        at_places(soup(3, 500), matrices(40)),
    ];
    let instances = Instances::new(parts).unwrap();
    let copies = instances.copies();
    let mut moved = instances.clone();
    [3, 95].into_iter().for_each(|k| moved.list[k].matrix = instances.list[0].matrix);
    assert!(moved.copies_again(&copies, &[3, 95].into()) == moved.copies());
    assert_eq!(instances.triangle_count(), 90 * 700 + 300 + 40 * 500);
    assert_eq!(instances.bounds(), copies.bounds());
    assert_eq!(instances.vertex_count(), copies.positions.len());
    assert_eq!(instances.unused_vertices(), copies.unused_vertices());
    assert!(instances.saves_memory());
    let mut appended = Instances::new(vec![at_places(soup(1, 700), matrices(90))]).unwrap();
    appended.append((soup(2, 300), None)).unwrap();
    appended.append(at_places(soup(4, 10), [])).unwrap();
    appended.append(at_places(soup(3, 500), matrices(40))).unwrap();
    assert!(appended == instances);
    for id in [0, 699, 700, 62_999, 63_000, 63_299, 63_300, 83_299] {
        let corners = copies.triangles[id as usize].map(|v| copies.positions[v as usize]);
        assert_eq!(instances.corners(id), corners);
    }
    for (instance, (lo, hi)) in instances.list.iter().zip(instances.boxes()) {
        let (least, most) = instances.exact_box(instance).unwrap();
        assert!(lo.cmple(least).all() && hi.cmpge(most).all());
    }
}

#[test]
fn runs_of_a_mesh_are_instances_and_vertices_without_triangles_keep_their_place() {
    let corners = [[1, 2, 3], [3, 2, 1], [5, 6, 7], [9, 8, 9]];
    let positions = (0..11).map(|k| DVec3::new(k.into(), f64::from(k * k), 1.0)).collect();
    let mesh = Mesh { positions, triangles: corners.to_vec(), material_of: vec![0; 4], ..triangle() };
    let mesh = Arc::new(Mesh { corner_normals: vec![[NO_NORMAL; 3]; 4], corner_uvs: Vec::new(), ..mesh });
    let mesh = Arc::new(Mesh { corner_colors: Vec::new(), ..Mesh::clone(&mesh) });
    let mut runs = Instances::of_runs(&mesh, [2, 0, 1].into_iter()).unwrap();
    assert!(runs.copies() == *mesh);
    assert_eq!((runs.exactly(&(0..2)), runs.exactly(&(0..3))), (Some(1..2), Some(1..4)));
    assert_eq!((runs.exactly(&(0..1)), runs.exactly(&(2..2))), (None, None));
    let third = runs.exactly(&(2..3)).unwrap().start;
    runs.list[third].matrix = Some(DAffine3::from_translation(DVec3::Z));
    let copies = runs.copies();
    let is_moved = |k: usize| copies.positions[k] != mesh.positions[k];
    assert_eq!((0..11).filter(|k| is_moved(*k)).collect::<Vec<_>>(), [5, 6, 7]);
    assert_eq!(copies.triangles, mesh.triangles);
    // the first triangle of the second run has vertices of the first run
    assert!(Instances::of_runs(&mesh, [1, 3].into_iter()).is_none());
}

#[test]
fn few_triangles_save_nothing_and_too_many_are_refused() {
    let of = |triangles: u64, places: usize| Instances::new(vec![at_places(soup(1, triangles), matrices(places))]);
    assert!(!of(100, 100).unwrap().saves_memory());
    assert!(!of(80_000, 1).unwrap().saves_memory());
    assert!(of(1 << 20, 257).unwrap_err().to_string().contains("2^28"));
}

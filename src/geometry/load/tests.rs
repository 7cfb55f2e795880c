use super::*;
use crate::geometry::places::Places;
use crate::geometry::spec::MeshSpec;
use glam::DVec3;
use std::path::PathBuf;

/// A mesh file in a folder of its own, loaded and placed with these keys.
fn load(name: &str, text: &str, keys: impl FnOnce(&mut MeshSpec)) -> Result<(Mesh, Vec<Object>)> {
    let folder = tempfile::tempdir().unwrap();
    let path: PathBuf = folder.path().join(name);
    std::fs::write(&path, text).unwrap();
    let mut spec = MeshSpec::of(MeshSource::File(path));
    keys(&mut spec);
    let loading = Loading::default();
    let (part, objects) = placed(load_unplaced(&spec, &mut Images::default(), &loading)?, &spec, &loading)?;
    Ok((copied(part, loading.limits())?, objects))
}

const GROUPS: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\ng door\nf 1 2 3\nf 3 2 1\ng wall\nf 2 1 3\n";

#[test]
fn groups_are_objects_where_that_is_asked_for() {
    let objects = |keys: fn(&mut MeshSpec)| {
        let (mesh, objects) = load("house.obj", GROUPS, keys).unwrap();
        assert_eq!(objects.iter().map(|o| o.triangles).sum::<usize>(), mesh.triangles.len());
        (mesh, objects.into_iter().map(|o| (o.name, o.triangles)).collect::<Vec<_>>())
    };
    let named = |list: &[(&str, usize)]| list.iter().map(|(n, k)| ((*n).to_owned(), *k)).collect::<Vec<_>>();
    let (mesh, one) = objects(|_| {});
    assert_eq!((mesh.positions.len(), one), (3, named(&[("house", 4)])));
    let (mesh, parts) = objects(|spec| spec.has_parts = true);
    assert_eq!(parts, named(&[("house", 1), ("door", 2), ("wall", 1)]));
    // each has vertices of its own, so that it can be moved by itself
    assert_eq!(mesh.triangles, [[0, 1, 2], [3, 4, 5], [5, 4, 3], [6, 7, 8]]);
    assert_eq!((mesh.positions[6], mesh.positions[7]), (glam::DVec3::X, glam::DVec3::ZERO));
    let (_, copies) = objects(|spec| {
        let identity = glam::DAffine3::IDENTITY;
        (spec.has_parts, spec.places) = (true, Some(Places::Given([identity, identity].into())));
    });
    let expected = [("house#0", 1), ("door#0", 2), ("wall#0", 1), ("house#1", 1), ("door#1", 2), ("wall#1", 1)];
    assert_eq!(copies, named(&expected));
}

/// A triangle with this material.
fn gltf(material: &str) -> String {
    let buffer = "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA";
    format!(
        r#"{{"asset": {{"version": "2.0"}}, "nodes": [{{"mesh": 0}}],
        "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}, "material": 0}}]}}],
        "accessors": [{{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}}],
        "bufferViews": [{{"buffer": 0, "byteLength": 36}}], "buffers": [{{"uri": "{buffer}", "byteLength": 36}}],
        "materials": [{material}]}}"#
    )
}

#[test]
fn both_faces_are_visible_unless_the_file_is_asked() {
    let is_two_sided = |material: &str, two_sided: Option<bool>| {
        load("a.gltf", &gltf(material), |spec| spec.two_sided = two_sided).unwrap().0.materials[0].two_sided
    };
    assert!(is_two_sided("{}", Some(true)) && !is_two_sided("{\"doubleSided\": true}", Some(false)));
    assert!(!is_two_sided("{}", None) && is_two_sided("{\"doubleSided\": true}", None));
    let (mesh, _) = load("a.obj", GROUPS, |spec| spec.two_sided = None).unwrap();
    assert!(mesh.materials[0].two_sided);
}

#[test]
fn unlit_materials_shine_with_their_color() {
    let unlit = "{\"name\": \"sign\", \"pbrMetallicRoughness\": {\"baseColorFactor\": [1, 0.5, 0.25, 1]}, \
                 \"extensions\": {\"KHR_materials_unlit\": {}}}";
    let (mesh, _) = load("a.gltf", &gltf(unlit), |_| {}).unwrap();
    let material = &mesh.materials[0];
    assert_eq!((material.emissive, material.diffuse, material.specular), ([1.0, 0.5, 0.25], [0.0; 3], [0.0; 3]));
    assert_eq!((material.name.as_str(), material.metallic, mesh.missing.len()), ("sign", 0.0, 0));
    let (colored, _) = load("a.gltf", &gltf(unlit), |spec| spec.color = Some([0.0, 1.0, 0.0])).unwrap();
    assert_eq!(colored.materials[0].emissive, [0.0, 1.0, 0.0]);
    // what cannot shine is lit, and listed
    let with_colors = gltf(unlit).replace("\"POSITION\": 0", "\"POSITION\": 0, \"COLOR_0\": 0");
    let (mesh, _) = load("a.gltf", &with_colors, |_| {}).unwrap();
    assert_eq!((mesh.materials[0].emissive, mesh.missing[0].what.as_str()), ([0.0; 3], "unlit material \"sign\""));
}

/// Three runs of two meshes, as of nodes of a glTF file: placed by their matrices, or copied and then placed.
#[test]
fn runs_of_a_file_lie_where_their_copies_would() {
    let two = [
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 3//1\n",
        "v 5 0 0\nv 6 0 0\nv 5 0 1\nvn 0 1 0\nf 1//1 2//1 3//1\nf 3//1 2//1 1//1\n",
    ];
    let [a, b] = two.map(|text| load("a.obj", text, |_| {}).unwrap().0);
    let turned =
        DAffine3::from_mat3_translation(place::rotation_xyz(DVec3::new(20.0, 30.0, 40.0)), DVec3::new(1.0, 2.0, 3.0));
    let stretched = DAffine3::from_scale(DVec3::new(1.0, -2.0, 0.5));
    let own = Run { triangles: 0..1, vertices: 0..3, normals: 0..1, matrix: turned };
    let other = Run { triangles: 1..3, vertices: 3..6, normals: 1..2, matrix: stretched };
    let runs = vec![own.clone(), other, Run { matrix: DAffine3::IDENTITY, ..own }];
    let part = |name: &str, triangles: usize| mesh::Part { name: name.into(), triangles };
    let parts = vec![part("a", 1), part("b", 2), part("c", 1)];
    let file = Mesh { runs, parts, ..place::merge(vec![a, b]).unwrap() };
    let loading = Loading::default();
    let spread = with_runs_copied(file.clone(), loading.limits()).unwrap();
    assert_eq!((spread.triangles.len(), spread.positions.len(), spread.runs.len(), spread.parts.len()), (4, 9, 0, 3));
    type Keys = fn(&mut MeshSpec);
    let keys: [Keys; 4] = [
        |_| {},
        |spec| spec.has_parts = true,
        |spec| (spec.scale, spec.rotate, spec.translate) = (DVec3::new(2.0, 3.0, -1.0), DVec3::X * 50.0, DVec3::Y),
        |spec| {
            let places = [DAffine3::from_translation(DVec3::X), DAffine3::from_rotation_y(1.0)];
            (spec.scale, spec.has_parts, spec.places) = (DVec3::splat(0.3), true, Some(Places::Given(places.into())));
        },
    ];
    for keys in keys {
        let mut spec = MeshSpec::of(MeshSource::Given);
        keys(&mut spec);
        let of = |mesh: &Mesh| {
            let (part, objects) = placed(mesh.clone(), &spec, &loading).unwrap();
            (copied(part, loading.limits()).unwrap(), objects)
        };
        let ((by_matrices, objects), (by_vertices, expected)) = (of(&file), of(&spread));
        assert_eq!(objects, expected);
        assert_eq!(by_matrices.triangles, by_vertices.triangles);
        assert_eq!(by_matrices.corner_normals, by_vertices.corner_normals);
        let positions = by_matrices.positions.iter().zip(&by_vertices.positions);
        assert!(positions.clone().all(|(p, q)| p.distance(*q) < 1e-14 * (1.0 + q.length())));
        let normals = by_matrices.normals.iter().zip(&by_vertices.normals);
        assert!(normals.clone().all(|(p, q)| p.distance(*q) < 1e-6));
    }
    // a scale without inverse leaves no normals
    let flat = MeshSpec { scale: DVec3::new(1.0, 0.0, 1.0), ..MeshSpec::of(MeshSource::Given) };
    let (flattened, _) = placed(file, &flat, &loading).unwrap();
    assert!(flattened.0.normals.is_empty() && flattened.0.corner_normals.is_empty());
}

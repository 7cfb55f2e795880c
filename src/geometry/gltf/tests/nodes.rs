//! Nodes, scenes and instances.

use super::*;
use crate::geometry::instances::Instances;

#[test]
fn nodes_place_instances_depth_first() {
    let mesh = load_quad(|json| {
        // another scene may have no nodes
        json["scenes"] = serde_json::json!([{ "nodes": [1, 0] }, { "name": "none" }]);
        json["nodes"] = serde_json::json!([
            {"mesh": 0, "matrix": [-2, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 5, 1]},
            {"mesh": 0, "translation": [0.1, 0, 0], "children": [3, 2]},
            {"mesh": 0, "scale": [1, 3, 1]},
            {"mesh": 0, "rotation": [0, 0, 2, 2]},
        ]);
    })
    .unwrap();
    assert_eq!(mesh.triangles.len(), 8);
    assert_eq!(mesh.triangles[6], [12, 13, 14]);
    let corner = |node: usize| mesh.positions[node * 4 + 3];
    let shift = 0.1;
    assert_eq!(corner(0), DVec3::new(1.0 + shift, 1.0, 0.0));
    // A rounding or two of f64 in the rotation.
    assert!(corner(1).distance(DVec3::new(-1.0 + shift, 1.0, 0.0)) < 4.0 * f64::EPSILON);
    assert_eq!(corner(2), DVec3::new(1.0 + shift, 3.0, 0.0));
    assert_eq!(corner(3), DVec3::new(-2.0, 1.0, 5.0));
}

#[test]
fn long_chains_of_nodes_do_not_overflow_the_stack() {
    const NODES: usize = 100_000;
    let mesh = load_quad(|json| {
        let chain = (1..NODES).map(|next| serde_json::json!({"children": [next]}));
        json["nodes"] = chain.chain([serde_json::json!({"mesh": 0})]).collect();
    });
    assert_eq!(mesh.unwrap().triangles.len(), 2);
}

#[test]
fn a_file_without_scenes_shows_its_root_nodes() {
    let mesh = load_quad(|json| {
        json.as_object_mut().unwrap().retain(|key, _| !key.starts_with("scene"));
        json["nodes"] = serde_json::json!([{"mesh": 0}, {"children": [0]}, {"mesh": 0}]);
    });
    assert_eq!(mesh.unwrap().triangles.len(), 4);
}

/// Numbers of nodes are JSON's, which f64 holds; an f32 of this size is a quarter of a meter off.
#[test]
fn transforms_of_nodes_are_f64() {
    let far = [3133805.225747891, 992857.7233499398, -5447439.535584584];
    let expected = |json: &mut serde_json::Value| json["nodes"][0]["translation"] = serde_json::json!(far);
    assert_eq!(load_quad(expected).unwrap().positions[0], DVec3::from(far));
    let [x, y, z] = far;
    let matrix = |json: &mut serde_json::Value| {
        json["nodes"][0]["matrix"] = serde_json::json!([0.1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, x, y, z, 1]);
    };
    assert_eq!(load_quad(matrix).unwrap().positions[1], DVec3::new(0.1 + x, y, z));
    // a child relative to its parent, and a node that an animation moves otherwise
    let chain = |json: &mut serde_json::Value| {
        json["nodes"] =
            serde_json::json!([{"translation": far, "children": [1]}, {"mesh": 0, "translation": [0.1, 0, 0]}]);
    };
    assert_eq!(load_quad(chain).unwrap().positions[0], DVec3::new(x + 0.1, y, z));
    let times: (&str, &[f32]) = ("SCALAR", &[0.0, 1.0]);
    let growing: (&str, &[f32]) = ("VEC3", &[1.0, 1.0, 1.0, 2.0, 2.0, 2.0]);
    let animated = load_animated(0.0, &[times, growing], |json| {
        expected(json);
        json["animations"] = animation(0, "scale");
    });
    assert_eq!(animated.unwrap().positions[0], DVec3::from(far));
}

#[test]
fn nodes_have_instances_or_are_hidden_and_are_parts() {
    let floats = |numbers: &[f32]| numbers.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>();
    let translations = floats(&[0.0, 0.0, 0.0, 5.0, 0.0, 0.0, 0.0, 7.0, 0.0]);
    let scales = floats(&[1.0, 1.0, 1.0, 2.0, 2.0, 2.0, 1.0, 1.0, 1.0]);
    let load = |edit: &dyn Fn(&mut serde_json::Value)| {
        let mut json = quad_json();
        let binary = [quad_bytes(), translations.clone(), scales.clone()].concat();
        json["buffers"][0] = serde_json::json!({"byteLength": binary.len()});
        for offset in [64, 100] {
            let views = json["bufferViews"].as_array_mut().unwrap();
            views.push(serde_json::json!({"buffer": 0, "byteOffset": offset, "byteLength": 36}));
            let accessor =
                serde_json::json!({"bufferView": views.len() - 1, "componentType": 5126, "count": 3, "type": "VEC3"});
            json["accessors"].as_array_mut().unwrap().push(accessor);
        }
        let instancing = serde_json::json!({"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": 3, "SCALE": 4}}});
        let hidden = serde_json::json!({"KHR_node_visibility": {"visible": false}});
        json["scenes"][0]["nodes"] = serde_json::json!([0, 1]);
        json["nodes"] = serde_json::json!([
            {"name": "tree", "mesh": 0, "translation": [0, 0, 1], "extensions": instancing},
            {"mesh": 0, "children": [2], "extensions": hidden},
            {"name": "below", "mesh": 0},
        ]);
        edit(&mut json);
        parse(document_glb(&json, &binary), here(&Loading::default()), &Images::default(), None)
    };
    let mesh = load(&|_| {}).unwrap();
    let tree = |triangles| Part { name: "tree".into(), triangles };
    assert_eq!(mesh.parts, vec![tree(2); 3]);
    let corner = |instance: usize| mesh.positions[4 * instance + 3];
    assert_eq!([0, 1, 2].map(corner), [DVec3::ONE, DVec3::new(7.0, 2.0, 1.0), DVec3::new(1.0, 8.0, 1.0)]);
    let fewer = load(&|json| json["accessors"][4]["count"] = 2.into()).unwrap_err().to_string();
    assert!(fewer.starts_with("node 0: its 3 instances have lists of different lengths"), "{fewer}");
    let gone =
        load(&|json| json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["SCALE"] = 9.into());
    assert!(gone.unwrap_err().to_string().contains("have accessor 9, which does not exist"));
    let all = load(&|json| drop(json["nodes"][1].as_object_mut().unwrap().remove("extensions"))).unwrap();
    assert_eq!(all.parts.len(), 5);
}

/// Nodes of two meshes in turn, of 1,200 triangles each: 2,400,000 triangles.
#[test]
fn meshes_of_many_nodes_are_read_once_where_copies_would_take_much_memory() {
    let both: [[u16; 6]; 2] = [[0, 1, 2, 2, 1, 3], [3, 1, 2, 2, 1, 0]];
    let indices: Vec<u8> = both.iter().flat_map(|own| own.repeat(600)).flat_map(u16::to_le_bytes).collect();
    let binary = [quad_bytes(), indices].concat();
    let load = |nodes: usize, edit: &dyn Fn(&mut serde_json::Value)| {
        let mut json = quad_json();
        json["buffers"][0] = serde_json::json!({"byteLength": binary.len()});
        for k in 0..2 {
            let view = serde_json::json!({"buffer": 0, "byteOffset": 64 + 7200 * k, "byteLength": 7200});
            json["bufferViews"].as_array_mut().unwrap().push(view);
            let accessor =
                serde_json::json!({"bufferView": 3 + k, "componentType": 5123, "count": 3600, "type": "SCALAR"});
            json["accessors"].as_array_mut().unwrap().push(accessor);
        }
        let mesh = |k: usize| serde_json::json!({"primitives": [{"attributes": {"POSITION": 0}, "indices": 3 + k}]});
        json["meshes"] = (0..2).map(mesh).collect();
        let node = |k: usize| {
            let translation = [k, 0, 1];
            serde_json::json!({"mesh": k % 2, "name": k.to_string(), "translation": translation, "scale": [1, -2, 1]})
        };
        json["scenes"][0]["nodes"] = (0..nodes).collect();
        json["nodes"] = (0..nodes).map(node).collect();
        edit(&mut json);
        parse(document_glb(&json, &binary), here(&Loading::default()), &Images::default(), None).unwrap()
    };
    let shared = load(2000, &|_| {});
    assert_eq!((shared.triangles.len(), shared.positions.len(), shared.runs.len()), (2400, 8, 2000));
    let parts = shared.parts.clone();
    assert_eq!((parts.len(), &parts[7]), (2000, &Part { name: "7".into(), triangles: 1200 }));
    // a place without volume has no normals, so each mesh is copied
    let copied = load(2000, &|json| json["nodes"][1999]["scale"] = serde_json::json!([1, 0, 1]));
    assert_eq!((copied.triangles.len(), copied.runs.len()), (2_400_000, 0));
    let runs = shared.runs.clone();
    let instances = Instances::new(vec![(Mesh { runs: Vec::new(), ..shared }, Some(runs.into()))]).unwrap();
    assert_eq!((instances.triangle_count(), instances.meshes().0.len()), (2_400_000, 2));
    for id in [0, 1199, 1200, 1201, 2399, 2400, 80_003, 2_398_799] {
        let corners = copied.triangles[id].map(|v| copied.positions[v as usize]);
        assert_eq!(instances.corners(id as u32), corners, "{id}");
    }
    assert_eq!(load(20, &|_| {}).runs.len(), 0);
}

//! Animations, morph targets and skins.

use super::*;

#[test]
fn animations_move_nodes_and_morph_targets() {
    let times: (&str, &[f32]) = ("SCALAR", &[0.0, 1.0]);
    let still = load_quad(|_| {}).unwrap();
    let slide: (&str, &[f32]) = ("VEC3", &[0.0, 0.0, 0.0, 2.0, -4.0, 0.0]);
    for (time, share) in [(-1.0, 0.0), (0.25, 0.25), (5.0, 1.0)] {
        let moved =
            load_animated(time, &[times, slide], |json| json["animations"] = animation(0, "translation")).unwrap();
        let by = share * DVec3::new(2.0, -4.0, 0.0);
        assert!(moved.positions.iter().zip(&still.positions).all(|(p, q)| *p == *q + by), "{time}");
        assert_eq!(moved.triangles, still.triangles);
    }
    // a target that lifts the second vertex, by a weight that grows from 0 to 3
    let weights: (&str, &[f32]) = ("SCALAR", &[0.0, 3.0]);
    let lift: (&str, &[f32]) = ("VEC3", &[0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    let morphed = load_animated(0.5, &[times, weights, lift], |json| {
        json["animations"] = animation(0, "weights");
        json["meshes"][0]["primitives"][0]["targets"] = serde_json::json!([{ "POSITION": 5 }]);
    });
    let expected: Vec<DVec3> =
        still.positions.iter().enumerate().map(|(k, p)| *p + DVec3::Z * if k == 1 { 1.5 } else { 0.0 }).collect();
    assert_eq!(morphed.unwrap().positions, expected);
}

#[test]
fn skins_move_vertices_with_their_joints() {
    let times: (&str, &[f32]) = ("SCALAR", &[0.0, 1.0]);
    let (sin, cos) = std::f32::consts::FRAC_PI_4.sin_cos();
    let turn: (&str, &[f32]) = ("VEC4", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, sin, cos]);
    // vertices 0 and 1 are bound to the first joint, 2 to the second, 3 to both by half
    let joints: (&str, &[f32]) =
        ("VEC4", &[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0]);
    let weights: (&str, &[f32]) =
        ("VEC4", &[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.5, 0.5, 0.0, 0.0]);
    let mut bind = [0.0; 32];
    for k in 0..4 {
        (bind[5 * k], bind[16 + 5 * k]) = (1.0, 1.0);
    }
    // the second joint is bound at (0, 1, 0)
    bind[16 + 13] = -1.0;
    let mesh = load_animated(1.0, &[times, turn, joints, weights, ("MAT4", &bind)], |json| {
        json["animations"] = animation(2, "rotation");
        json["scenes"] = serde_json::json!([{ "nodes": [0, 1] }]);
        // the node's own place does not count, and the first joint stands at (5, 0, 0)
        json["nodes"] = serde_json::json!([
            { "mesh": 0, "skin": 0, "translation": [100, 0, 0] },
            { "translation": [5, 0, 0], "children": [2] },
            { "translation": [0, 1, 0] },
        ]);
        json["skins"] = serde_json::json!([{ "joints": [1, 2], "inverseBindMatrices": 7 }]);
        let attributes = json["meshes"][0]["primitives"][0]["attributes"].as_object_mut().unwrap();
        attributes.insert("JOINTS_0".into(), 5.into());
        attributes.insert("WEIGHTS_0".into(), 6.into());
    })
    .unwrap();
    // the second joint turns by 90 degrees about (5, 1, 0): what was at (1, 1, 0) is at (5, 2, 0)
    let by_first = DVec3::new(6.0, 1.0, 0.0);
    let by_second = DVec3::new(5.0, 2.0, 0.0);
    let expected =
        [DVec3::new(5.0, 0.0, 0.0), DVec3::new(6.0, 0.0, 0.0), DVec3::new(5.0, 1.0, 0.0), 0.5 * (by_first + by_second)];
    for (p, q) in mesh.positions.iter().zip(expected) {
        assert!((*p - q).length() < 1e-7, "{p} is not {q}");
    }
}

#[test]
fn a_vertex_has_all_its_joints_and_one_without_weights_its_first() {
    let times: (&str, &[f32]) = ("SCALAR", &[0.0, 1.0]);
    let slide: (&str, &[f32]) = ("VEC3", &[0.0, 0.0, 0.0, 8.0, 0.0, 0.0]);
    let (mut joints, mut weights, mut more) = ([0.0; 16], [0.0; 16], [0.0; 16]);
    // vertex 0 follows joint 0 by 3/4 and, in the second set, joint 1 by 1/4; vertex 1 no joint, its first being joint 1
    (weights[0], more[0], joints[4]) = (0.75, 0.25, 1.0);
    (weights[8], weights[12]) = (1.0, 1.0);
    let second: Vec<f32> = (0..16).map(|k| if k % 4 == 0 { 1.0 } else { 0.0 }).collect();
    let lists = [times, slide, ("VEC4", &joints), ("VEC4", &weights), ("VEC4", &second), ("VEC4", &more)];
    let moved = load_animated(1.0, &lists, |json| {
        json["animations"] = animation(2, "translation");
        json["scenes"] = serde_json::json!([{ "nodes": [0, 1, 2] }]);
        json["nodes"] = serde_json::json!([{ "mesh": 0, "skin": 0 }, {}, {}]);
        json["skins"] = serde_json::json!([{ "joints": [1, 2] }]);
        let attributes = json["meshes"][0]["primitives"][0]["attributes"].as_object_mut().unwrap();
        for (k, name) in ["JOINTS_0", "WEIGHTS_0", "JOINTS_1", "WEIGHTS_1"].into_iter().enumerate() {
            attributes.insert(name.into(), (5 + k).into());
        }
    });
    let still = load_quad(|_| {}).unwrap().positions;
    let by: Vec<f64> = moved.unwrap().positions.iter().zip(&still).map(|(p, q)| (*p - *q).x).collect();
    assert_eq!(by, [2.0, 8.0, 0.0, 0.0]);
}

#[test]
fn what_is_no_part_of_a_mesh_is_passed_over() {
    // an attribute of an application's own
    let mesh = load_quad(|json| json["meshes"][0]["primitives"][0]["attributes"]["_FEATURE_ID_0"] = 2.into());
    assert_eq!(mesh, load_quad(|_| {}));
    // a channel that moves a material's colour, and one that moves no node
    let times: (&str, &[f32]) = ("SCALAR", &[0.0, 1.0]);
    let slide: (&str, &[f32]) = ("VEC3", &[0.0, 0.0, 0.0, 2.0, -4.0, 0.0]);
    for target in [serde_json::json!({ "node": 0, "path": "pointer" }), serde_json::json!({ "path": "pointer" })] {
        let moved = load_animated(1.0, &[times, slide], |json| {
            json["animations"] = animation(0, "translation");
            json["animations"][0]["channels"]
                .as_array_mut()
                .unwrap()
                .push(serde_json::json!({ "sampler": 0, "target": target }));
            json["extensionsUsed"] = serde_json::json!(["KHR_animation_pointer"]);
        });
        assert_eq!(moved.unwrap().positions[0], load_quad(|_| {}).unwrap().positions[0] + DVec3::new(2.0, -4.0, 0.0));
    }
}

#[test]
fn wrong_animations_are_refused_in_one_line() {
    let times: (&str, &[f32]) = ("SCALAR", &[0.0, 1.0]);
    let refused = |more: &[(&str, &[f32])], edit: &dyn Fn(&mut serde_json::Value)| {
        let error = load_animated(0.5, more, |json| edit(json)).unwrap_err().to_string();
        assert!(!error.contains('\n'), "{error}");
        error
    };
    let one: (&str, &[f32]) = ("VEC3", &[0.0, 0.0, 0.0]);
    let translation = |json: &mut serde_json::Value| json["animations"] = animation(0, "translation");
    for (text, says) in [
        (refused(&[times, one], &|_| {}), "has no animation \"a\"; it has none"),
        (refused(&[times, one], &translation), "animation 0, channel 0: 3 numbers for 2 times"),
        (refused(&[("SCALAR", &[1.0, 0.0]), ("VEC3", &[0.0; 6])], &translation), "its times must ascend"),
        (
            refused(&[times, one], &|json| json["animations"] = animation(7, "translation")),
            "animation 0: an index is out of range",
        ),
        (
            refused(&[times, one], &|json| {
                translation(json);
                json["animations"][0]["samplers"][0]["interpolation"] = "FOO".into();
            }),
            "animation 0, channel 0: its interpolation is none of LINEAR",
        ),
    ] {
        assert!(text.contains(says), "{text}");
    }
}

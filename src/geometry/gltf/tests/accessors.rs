//! Accessors, buffers and containers: what a file stores, and files that are damaged.

use super::*;
use crate::testing::model;
use proptest::prelude::*;
use std::sync::Arc;

/// The key in the text of [`quad_json`] without which the buffer is that of a GLB; keys are sorted.
const WITH_URI: &str = ",\"uri\":\"quad.bin\"";

#[test]
fn external_inline_and_binary_buffers_are_the_same() {
    let external = load_quad(|_| {}).unwrap();
    assert_eq!(external.triangles, [[0, 1, 2], [2, 1, 3]]);
    assert_eq!(external.positions[3], DVec3::new(1.0, 1.0, 0.0));
    let default = Material { two_sided: false, ..Material::default() };
    assert_eq!((&external.material_of[..], &external.materials[..]), (&[0, 0][..], &[default][..]));
    let uri = "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAACAPwAAgD8AAAAA\
               AAABAAIAAgABAAMAAAECAw==";
    assert_eq!(load_quad(|json| json["buffers"][0]["uri"] = uri.into()).unwrap(), external);
    assert_eq!(parse(quad_glb(), here(&Loading::default()), &Images::default(), None).unwrap(), external);
}

#[test]
fn strips_and_fans_wind_as_specified() {
    let primitive = |mode: u32, indices: bool| {
        load_quad(|json| {
            let primitive = &mut json["meshes"][0]["primitives"][0];
            primitive["mode"] = mode.into();
            primitive["indices"] = 2.into();
            if !indices {
                primitive.as_object_mut().unwrap().remove("indices");
            }
        })
    };
    for indices in [false, true] {
        assert_eq!(primitive(5, indices).unwrap().triangles, [[0, 1, 2], [1, 3, 2]]);
        assert_eq!(primitive(6, indices).unwrap().triangles, [[1, 2, 0], [2, 3, 0]]);
        assert!(primitive(4, indices).unwrap_err().to_string().contains("4 corners are not whole triangles"));
        assert!(primitive(1, indices).unwrap_err().to_string().contains("has no triangles"));
    }
}

#[test]
fn sparse_and_quantised_values_are_read() {
    let sparse = load_quad(|json| {
        json["accessors"][0]["sparse"] = serde_json::json!({
            "count": 2,
            "indices": {"bufferView": 2, "componentType": 5121, "byteOffset": 1},
            "values": {"bufferView": 0, "byteOffset": 24},
        });
    })
    .unwrap();
    assert_eq!(sparse.positions[1..3], [DVec3::Y, DVec3::new(1.0, 1.0, 0.0)]);
    let quantised = load_quad(|json| {
        json["extensionsRequired"] = serde_json::json!(["KHR_mesh_quantization", "KHR_materials_unlit"]);
        json["extensionsUsed"] = json["extensionsRequired"].clone();
        json["accessors"][0] = serde_json::json!(
            {"bufferView": 1, "componentType": 5121, "count": 4, "type": "VEC3", "normalized": true});
        json["accessors"][1]["count"] = 3.into();
    })
    .unwrap();
    assert_eq!(quantised.positions[0], DVec3::new(0.0, 0.0, 1.0 / 255.0));
}

#[test]
fn wrong_documents_say_where() {
    type Edit = fn(&mut serde_json::Value);
    let cases: [(Edit, &str); 17] = [
        (|j| j["accessors"][0]["count"] = 5.into(), "accessor 0: exceeds buffer view 0 of 48 bytes"),
        (|j| j["accessors"][0]["byteOffset"] = u64::MAX.into(), "accessor 0: exceeds buffer view 0"),
        (|j| j["accessors"][1]["count"] = u64::MAX.into(), "more than 2^28"),
        (|j| j["accessors"][0]["count"] = 3.into(), "accessor 1: index 3 of 3 vertices"),
        (|j| j["accessors"][1]["componentType"] = 5126.into(), "accessor 1: must hold unsigned integers"),
        (|j| j["accessors"][0]["type"] = "VEC2".into(), "accessor 0: must hold vectors of 3"),
        (|j| j["bufferViews"][0]["byteLength"] = 480.into(), "buffer view 0 exceeds its buffer of 64 bytes"),
        (|j| j["bufferViews"][0]["byteStride"] = 4.into(), "stride 4 of buffer view 0"),
        (|j| j["buffers"][0]["byteLength"] = 65.into(), "buffer 0: has 64 of its 65 bytes"),
        (|j| j["buffers"][0]["uri"] = "no.bin".into(), "no.bin cannot be read"),
        (|j| j["buffers"][0]["uri"] = "https://a.b/c.bin".into(), "buffer 0: lies elsewhere"),
        (|j| j["meshes"][0]["primitives"][0]["indices"] = 9.into(), "indices: index out of range"),
        (|j| j["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = 3.into(), "primitive 0: accessor 3 of 3"),
        (|j| j["nodes"][0]["children"] = serde_json::json!([0]), "node 0 is reached twice"),
        (|j| j["extensionsRequired"] = serde_json::json!(["ACME_compression"]), "ACME_compression"),
        (|j| j["asset"]["version"] = "1.0".into(), "glTF version \"1.0\""),
        (|j| j["nodes"][0]["rotation"] = serde_json::json!([0, 0, 0, 0]), "not finite"),
    ];
    for (edit, expected) in cases {
        let message = load_quad(edit).unwrap_err().to_string();
        assert!(message.contains("quad.gltf: ") && message.contains(expected), "{expected}: {message}");
        assert!(!message.contains('\n'), "{message}");
    }
    for bytes in [
        &b""[..],
        b"[\"KHR_animation_pointer\"]",
        b"{\"animations\": [\"KHR_animation_pointer\"]}",
        b"glTF",
        b"glTF\x02\0\0\0\xff\0\0\0",
        b"{}",
        b"[1]",
        b"\xff\xfe",
    ] {
        assert!(matches!(parse(bytes, here(&Loading::default()), &Images::default(), None), Err(Error::Input(_))));
    }
    assert!(
        load(Path::new("no/such.glb"), Files::Below, &Images::default(), None, &Loading::default())
            .unwrap_err()
            .to_string()
            .starts_with("no/such.glb: cannot be read")
    );
}

#[test]
fn files_outside_of_the_folder_are_refused_unless_allowed() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path().join("model");
    std::fs::create_dir_all(folder.join("parts")).unwrap();
    std::fs::write(place.path().join("quad.bin"), quad_bytes()).unwrap();
    std::fs::write(folder.join("parts/quad.bin"), quad_bytes()).unwrap();
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("../quad.bin", folder.join("out.bin")).unwrap();
        std::os::unix::fs::symlink("parts/quad.bin", folder.join("in.bin")).unwrap();
        std::os::unix::fs::symlink("..", folder.join("up")).unwrap();
    }
    let path = folder.join("quad.gltf");
    let load = |uri: &str, files: Files| {
        let mut json = quad_json();
        json["buffers"][0]["uri"] = uri.into();
        std::fs::write(&path, serde_json::to_vec(&json).unwrap()).unwrap();
        load(&path, files, &Images::default(), None, &Loading::default())
    };
    let absolute = place.path().join("quad.bin").display().to_string();
    let mut outside =
        vec!["../quad.bin", "%2e%2E/quad.bin", "parts/../../quad.bin", "../model/parts/quad.bin", &absolute];
    let mut inside = vec!["parts/quad.bin", "./parts/../parts/quad.bin"];
    if cfg!(unix) {
        outside.extend(["out.bin", "up/quad.bin"]);
        inside.push("in.bin");
    }
    for uri in outside {
        let message = load(uri, Files::Below).unwrap_err().to_string();
        assert!(
            message.contains("buffer 0: ") && message.contains("is outside of the glTF's folder"),
            "{uri}: {message}"
        );
        load(uri, Files::Anywhere).unwrap();
    }
    inside.iter().for_each(|uri| drop(load(uri, Files::Below).unwrap()));
    // only regular files are read, even with `Files::Anywhere`
    let message = load("/dev/zero", Files::Anywhere).unwrap_err().to_string();
    assert!(message.contains("/dev/zero cannot be read: it is a pipe or a device, not a regular file"), "{message}");
}

#[test]
fn buffers_of_one_file_share_its_bytes() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("quad.bin"), quad_bytes()).unwrap();
    let mut json = quad_json();
    let buffer = json["buffers"][0].clone();
    json["buffers"] = vec![buffer; 3].into();
    let bytes = serde_json::to_vec(&json).unwrap();
    let source = Source::parse(
        (&bytes).into(),
        FileAccess { folder: folder.path(), files: Files::Below, loading: &Loading::default() },
    )
    .unwrap();
    assert!(source.buffers.len() == 3 && source.buffers.iter().all(|b| Arc::ptr_eq(b, &source.buffers[0])));
}

#[test]
fn models_have_the_counts_and_bounds_of_their_list() {
    for (name, triangles, low, high) in [
        ("gltf/BoxTextured.glb", 12, [-0.5, -0.5, -0.5], [0.5, 0.5, 0.5]),
        ("gltf/CesiumMilkTruck.glb", 3624, [-2.431, 0.00145, -1.396], [2.438, 2.584, 1.396]),
        ("gltf/Duck.glb", 4212, [-0.693, 0.09929, -0.6133], [0.9618, 1.64, 0.5393]),
        ("kenney-city/building-garage.glb", 196, [-0.5, 0.0, -0.5], [0.5, 0.55, 0.5]),
        ("kaykit-city/gltf/building_H.gltf", 1885, [-1.003, 0.0, -1.0], [1.003, 3.05, 1.0]),
    ] {
        let Some(path) = model(name) else { continue };
        let mesh = load(&path, Files::Below, &Images::default(), None, &Loading::default()).unwrap();
        assert_eq!(mesh.triangles.len(), triangles, "{name}");
        assert_eq!((mesh.corner_normals.len(), mesh.material_of.len()), (triangles, triangles));
        assert!(mesh.normals.iter().all(|n| n.is_normalized()));
        let used = || mesh.triangles.iter().flatten().map(|&i| mesh.positions[i as usize]);
        let (min, max) = (used().reduce(DVec3::min).unwrap(), used().reduce(DVec3::max).unwrap());
        // The list gives four digits (the truck's lowest point is measured here: its wheels are turned).
        const ROUNDED: f64 = 1e-3;
        assert!((min - DVec3::from(low)).abs().max_element() < ROUNDED, "{name}: {min}");
        assert!((max - DVec3::from(high)).abs().max_element() < ROUNDED, "{name}: {max}");
    }
}

#[test]
fn more_vertices_than_memory_has_are_refused_before_they_are_made() {
    let huge = load_quad(|json| {
        // 64 GiB of vertices of which one is said
        json["accessors"][0] = serde_json::json!({ "componentType": 5126, "count": 3u32 << 28, "type": "VEC3",
            "sparse": { "count": 1, "indices": { "bufferView": 2, "componentType": 5121 }, "values": { "bufferView": 0 } } });
    });
    let text = huge.unwrap_err().to_string();
    assert!(text.contains("a mesh of 805306368 vertices takes about"), "{text}");
}

/// Khronos' validator finds no error in any of these.
#[test]
fn valid_files_are_read() {
    let quad = load_quad(|_| {}).unwrap();
    // an accessor without a buffer view holds zeros: a morph target that moves nothing
    let zeros = load_quad(|json| {
        json["accessors"]
            .as_array_mut()
            .unwrap()
            .push(serde_json::json!({"componentType": 5126, "count": 4, "type": "VEC3"}));
        json["meshes"][0]["primitives"][0]["targets"] = serde_json::json!([{"POSITION": 3}]);
    });
    assert_eq!(zeros.unwrap(), quad);
    let flat = load_quad(|json| drop(json["accessors"][0].as_object_mut().unwrap().remove("bufferView"))).unwrap();
    assert_eq!(flat.positions, [DVec3::ZERO; 4]);
    // integers that are written as other numbers
    let text = serde_json::to_string(&quad_json()).unwrap().replace("\"count\":6", "\"count\":6.0");
    let text = text.replace("\"byteLength\":48", "\"byteLength\":4.8e1").replace(WITH_URI, "");
    let parse = |bytes: &[u8]| parse(bytes, here(&Loading::default()), &Images::default(), None);
    assert_eq!(parse(&glb(text.as_bytes(), &quad_bytes())).unwrap(), quad);
    // chunks that are not padded, or whose sizes leave the padding out
    for blanks in 1..4 {
        let json = format!("{text}{}", " ".repeat((4 - text.len() % 4) % 4 + blanks));
        assert_eq!(parse(&glb(json.as_bytes(), &quad_bytes())).unwrap(), quad, "{blanks}");
        let mut padded = glb(json.as_bytes(), &quad_bytes());
        let end = 20 + json.len();
        padded.splice(end..end, vec![b' '; 4 - blanks]);
        let length = (padded.len() as u32).to_le_bytes();
        padded[8..12].copy_from_slice(&length);
        assert_eq!(parse(&padded).unwrap(), quad, "{blanks}");
    }
    // a channel without a target is passed over
    let times: (&str, &[f32]) = ("SCALAR", &[0.0, 1.0]);
    let slide: (&str, &[f32]) = ("VEC3", &[0.0, 0.0, 0.0, 2.0, -4.0, 0.0]);
    let moved = load_animated(1.0, &[times, slide], |json| {
        json["animations"] = animation(0, "translation");
        let channels = json["animations"][0]["channels"].as_array_mut().unwrap();
        channels.push(serde_json::json!({"sampler": 0, "target": {"path": "rotation"}}));
    });
    assert_eq!(moved.unwrap().positions[0], DVec3::new(2.0, -4.0, 0.0));
}

proptest! {
    #[test]
    fn damaged_files_do_not_panic(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..4),
        cut in any::<prop::sample::Index>(),
        is_cut: bool,
    ) {
        let mut bytes = quad_glb();
        for (place, value) in changes {
            let place = place.index(bytes.len());
            bytes[place] = value;
        }
        bytes.truncate(if is_cut { cut.index(bytes.len()) } else { bytes.len() });
        let _ = parse(&bytes, here(&Loading::default()), &Images::default(), None);
    }

    #[test]
    fn damaged_numbers_do_not_panic(place in 0usize..40, value: u64) {
        let text = serde_json::to_string(&quad_json()).unwrap();
        assert!(text.contains(WITH_URI));
        let numbers: Vec<&str> = text.matches(|c: char| c.is_ascii_digit()).collect();
        let place = place % numbers.len();
        let at = text.match_indices(|c: char| c.is_ascii_digit()).nth(place).unwrap().0;
        let changed = format!("{}{value}{}", &text[..at], &text[at + 1..]);
        let _ = parse(glb(changed.replace(WITH_URI, "").as_bytes(), &quad_bytes()), here(&Loading::default()), &Images::default(), None);
    }
}

//! Buffers compressed by meshoptimizer, and meshes compressed by Draco.

use super::*;

/// A GLB of the quad whose positions and indices are compressed, after `edit`.
#[cfg(feature = "simplify")]
fn load_compressed(edit: impl FnOnce(&mut serde_json::Value)) -> Result<Mesh> {
    let positions = [[0.0f32, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]];
    let exponents = ::meshopt::encode_filter_exp(&positions, 24, ::meshopt::EncodeExpMode::Separate);
    let vertices = ::meshopt::encode_vertex_buffer(&exponents).unwrap();
    let indices = ::meshopt::encode_index_buffer(&[0, 1, 2, 2, 1, 3], 4).unwrap();
    let binary = [&vertices[..], &indices].concat();
    let mut json = quad_json();
    let form = |offset: usize, length: usize, rest: serde_json::Value| {
        let mut form = serde_json::json!({"buffer": 0, "byteOffset": offset, "byteLength": length});
        form.as_object_mut().unwrap().extend(rest.as_object().unwrap().clone());
        serde_json::json!({"buffer": 1, "byteLength": 48, "extensions": {"EXT_meshopt_compression": form}})
    };
    let of_vertices = serde_json::json!({"byteStride": 12, "count": 4, "mode": "ATTRIBUTES", "filter": "EXPONENTIAL"});
    let of_indices = serde_json::json!({"byteStride": 2, "count": 6, "mode": "TRIANGLES"});
    json["bufferViews"] =
        vec![form(0, vertices.len(), of_vertices), form(vertices.len(), indices.len(), of_indices)].into();
    json["accessors"].as_array_mut().unwrap().truncate(2);
    let fallback = serde_json::json!({"byteLength": 60, "extensions": {"EXT_meshopt_compression": {"fallback": true}}});
    json["buffers"] = vec![serde_json::json!({"byteLength": binary.len()}), fallback].into();
    json["extensionsRequired"] = vec!["EXT_meshopt_compression"].into();
    edit(&mut json);
    parse(document_glb(&json, &binary), here(&Loading::default()), &Images::default(), None)
}

#[test]
#[cfg(feature = "simplify")]
fn compressed_buffer_views_are_decoded() {
    let (mesh, plain) = (load_compressed(|_| {}).unwrap(), load_quad(|_| {}).unwrap());
    assert_eq!((&mesh.positions, &mesh.triangles), (&plain.positions, &plain.triangles));
    assert!(mesh.missing.is_empty(), "{:?}", mesh.missing);
    let wrong = |view: usize, key: &str, value: serde_json::Value| {
        let damaged =
            load_compressed(|json| json["bufferViews"][view]["extensions"]["EXT_meshopt_compression"][key] = value);
        damaged.unwrap_err().to_string()
    };
    for (view, key, value, what) in [
        (0, "byteLength", 9.into(), "is damaged"),
        (0, "byteLength", 9999.into(), "exceeds its buffer"),
        (0, "buffer", 7.into(), "exceeds its buffer"),
        (0, "count", "four".into(), "has no count"),
        (0, "count", u64::MAX.into(), "is over 4 GiB"),
        (0, "byteStride", 6.into(), "is damaged"),
        (0, "filter", "OCTAHEDRAL".into(), "has a filter or a stride"),
        (0, "mode", "POINTS".into(), "is damaged"),
        (1, "count", 5.into(), "is damaged"),
        (1, "mode", "INDICES".into(), "is damaged"),
    ] {
        let message = wrong(view, key, value);
        assert!(message.starts_with(&format!("buffer view {view}: its compressed form {what}")), "{key}: {message}");
    }
}

/// The quad, its positions and indices in Draco's form behind a byte, after `edit`; the form's bytes may be cut.
#[cfg(feature = "draco")]
fn load_draco(length: Option<usize>, edit: impl FnOnce(&mut serde_json::Value)) -> Result<Mesh> {
    use draco_core::{
        DataType, EncoderBuffer, EncoderOptions, FaceIndex, GeometryAttributeType, MeshEncoder, PointAttribute,
    };
    let mut positions = PointAttribute::new();
    positions.init(GeometryAttributeType::Position, 3, DataType::Float32, false, 4);
    positions.buffer_mut().write(0, &quad_bytes()[..48]);
    let mut own = draco_core::mesh::Mesh::new();
    own.add_attribute(positions);
    own.set_num_faces(2);
    own.set_face(FaceIndex(0), [0u32, 1, 2].map(Into::into));
    own.set_face(FaceIndex(1), [2u32, 1, 3].map(Into::into));
    let (mut encoder, mut encoded) = (MeshEncoder::new(), EncoderBuffer::new());
    encoder.set_mesh(own);
    encoder.encode(&EncoderOptions::new(), &mut encoded).unwrap();
    let binary = [&[0][..], encoded.data()].concat();
    let mut json = quad_json();
    json["buffers"] = vec![serde_json::json!({"byteLength": binary.len()})].into();
    let length = length.unwrap_or(binary.len() - 1);
    json["bufferViews"] = vec![serde_json::json!({"buffer": 0, "byteOffset": 1, "byteLength": length})].into();
    json["accessors"].as_array_mut().unwrap().truncate(2);
    for accessor in json["accessors"].as_array_mut().unwrap() {
        accessor.as_object_mut().unwrap().remove("bufferView");
    }
    json["meshes"][0]["primitives"][0]["extensions"] =
        serde_json::json!({"KHR_draco_mesh_compression": {"bufferView": 0, "attributes": {"POSITION": 0}}});
    json["extensionsRequired"] = vec!["KHR_draco_mesh_compression"].into();
    edit(&mut json);
    parse(document_glb(&json, &binary), here(&Loading::default()), &Images::default(), None)
}

#[test]
#[cfg(feature = "draco")]
fn draco_meshes_are_decoded() {
    let (mesh, plain) = (load_draco(None, |_| {}).unwrap(), load_quad(|_| {}).unwrap());
    // the encoder may list vertices, and the corners of a face, in another order
    let places = |mesh: &Mesh| {
        let corners = |t: &[u32; 3]| {
            let mut corners = t.map(|k| mesh.positions[k as usize].to_array());
            let least = (0..3).min_by(|a, b| corners[*a].partial_cmp(&corners[*b]).unwrap()).unwrap();
            corners.rotate_left(least);
            corners
        };
        let mut all: Vec<_> = mesh.triangles.iter().map(corners).collect();
        all.sort_by(|a, b| a.partial_cmp(b).unwrap());
        all
    };
    assert_eq!(places(&mesh), places(&plain));
    assert!(mesh.missing.is_empty(), "{:?}", mesh.missing);
    let accessor =
        |k: usize, count: u32| move |json: &mut serde_json::Value| json["accessors"][k]["count"] = count.into();
    let id = |json: &mut serde_json::Value| {
        json["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"]["attributes"]["POSITION"] =
            7.into();
    };
    for (result, what) in [
        (load_draco(Some(20), |_| {}), "is damaged"),
        (load_draco(Some(9999), |_| {}), "exceeds its buffer"),
        (load_draco(None, accessor(0, 5)), "has other numbers of vertices"),
        (load_draco(None, accessor(1, 9)), "has other numbers of vertices"),
        (load_draco(None, id), "lacks an attribute"),
    ] {
        let message = result.unwrap_err().to_string();
        let start = format!("mesh 0, primitive 0: its form by KHR_draco_mesh_compression {what}");
        assert!(message.starts_with(&start), "{message}");
    }
}

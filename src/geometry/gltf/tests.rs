//! A quad as a document, which the tests of this folder edit and load.

mod accessors;
mod animations;
#[cfg(any(feature = "simplify", feature = "draco"))]
mod compressed;
mod materials;
mod nodes;

use super::*;

fn here(loading: &Loading) -> FileAccess<'_> {
    FileAccess { folder: Path::new(""), files: Files::Below, loading }
}

/// The bytes of a quad's four positions (f32), six u16 indices and a strip's four u8 indices: 64 bytes.
fn quad_bytes() -> Vec<u8> {
    let mut bytes: Vec<u8> =
        [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0].iter().flat_map(|v| v.to_le_bytes()).collect();
    bytes.extend([0u16, 1, 2, 2, 1, 3].iter().flat_map(|i| i.to_le_bytes()));
    bytes.extend([0, 1, 2, 3]);
    bytes
}

/// A document over [`quad_bytes`] in `quad.bin`: accessor 0 the positions, 1 the triangles', 2 the strip's indices.
fn quad_json() -> serde_json::Value {
    serde_json::json!({
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]},
            {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"},
            {"bufferView": 2, "componentType": 5121, "count": 4, "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteLength": 48},
            {"buffer": 0, "byteOffset": 48, "byteLength": 12},
            {"buffer": 0, "byteOffset": 60, "byteLength": 4},
        ],
        "buffers": [{"uri": "quad.bin", "byteLength": 64}],
    })
}

/// Loads the quad's document after `edit`.
fn load_quad(edit: impl FnOnce(&mut serde_json::Value)) -> Result<Mesh> {
    let folder = tempfile::tempdir().unwrap();
    let mut json = quad_json();
    edit(&mut json);
    std::fs::write(folder.path().join("quad.bin"), quad_bytes()).unwrap();
    let path = folder.path().join("quad.gltf");
    std::fs::write(&path, serde_json::to_vec(&json).unwrap()).unwrap();
    load(&path, Files::Below, &Images::default(), None, &Loading::default())
}

fn glb(json: &[u8], binary: &[u8]) -> Vec<u8> {
    let mut bytes = b"glTF\x02\0\0\0".to_vec();
    bytes.extend(((12 + 8 + json.len() + 8 + binary.len()) as u32).to_le_bytes());
    for (kind, chunk) in [(b"JSON", json), (b"BIN\0", binary)] {
        bytes.extend((chunk.len() as u32).to_le_bytes());
        bytes.extend(kind);
        bytes.extend(chunk);
    }
    bytes
}

/// A GLB of a document and its binary buffer.
fn document_glb(json: &serde_json::Value, binary: &[u8]) -> Vec<u8> {
    let mut text = serde_json::to_vec(json).unwrap();
    text.resize(text.len().next_multiple_of(4), b' ');
    glb(&text, binary)
}

fn quad_glb() -> Vec<u8> {
    let mut json = quad_json();
    json["buffers"][0].as_object_mut().unwrap().remove("uri");
    document_glb(&json, &quad_bytes())
}

/// The quad's document after `edit`, at a time of its animation "a". `more.bin` has these numbers, each list a view and an accessor of its
/// own from number 3 on.
fn load_animated(time: f64, more: &[(&str, &[f32])], edit: impl FnOnce(&mut serde_json::Value)) -> Result<Mesh> {
    let folder = tempfile::tempdir().unwrap();
    let mut json = quad_json();
    let mut bytes: Vec<u8> = Vec::new();
    for (kind, numbers) in more {
        let width = match *kind {
            "SCALAR" => 1,
            "VEC3" => 3,
            "VEC4" => 4,
            _ => 16,
        };
        let views = json["bufferViews"].as_array_mut().unwrap();
        views.push(serde_json::json!({ "buffer": 1, "byteOffset": bytes.len(), "byteLength": 4 * numbers.len() }));
        let view = views.len() - 1;
        json["accessors"].as_array_mut().unwrap().push(serde_json::json!({
            "bufferView": view, "componentType": 5126, "count": numbers.len() / width, "type": kind
        }));
        bytes.extend(numbers.iter().flat_map(|v| v.to_le_bytes()));
    }
    let buffer = serde_json::json!({ "uri": "more.bin", "byteLength": bytes.len() });
    json["buffers"].as_array_mut().unwrap().push(buffer);
    edit(&mut json);
    std::fs::write(folder.path().join("quad.bin"), quad_bytes()).unwrap();
    std::fs::write(folder.path().join("more.bin"), bytes).unwrap();
    let path = folder.path().join("quad.gltf");
    std::fs::write(&path, serde_json::to_vec(&json).unwrap()).unwrap();
    load(&path, Files::Below, &Images::default(), Some(&AnimationSpec { name: "a".into(), time }), &Loading::default())
}

/// One channel of an animation "a" by accessors 3 and 4.
fn animation(node: usize, path: &str) -> serde_json::Value {
    serde_json::json!([{
        "name": "a",
        "channels": [{ "sampler": 0, "target": { "node": node, "path": path } }],
        "samplers": [{ "input": 3, "output": 4 }],
    }])
}

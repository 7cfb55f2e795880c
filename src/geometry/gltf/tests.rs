use glam::{Vec2, Vec3};
use proptest::prelude::*;

use super::*;
use crate::geometry::mesh::Missing;
use crate::geometry::spec::AnimationSpec;
use crate::geometry::texture::Wrap;
use crate::testing::model;
use std::sync::Arc;

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

/// The key in the text of [`quad_json`] without which the buffer is that of a GLB; keys are sorted.
const WITH_URI: &str = ",\"uri\":\"quad.bin\"";

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

fn quad_glb() -> Vec<u8> {
    let mut json = quad_json();
    json["buffers"][0].as_object_mut().unwrap().remove("uri");
    let mut text = serde_json::to_vec(&json).unwrap();
    text.resize(text.len().next_multiple_of(4), b' ');
    glb(&text, &quad_bytes())
}

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
    assert_eq!(parse(&quad_glb(), here(&Loading::default()), &Images::default(), None).unwrap(), external);
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
fn normals_and_colours_are_placed() {
    let mesh = load_quad(|json| {
        json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = 0.into();
        json["meshes"][0]["primitives"][0]["material"] = 1.into();
        json["materials"] = serde_json::json!([{}, {"pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.25, 1, 1]}}]);
        json["nodes"][0]["scale"] = serde_json::json!([2, 1, 1]);
    })
    .unwrap();
    // The quad's positions serve as normals: the first has no direction.
    assert_eq!(mesh.corner_normals, [[NO_NORMAL, 0, 1], [1, 0, 2]]);
    assert_eq!(mesh.normals[..2], [Vec3::X, Vec3::Y]);
    assert!((mesh.normals[2] - Vec3::new(1.0, 2.0, 0.0).normalize()).length() <= f32::EPSILON);
    assert_eq!(mesh.materials[mesh.material_of[0] as usize].diffuse, [0.5, 0.25, 1.0]);
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

/// A PNG of two texels beside each other: red, and blue that is hardly there.
fn two_texels() -> Vec<u8> {
    let mut png = std::io::Cursor::new(Vec::new());
    let image = image::RgbaImage::from_raw(2, 1, vec![255, 0, 0, 255, 0, 0, 255, 51]).unwrap();
    image.write_to(&mut png, image::ImageFormat::Png).unwrap();
    png.into_inner()
}

/// The quad with texture coordinates that are its positions' x and y, and [`two_texels`] as its base colour.
fn textured_quad(edit: impl FnOnce(&mut serde_json::Value)) -> serde_json::Value {
    let mut json = quad_json();
    let uvs: Vec<u8> = [0.0f32, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 1.0].iter().flat_map(|v| v.to_le_bytes()).collect();
    let image = two_texels();
    json["bufferViews"].as_array_mut().unwrap().extend([
        serde_json::json!({"buffer": 0, "byteOffset": 64, "byteLength": uvs.len()}),
        serde_json::json!({"buffer": 0, "byteOffset": 64 + uvs.len(), "byteLength": image.len()}),
    ]);
    json["accessors"]
        .as_array_mut()
        .unwrap()
        .push(serde_json::json!({"bufferView": 3, "componentType": 5126, "count": 4, "type": "VEC2"}));
    json["buffers"][0] = serde_json::json!({"byteLength": 64 + uvs.len() + image.len()});
    json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = 3.into();
    json["meshes"][0]["primitives"][0]["material"] = 0.into();
    json["images"] = serde_json::json!([{"bufferView": 4, "mimeType": "image/png"}]);
    json["samplers"] = serde_json::json!([{"wrapS": 33071, "wrapT": 33648}]);
    json["textures"] = serde_json::json!([{"source": 0, "sampler": 0}]);
    json["materials"] = serde_json::json!([{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}]);
    edit(&mut json);
    json
}

fn load_textured_quad(images: &Images, edit: impl FnOnce(&mut serde_json::Value)) -> Result<Mesh> {
    let json = textured_quad(edit);
    let uvs: Vec<u8> = [0.0f32, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 1.0].iter().flat_map(|v| v.to_le_bytes()).collect();
    let binary = [quad_bytes(), uvs, two_texels()].concat();
    let mut text = serde_json::to_vec(&json).unwrap();
    text.resize(text.len().next_multiple_of(4), b' ');
    parse(&glb(&text, &binary), here(&Loading::default()), images, None)
}

#[test]
fn a_missing_image_is_listed_and_left_out() {
    let gone = |json: &mut serde_json::Value| json["images"] = serde_json::json!([{"uri": "no/gone%20.png"}]);
    let mesh = load_textured_quad(&Images::default(), gone).unwrap();
    assert_eq!((mesh.materials[0].diffuse, &mesh.materials[0].texture), ([1.0; 3], &None));
    let why = "image 0: the file does not exist; the material's own colour is used".into();
    assert_eq!(mesh.missing, [Missing { what: "no/gone .png".into(), why }]);
    let masked = load_textured_quad(&Images::of(ImagesRead::Masks), gone).unwrap();
    assert!(masked.missing.is_empty());
    let set_mask = |json: &mut serde_json::Value| json["materials"][0]["alphaMode"] = "MASK".into();
    let masked = |edit: fn(&mut serde_json::Value)| load_textured_quad(&Images::of(ImagesRead::Masks), edit).unwrap();
    assert!(masked(set_mask).materials[0].texture.is_some() && masked(|_| {}).materials[0].texture.is_none());
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
    let source =
        Source::parse(&bytes, FileAccess { folder: folder.path(), files: Files::Below, loading: &Loading::default() })
            .unwrap();
    assert!(source.buffers.len() == 3 && source.buffers.iter().all(|b| Arc::ptr_eq(b, &source.buffers[0])));
}

#[test]
fn base_colours_have_their_images_borders_and_places() {
    let mesh = load_textured_quad(&Images::default(), |_| {}).unwrap();
    // glTF's v runs downwards
    assert_eq!(mesh.uvs_of(0), Some([Vec2::new(0.0, 1.0), Vec2::new(1.0, 1.0), Vec2::new(0.0, 0.0)]));
    let texture = mesh.materials[0].texture.as_ref().unwrap();
    assert_eq!((texture.wrap, texture.cutoff), ([Wrap::Clamp, Wrap::Mirror], None));
    assert_eq!(texture.texels.rgba[0].map(f32::from), [1.0, 0.0, 0.0, 1.0]);
    assert_eq!(mesh.materials[0].diffuse, [1.0; 3]);

    for (mode, cutoff) in [("OPAQUE", None), ("MASK", Some(0.25)), ("BLEND", Some(0.5))] {
        let set_mode = |json: &mut serde_json::Value| {
            json["materials"][0]["alphaMode"] = mode.into();
            if mode == "MASK" {
                json["materials"][0]["alphaCutoff"] = 0.25.into();
            }
        };
        let mesh = load_textured_quad(&Images::default(), set_mode).unwrap();
        assert_eq!(mesh.materials[0].texture.as_ref().unwrap().cutoff, cutoff, "{mode}");
    }
    let moved = |json: &mut serde_json::Value| {
        let transform =
            serde_json::json!({"offset": [0.5, 0.25], "scale": [2, 4], "rotation": std::f64::consts::FRAC_PI_2});
        json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["extensions"] =
            serde_json::json!({"KHR_texture_transform": transform});
    };
    let mesh = load_textured_quad(&Images::default(), moved).unwrap();
    // (1, 0) is scaled to (2, 0), turned to (0, -2) and moved
    let uv = mesh.uvs_of(0).unwrap()[1];
    assert!((uv - Vec2::new(0.5, 1.0 + 1.75)).length() < 1e-6, "{uv}");

    // of a factor of one half an image must be opaque to reach it
    let faded = |json: &mut serde_json::Value| {
        json["materials"][0]["alphaMode"] = "MASK".into();
        json["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = serde_json::json!([1, 1, 1, 0.5]);
    };
    let mesh = load_textured_quad(&Images::default(), faded).unwrap();
    assert_eq!(mesh.materials[0].texture.as_ref().unwrap().cutoff, Some(1.0));

    // what no triangle has is not looked at, nor is what is wrong with it
    let unused = |json: &mut serde_json::Value| {
        json["meshes"][0]["primitives"][0].as_object_mut().unwrap().remove("material");
        json["images"] = serde_json::json!([{"uri": "gone.png"}]);
    };
    assert!(load_textured_quad(&Images::default(), unused).unwrap().materials[0].texture.is_none());
    // neither a file nor a part of the buffer
    let nowhere = |json: &mut serde_json::Value| json["images"] = serde_json::json!([{"mimeType": "image/png"}]);
    let message = load_textured_quad(&Images::default(), nowhere).unwrap_err().to_string();
    assert!(message.starts_with("image 0: has neither a uri nor a bufferView"), "{message}");
    let without = load_textured_quad(&Images::left_out(), |_| {}).unwrap();
    assert!(without.materials[0].texture.is_none() && !without.corner_uvs.is_empty());
    for (edit, expected) in [
        (("/images/0/bufferView", serde_json::json!(0)), "image 0: is no PNG, JPEG or HDR"),
        (("/bufferViews/4/byteLength", serde_json::json!(1 << 20)), "image 0: exceeds its buffer"),
        (("/textures/0/source", serde_json::json!(7)), "textures[0].source"),
        (("/accessors/3/count", serde_json::json!(3)), "node 0: mesh 0, primitive 0: 3 texture coordinates for 4"),
        (
            ("/accessors/3/type", serde_json::json!("VEC3")),
            "node 0: mesh 0, primitive 0: accessor 3: must hold vectors of 2",
        ),
    ] {
        let wrong = load_textured_quad(&Images::default(), |json| *json.pointer_mut(edit.0).unwrap() = edit.1);
        let message = wrong.unwrap_err().to_string();
        assert!(message.starts_with(expected), "{message}");
    }
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
        let _ = parse(&glb(changed.replace(WITH_URI, "").as_bytes(), &quad_bytes()), here(&Loading::default()), &Images::default(), None);
    }
}

/// Colours of the quad's corners as bytes with opacity and as floats, on the second of three primitives.
#[test]
fn colours_of_vertices_are_linear() {
    let bytes = [255u8, 0, 0, 9, 0, 51, 0, 9, 0, 0, 0, 9, 255, 255, 255, 9].to_vec();
    let floats = [1.0f32, 0.0, 0.0, 0.0, 0.2, 0.0, 0.0, 0.0, 0.0, 1.5, 1.0, f32::NAN];
    let floats = floats.iter().flat_map(|v| v.to_le_bytes()).collect();
    for (own, kind, shape, normalized) in [(bytes, 5121, "VEC4", true), (floats, 5126, "VEC3", false)] {
        let mut json = quad_json();
        let add = |json: &mut serde_json::Value, list: &str, value| json[list].as_array_mut().unwrap().push(value);
        let plain = json["meshes"][0]["primitives"][0].clone();
        let mut colored = plain.clone();
        colored["attributes"]["COLOR_0"] = 3.into();
        json["meshes"][0]["primitives"] = serde_json::json!([plain, colored, plain]);
        add(&mut json, "buffers", serde_json::json!({"uri": "colors.bin", "byteLength": own.len()}));
        add(&mut json, "bufferViews", serde_json::json!({"buffer": 1, "byteLength": own.len()}));
        let accessor = serde_json::json!({"bufferView": 3, "componentType": kind, "count": 4, "type": shape, "normalized": normalized});
        add(&mut json, "accessors", accessor);
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("quad.bin"), quad_bytes()).unwrap();
        std::fs::write(folder.path().join("colors.bin"), &own).unwrap();
        let load = |json: &serde_json::Value| {
            let path = folder.path().join("quad.gltf");
            std::fs::write(&path, serde_json::to_vec(json).unwrap()).unwrap();
            load(&path, Files::Below, &Images::default(), None, &Loading::default())
        };
        let mesh = load(&json).unwrap();
        assert_eq!(mesh.colors, [[1.0, 0.0, 0.0], [0.0, 0.2, 0.0], [0.0; 3], [1.0; 3]]);
        let none = [NO_COLOR; 3];
        assert_eq!(mesh.corner_colors, [none, none, [0, 1, 2], [2, 1, 3], none, none]);
        assert_eq!(mesh.materials.last().unwrap().diffuse, [1.0; 3]);
        json["accessors"][3]["count"] = 3.into();
        assert!(load(&json).unwrap_err().to_string().contains("3 colours for 4 positions"));
    }
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
fn more_vertices_than_memory_has_are_refused_before_they_are_made() {
    let huge = load_quad(|json| {
        // 64 GiB of vertices of which one is said
        json["accessors"][0] = serde_json::json!({ "componentType": 5126, "count": 3u32 << 28, "type": "VEC3",
            "sparse": { "count": 1, "indices": { "bufferView": 2, "componentType": 5121 }, "values": { "bufferView": 0 } } });
    });
    let text = huge.unwrap_err().to_string();
    assert!(text.contains("a mesh of 805306368 vertices takes about"), "{text}");
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

fn material_of(material: serde_json::Value) -> Mesh {
    load_quad(|json| {
        json["materials"] = serde_json::json!([material]);
        json["meshes"][0]["primitives"][0]["material"] = 0.into();
    })
    .unwrap()
}

#[test]
fn a_triangle_is_there_from_its_opacity_on() {
    let is_there = |mesh: &Mesh| mesh.triangles.iter().map(|t| t[0] != t[1]).collect::<Vec<_>>();
    let of = |mode: &str, opacity: f64, cutoff: Option<f64>| {
        let mut material =
            serde_json::json!({"alphaMode": mode, "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, opacity]}});
        if let Some(cutoff) = cutoff {
            material["alphaCutoff"] = cutoff.into();
        }
        is_there(&material_of(material))
    };
    assert_eq!(of("MASK", 0.2, None), [false; 2]);
    assert_eq!(of("MASK", 0.2, Some(0.2)), [true; 2]);
    assert_eq!(of("BLEND", 0.0, None), [false; 2]);
    assert_eq!(of("BLEND", 0.5, None), [true; 2]);
    assert_eq!(of("OPAQUE", 0.0, None), [true; 2]);
    // opacities of vertices: 1, 1, 0.25 and 0.25
    let colored = |opacity: f64, read: ImagesRead| {
        let mut json = quad_json();
        json["accessors"].as_array_mut().unwrap().push(serde_json::json!(
            {"bufferView": 3, "componentType": 5126, "count": 4, "type": "VEC4"}));
        json["bufferViews"]
            .as_array_mut()
            .unwrap()
            .push(serde_json::json!({"buffer": 0, "byteOffset": 64, "byteLength": 64}));
        json["buffers"][0] = serde_json::json!({"byteLength": 128});
        json["materials"] = serde_json::json!([{"alphaMode": "BLEND", "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, opacity]}}]);
        json["meshes"][0]["primitives"][0]["material"] = 0.into();
        json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = 3.into();
        let colors = [1.0f32, 1.0, 0.25, 0.25].iter().flat_map(|a| [1.0, 1.0, 1.0, *a]).flat_map(f32::to_le_bytes);
        let binary = [quad_bytes(), colors.collect()].concat();
        let mut text = serde_json::to_vec(&json).unwrap();
        text.resize(text.len().next_multiple_of(4), b' ');
        is_there(&parse(&glb(&text, &binary), here(&Loading::default()), &Images::of(read), None).unwrap())
    };
    // means of 0.75 and 0.5
    assert_eq!(colored(1.0, ImagesRead::Masks), [true, true]);
    assert_eq!(colored(0.75, ImagesRead::All), [true, false]);
    assert_eq!(colored(0.5, ImagesRead::All), [false, false]);
    assert_eq!(colored(0.5, ImagesRead::None), [true, true]);
}

#[test]
fn materials_have_what_extensions_say() {
    let material = |json| material_of(json).materials[0].clone();
    let shining = material(serde_json::json!({"doubleSided": true, "emissiveFactor": [1, 0.5, 0],
        "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 5}}}));
    assert_eq!((shining.emissive, shining.two_sided, shining.is_unlit), ([5.0, 2.5, 0.0], true, false));
    let gloss = material(serde_json::json!({"extensions": {"KHR_materials_pbrSpecularGlossiness":
        {"diffuseFactor": [0.8, 0.2, 0.1, 1], "specularFactor": [0.5, 0, 0], "glossinessFactor": 0.75}}}));
    assert_eq!((gloss.diffuse, gloss.specular, gloss.roughness), ([0.8, 0.2, 0.1], [0.5, 0.0, 0.0], 0.25));
    assert_eq!((gloss.metallic, gloss.two_sided), (0.0, false));
    assert!(material(serde_json::json!({"extensions": {"KHR_materials_unlit": {}}})).is_unlit);
}

#[test]
fn what_is_not_drawn_is_listed() {
    let mesh = load_quad(|json| {
        json["materials"] = serde_json::json!([
            {"name": "hull", "normalTexture": {"index": 0}, "extensions": {"KHR_materials_clearcoat": {}, "KHR_materials_unlit": {}}},
            {"name": "unused", "occlusionTexture": {"index": 0}},
            {"name": "glass", "alphaMode": "BLEND", "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 0.75]}},
        ]);
        json["textures"] = serde_json::json!([{"source": 0}]);
        json["images"] = serde_json::json!([{"uri": "gone.png"}]);
        json["extensions"] = serde_json::json!({"KHR_lights_punctual": {"lights": []}, "KHR_xmp_json_ld": {}});
        let plain = json["meshes"][0]["primitives"][0].clone();
        let primitives: Vec<_> = [(0, 4), (2, 4), (0, 1)].into_iter().map(|(material, mode)| {
            let mut own = plain.clone();
            (own["material"], own["mode"]) = (material.into(), mode.into());
            own
        }).collect();
        json["meshes"][0]["primitives"] = primitives.into();
        json["meshes"][0]["weights"] = serde_json::json!([0.5]);
    })
    .unwrap();
    let found: Vec<&str> = mesh.missing.iter().map(|missing| missing.what.as_str()).collect();
    let expected = [
        "lines and points",
        "transparency of material \"glass\"",
        "KHR_materials_clearcoat of material \"hull\"",
        "normalTexture of material \"hull\"",
        "extension KHR_lights_punctual",
    ];
    assert_eq!(found, expected);
    // an image of a kind that is not read
    let ktx = load_textured_quad(&Images::default(), |json| {
        json["textures"] = serde_json::json!([{"extensions": {"KHR_texture_basisu": {"source": 0}}}]);
        json["images"] = serde_json::json!([{"uri": "data:image/ktx2;base64,q0tUWCAyMLsNChoK"}]);
    });
    let why = "image 0: KTX2 images are not read; the material's own colour is used".into();
    assert_eq!(ktx.unwrap().missing, [Missing { what: "texture of material \"\"".into(), why }]);
    let draco = load_quad(|json| {
        json["meshes"][0]["primitives"][0]["extensions"] = serde_json::json!({"KHR_draco_mesh_compression": {}});
        json["accessors"][0].as_object_mut().unwrap().remove("bufferView");
    });
    let message = draco.unwrap_err().to_string();
    assert!(message.contains("primitive 0: its form by KHR_draco_mesh_compression is not as"), "{message}");
}

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
    let mut text = serde_json::to_vec(&json).unwrap();
    text.resize(text.len().next_multiple_of(4), b' ');
    parse(&glb(&text, &binary), here(&Loading::default()), &Images::default(), None)
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
    let mut text = serde_json::to_vec(&json).unwrap();
    text.resize(text.len().next_multiple_of(4), b' ');
    parse(&glb(&text, &binary), here(&Loading::default()), &Images::default(), None)
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
        let mut text = serde_json::to_vec(&json).unwrap();
        text.resize(text.len().next_multiple_of(4), b' ');
        parse(&glb(&text, &binary), here(&Loading::default()), &Images::default(), None)
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

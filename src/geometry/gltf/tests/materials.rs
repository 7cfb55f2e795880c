//! Materials: colors, textures and opacity.

use super::*;
use crate::geometry::mesh::Missing;
use crate::geometry::texture::Wrap;
use glam::Vec3;

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
    parse(document_glb(&json, &binary), here(&Loading::default()), images, None)
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
        is_there(&parse(document_glb(&json, &binary), here(&Loading::default()), &Images::of(read), None).unwrap())
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

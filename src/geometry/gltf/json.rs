//! The JSON of a glTF file: rewritten where the crate is stricter than the specification, and read where the crate rounds or leaves out.

use super::draco::DRACO;
use super::source::POINTERS;
use crate::arrays::MapEach;
use glam::{DMat4, DQuat, DVec3};
use serde_json::Value;
use std::collections::BTreeSet;

/// Numbers and extensions of the document that the crate's own types do not hold.
#[derive(Debug, Default)]
pub(super) struct Kept {
    pub nodes: Vec<NodeParts>,
    pub materials: Vec<MaterialParts>,
    /// Names of the extensions that objects of the document have.
    pub extensions: BTreeSet<String>,
}

#[derive(Debug, Default)]
pub(super) struct NodeParts {
    /// JSON numbers are f64; the crate rounds them to f32.
    pub local: Local,
    pub weights: Option<Vec<f64>>,
    /// `KHR_node_visibility` hides it and all below it.
    pub is_hidden: bool,
    /// `EXT_mesh_gpu_instancing` places its mesh several times.
    pub instances: Option<Instances>,
}

/// The own transform of a node.
#[derive(Debug, Clone, Copy)]
pub(super) enum Local {
    Matrix(DMat4),
    Parts { translation: DVec3, rotation: DQuat, scale: DVec3 },
}

/// Accessors of the instances' transforms.
#[derive(Debug, Default)]
pub(super) struct Instances {
    pub translation: Option<usize>,
    pub rotation: Option<usize>,
    pub scale: Option<usize>,
}

#[derive(Debug)]
pub(super) struct MaterialParts {
    /// `KHR_materials_unlit`.
    pub is_unlit: bool,
    /// `KHR_materials_emissive_strength`, by which its emission is multiplied.
    pub emissive_strength: f32,
    /// Of `KHR_materials_pbrSpecularGlossiness`.
    pub specular: Option<[f32; 3]>,
    /// Parts that no reader here uses: a texture's key or an extension's name.
    pub unread: Vec<String>,
}

impl Default for Local {
    fn default() -> Local {
        Local::Parts { translation: DVec3::ZERO, rotation: DQuat::IDENTITY, scale: DVec3::ONE }
    }
}

impl Local {
    fn of(node: &Value) -> Local {
        if let Some(matrix) = numbers::<16>(node, "matrix") {
            return Local::Matrix(DMat4::from_cols_array(&matrix));
        }
        Local::Parts {
            translation: numbers::<3>(node, "translation").map_or(DVec3::ZERO, DVec3::from),
            rotation: numbers::<4>(node, "rotation").map_or(DQuat::IDENTITY, |q| DQuat::from_array(q).normalize()),
            scale: numbers::<3>(node, "scale").map_or(DVec3::ONE, DVec3::from),
        }
    }

    pub fn parent_from_node(&self) -> DMat4 {
        match *self {
            Local::Matrix(matrix) => matrix,
            Local::Parts { translation, rotation, scale } => {
                DMat4::from_scale_rotation_translation(scale, rotation, translation)
            }
        }
    }
}

/// Rewrites a document as the crate expects it; the scene stays the same.
pub(super) fn prepare(json: &mut Value) {
    make_whole(json);
    for animation in objects_mut(json, "animations") {
        if let Some(channels) = animation.get_mut("channels").and_then(Value::as_array_mut) {
            // a channel without a node moves something else, or nothing
            channels.retain(|channel| channel["target"].get("node").is_some());
        }
    }
    for texture in objects_mut(json, "textures") {
        let of = |name: &str| texture.get("extensions")?.get(name)?.get("source").cloned();
        let source = ["EXT_texture_webp", "KHR_texture_basisu", "MSFT_texture_dds", "EXT_texture_avif"]
            .iter()
            .find_map(|name| of(name));
        if let (Some(source), Some(texture)) = (source, texture.as_object_mut()) {
            texture.entry("source").or_insert(source);
        }
    }
    for scene in objects_mut(json, "scenes").filter_map(Value::as_object_mut) {
        scene.entry("nodes").or_insert_with(|| Value::Array(Vec::new()));
    }
    objects_mut(json, "materials").for_each(|material| {
        use_specular_glossiness(material);
    });
}

/// Writes whole numbers such as 3.0 as integers, which JSON does not tell apart and the crate does.
fn make_whole(value: &mut Value) {
    /// All whole numbers up to it are exact in f64.
    const EXACT: f64 = (1u64 << 53) as f64;
    match value {
        Value::Number(number) if number.is_f64() => {
            let whole = number.as_f64().filter(|v| v.is_sign_positive() && v.fract() == 0.0 && *v <= EXACT);
            if let Some(whole) = whole {
                *number = (whole as u64).into();
            }
        }
        Value::Array(values) => values.iter_mut().for_each(make_whole),
        Value::Object(values) => values.values_mut().for_each(make_whole),
        _ => {}
    }
}

const SPECULAR_GLOSSINESS: &str = "KHR_materials_pbrSpecularGlossiness";

/// Puts the diffuse colour and the glossiness of `KHR_materials_pbrSpecularGlossiness` in place of the base colour and the roughness.
fn use_specular_glossiness(material: &mut Value) -> Option<()> {
    let from = material.get("extensions")?.get(SPECULAR_GLOSSINESS)?.as_object()?;
    let mut base = serde_json::Map::new();
    for (key, own) in [("baseColorFactor", "diffuseFactor"), ("baseColorTexture", "diffuseTexture")] {
        if let Some(value) = from.get(own) {
            base.insert(key.into(), value.clone());
        }
    }
    let glossiness = from.get("glossinessFactor").and_then(Value::as_f64).unwrap_or(1.0);
    // its image, which is not read, says how glossy a place is
    let is_plain = !from.contains_key("specularGlossinessTexture");
    base.insert("metallicFactor".into(), 0.into());
    base.insert("roughnessFactor".into(), if is_plain { (1.0 - glossiness).into() } else { 1.into() });
    material.as_object_mut()?.insert("pbrMetallicRoughness".into(), base.into());
    Some(())
}

impl Kept {
    /// Of a document after [`prepare`].
    pub fn of(json: &Value) -> Kept {
        let mut extensions = BTreeSet::new();
        gather_extensions(json, &mut extensions);
        Kept {
            nodes: objects(json, "nodes").map(|node| NodeParts::of(node, json)).collect(),
            materials: objects(json, "materials").map(MaterialParts::of).collect(),
            extensions,
        }
    }
}

impl NodeParts {
    fn of(node: &Value, json: &Value) -> NodeParts {
        let extension = |name: &str| node.get("extensions")?.get(name);
        let mesh = || json.get("meshes")?.get(node.get("mesh")?.as_u64()? as usize);
        let weights = |of: &Value| Some(of.get("weights")?.as_array()?.iter().filter_map(Value::as_f64).collect());
        let instances = extension("EXT_mesh_gpu_instancing").and_then(|e| e.get("attributes")).map(|attributes| {
            let accessor = |key: &str| Some(attributes.get(key)?.as_u64()? as usize);
            Instances { translation: accessor("TRANSLATION"), rotation: accessor("ROTATION"), scale: accessor("SCALE") }
        });
        NodeParts {
            local: Local::of(node),
            weights: weights(node).or_else(|| weights(mesh()?)),
            is_hidden: extension("KHR_node_visibility").and_then(|e| e.get("visible")) == Some(&Value::Bool(false)),
            instances,
        }
    }
}

impl MaterialParts {
    fn of(material: &Value) -> MaterialParts {
        let extension = |name: &str| material.get("extensions")?.get(name);
        let strength = extension("KHR_materials_emissive_strength").and_then(|e| e.get("emissiveStrength"));
        let gloss = extension(SPECULAR_GLOSSINESS);
        let textures = ["normalTexture", "occlusionTexture", "emissiveTexture"];
        let mut unread: Vec<String> =
            textures.into_iter().filter(|key| material.get(key).is_some()).map(str::to_owned).collect();
        let of_roughness = material.get("pbrMetallicRoughness").and_then(|pbr| pbr.get("metallicRoughnessTexture"));
        unread.extend(of_roughness.map(|_| "metallicRoughnessTexture".to_owned()));
        unread
            .extend(gloss.and_then(|g| g.get("specularGlossinessTexture")).map(|_| "specularGlossinessTexture".into()));
        let extensions = material.get("extensions").and_then(Value::as_object);
        unread.extend(extensions.into_iter().flat_map(|e| e.keys()).filter(|name| !is_read(name)).cloned());
        let is_plain = gloss.is_some_and(|gloss| gloss.get("specularGlossinessTexture").is_none());
        let specular = gloss.map(|gloss| numbers::<3>(gloss, "specularFactor").unwrap_or([1.0; 3]));
        MaterialParts {
            is_unlit: extension("KHR_materials_unlit").is_some(),
            emissive_strength: strength.and_then(Value::as_f64).filter(|s| *s >= 0.0).unwrap_or(1.0) as f32,
            specular: specular.filter(|_| is_plain).map(|rgb| rgb.map_each(|c| c.clamp(0.0, 1.0) as f32)),
            unread,
        }
    }
}

/// Whether an extension is read, or does not change the look of a mesh.
pub(super) fn is_read(extension: &str) -> bool {
    const READ: [&str; 8] = [
        "EXT_mesh_gpu_instancing",
        "KHR_materials_emissive_strength",
        "KHR_materials_unlit",
        "KHR_mesh_quantization",
        "KHR_node_visibility",
        "KHR_texture_transform",
        SPECULAR_GLOSSINESS,
        POINTERS,
    ];
    /// Metadata, or a second form of data that is there in a form that is read, or an image's form, which its reader judges.
    const PREFIXES: [&str; 10] = [
        "KHR_xmp",
        "EXT_structural_metadata",
        "EXT_mesh_features",
        "EXT_instance_features",
        DRACO,
        "EXT_meshopt_compression",
        "KHR_meshopt_compression",
        "KHR_texture_basisu",
        "EXT_texture_",
        "MSFT_texture_dds",
    ];
    READ.contains(&extension) || PREFIXES.iter().any(|prefix| extension.starts_with(prefix))
}

/// Collects the names of all extensions in a value and below it, except in `extras`, which are an application's own data.
fn gather_extensions(value: &Value, names: &mut BTreeSet<String>) {
    match value {
        Value::Array(values) => values.iter().for_each(|value| gather_extensions(value, names)),
        Value::Object(values) => {
            for (key, value) in values.iter().filter(|(key, _)| *key != "extras") {
                if key == "extensions" {
                    names.extend(value.as_object().into_iter().flat_map(|e| e.keys().cloned()));
                }
                gather_extensions(value, names);
            }
        }
        _ => {}
    }
}

fn objects<'a>(json: &'a Value, key: &str) -> impl Iterator<Item = &'a Value> {
    json.get(key).and_then(Value::as_array).into_iter().flatten()
}

fn objects_mut<'a>(json: &'a mut Value, key: &str) -> impl Iterator<Item = &'a mut Value> {
    json.get_mut(key).and_then(Value::as_array_mut).into_iter().flatten()
}

/// A list of as many numbers.
fn numbers<const N: usize>(of: &Value, key: &str) -> Option<[f64; N]> {
    let list: Vec<f64> = of.get(key)?.as_array()?.iter().map_while(Value::as_f64).collect();
    list.try_into().ok()
}

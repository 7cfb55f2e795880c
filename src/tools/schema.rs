//! The scene file as a JSON schema, so that editors complete and check it: from the same tables as `camera --help`.

use crate::scene::keys::{Key, of_all_sections, of_any_camera, of_cameras};
use serde_json::{Map, Value, json};

/// Sections of which there may be several.
const LISTS: [&str; 4] = ["mesh", "spheres", "light", "projector_light"];

/// A schema of draft 2020-12.
pub fn schema() -> Value {
    let section = |(name, keys): (&'static str, Vec<Key>)| {
        let table = json!({ "type": "object", "properties": properties(&keys), "additionalProperties": false });
        let is_list = LISTS.contains(&name);
        (name.to_owned(), if is_list { json!({ "type": "array", "items": table }) } else { table })
    };
    let mut sections: Map<String, Value> = of_all_sections().map(section).collect();
    sections.insert("camera".into(), camera());
    json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "anamorph scene",
        "type": "object",
        "properties": sections,
        "required": ["camera"],
        "additionalProperties": false,
    })
}

/// Each kind has keys of its own.
fn camera() -> Value {
    let [any, pose] = of_any_camera();
    let kinds = of_cameras();
    let names: Vec<&str> = kinds.keys().copied().collect();
    let own = |(kind, keys): (&&str, &Vec<Key>)| {
        let mut known = properties(&any);
        let has = |name: &str| keys.iter().any(|key| key.name == name);
        if has("eye") && has("target") {
            known.extend(properties(&pose));
        }
        known.extend(properties(keys));
        json!({
            "if": { "properties": { "kind": { "const": kind } } },
            "then": { "properties": known, "additionalProperties": false },
        })
    };
    json!({
        "type": "object",
        "properties": { "kind": { "enum": names } },
        "required": ["kind"],
        "allOf": kinds.iter().map(own).collect::<Vec<_>>(),
    })
}

fn properties(keys: &[Key]) -> Map<String, Value> {
    keys.iter().map(|key| (key.name.clone(), property(key))).collect()
}

/// What a value may be. Any number or list may have keyframes, a list of tables.
fn property(key: &Key) -> Value {
    let kinds: &[&str] = match key.shape.chars().next() {
        Some('[') => &["array", "string", "number"],
        Some('{') => &["object", "array", "string"],
        Some('"') => &["string", "number", "array", "boolean", "object"],
        _ if ["true", "false"].iter().any(|word| key.shape.contains(word)) => &["boolean"],
        Some(_) => &["number", "array", "string"],
        None => &[],
    };
    let mut value = Map::new();
    if !kinds.is_empty() {
        value.insert("type".into(), json!(kinds));
    }
    let shape = if key.shape.is_empty() { String::new() } else { format!("{}: ", key.shape) };
    value.insert("description".into(), json!(format!("{shape}{}", key.about)));
    if !key.choices.is_empty() {
        value.insert("examples".into(), json!(key.choices));
    }
    Value::Object(value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tools::example::EXAMPLES;

    /// Whether a value is as a schema says, as far as these schemas go.
    fn check(value: &toml::Value, schema: &Value, at: &str) -> Result<(), String> {
        let kind = match value {
            toml::Value::Table(_) => "object",
            toml::Value::Array(_) => "array",
            toml::Value::String(_) => "string",
            toml::Value::Boolean(_) => "boolean",
            _ => "number",
        };
        let allowed = match &schema["type"] {
            Value::Array(kinds) => kinds.contains(&json!(kind)),
            Value::String(one) => one == kind,
            _ => true,
        };
        if !allowed {
            return Err(format!("{at} is a {kind}"));
        }
        if let (toml::Value::Array(items), Some(of)) = (value, schema.get("items")) {
            items.iter().enumerate().try_for_each(|(k, item)| check(item, of, &format!("{at}.{k}")))?;
        }
        let toml::Value::Table(table) = value else { return Ok(()) };
        let kind = table.get("kind").and_then(toml::Value::as_str);
        let cases = schema["allOf"].as_array().into_iter().flatten();
        let own =
            cases.filter(|case| case["if"]["properties"]["kind"]["const"].as_str() == kind).map(|case| &case["then"]);
        for part in own.chain([schema]) {
            for (key, value) in table {
                match part["properties"].get(key) {
                    Some(of) => check(value, of, &format!("{at}.{key}"))?,
                    None if part["additionalProperties"] == false => return Err(format!("{at}.{key} is not known")),
                    None => {}
                }
            }
        }
        Ok(())
    }

    #[test]
    fn every_example_is_as_the_schema_says_and_a_wrong_key_is_not() {
        let schema = schema();
        for example in &EXAMPLES {
            let scene: toml::Value = toml::Value::Table(example.scene.parse().unwrap());
            check(&scene, &schema, example.name).unwrap();
        }
        let wrong = [
            ("[camera]\nkind = \"pinhole\"\nfov = 3", "camera.fov is not known"),
            ("[camera]\nkind = \"fisheye\"\neye = true", "camera.eye is a boolean"),
            ("[image]\nwidht = 3", "image.widht is not known"),
            ("[[mesh]]\nsmooth = 1", "mesh.0.smooth is a number"),
        ];
        for (text, says) in wrong {
            let scene: toml::Value = toml::Value::Table(text.parse().unwrap());
            assert!(check(&scene, &schema, "scene").unwrap_err().contains(says), "{text}");
        }
    }
}

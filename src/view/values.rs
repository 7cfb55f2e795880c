//! The values of a scene file, as JSON for pages and as TOML for files: conversion, keyframes, differences.

use crate::input::tree::{Entry, Node, Value};
use serde_json::{Map, Number, Value as Json};
use toml_edit::{Array, ArrayOfTables, DocumentMut, InlineTable, Item, Table};

/// As JSON. Numbers that JSON does not have are texts: "inf", "-inf", "nan".
pub fn json(node: &Node) -> Json {
    match &node.value {
        Value::Null => Json::Null,
        Value::Bool(b) => Json::Bool(*b),
        // integers beyond 64 bits are out of every key's range
        Value::Int(i) => i64::try_from(*i).map_or_else(|_| Json::from(*i as f64), Json::from),
        Value::Float(x) => Number::from_f64(*x).map_or_else(|| Json::from(format!("{x}").to_lowercase()), Json::Number),
        Value::Text(text) => Json::from(text.as_str()),
        Value::List(items) => Json::Array(items.iter().map(json).collect()),
        Value::Table(entries) => {
            Json::Object(entries.iter().map(|e| (e.key.clone(), json(&e.node))).collect::<Map<_, _>>())
        }
    }
}

/// A TOML value of JSON.
///
/// # Errors
/// What TOML does not have: null.
pub fn value(json: &Json) -> Result<toml_edit::Value, String> {
    Ok(match json {
        Json::Null => return Err("null is no value".into()),
        Json::Bool(b) => (*b).into(),
        Json::Number(n) => match n.as_i64() {
            Some(i) => i.into(),
            None => n.as_f64().filter(|x| x.is_finite()).ok_or("this number is out of range")?.into(),
        },
        Json::String(text) => text.as_str().into(),
        Json::Array(items) => toml_edit::Value::Array(items.iter().map(value).collect::<Result<Array, _>>()?),
        Json::Object(entries) => {
            let entries = entries.iter().map(|(key, item)| Ok((key.as_str(), value(item)?)));
            toml_edit::Value::InlineTable(entries.collect::<Result<InlineTable, String>>()?)
        }
    })
}

/// The text of a scene file with these values: sections for its tables, the values of a section on one line each.
///
/// # Errors
/// What TOML does not have: null.
pub fn toml(root: &Node) -> Result<String, String> {
    let Value::Table(entries) = &root.value else { return Err("a scene is a table".into()) };
    let table = |node: &Node| -> Result<Table, String> {
        let inline = value(&json(node))?;
        Ok(inline.as_inline_table().cloned().map(InlineTable::into_table).unwrap_or_default())
    };
    let mut document = DocumentMut::new();
    for entry in entries {
        let item = match &entry.node.value {
            Value::Table(_) => Item::Table(table(&entry.node)?),
            Value::List(items) if !items.is_empty() && items.iter().all(|i| matches!(i.value, Value::Table(_))) => {
                Item::ArrayOfTables(items.iter().map(table).collect::<Result<ArrayOfTables, _>>()?)
            }
            _ => Item::Value(value(&json(&entry.node))?),
        };
        document.insert(&entry.key, item);
    }
    Ok(document.to_string())
}

/// The value that a path leads to.
pub fn get<'a>(root: &'a Json, steps: &[&str]) -> Option<&'a Json> {
    steps.iter().try_fold(root, |at, step| match at {
        Json::Array(items) => items.get(step.parse::<usize>().ok()?),
        Json::Object(entries) => entries.get(*step),
        _ => None,
    })
}

/// The same, to be changed.
pub fn get_mut<'a>(root: &'a mut Json, steps: &[&str]) -> Option<&'a mut Json> {
    steps.iter().try_fold(root, |at, step| match at {
        Json::Array(items) => items.get_mut(step.parse::<usize>().ok()?),
        Json::Object(entries) => entries.get_mut(*step),
        _ => None,
    })
}

/// Whether an item of a scene file is a list of keyframes.
pub fn is_keys(item: &Item) -> bool {
    let is_key = |table: &dyn toml_edit::TableLike| {
        table.len() == 2 && table.contains_key("frame") && table.contains_key("value")
    };
    match item {
        Item::ArrayOfTables(tables) => !tables.is_empty() && tables.iter().all(|table| is_key(table)),
        Item::Value(toml_edit::Value::Array(items)) => {
            !items.is_empty() && items.iter().all(|item| item.as_inline_table().is_some_and(|table| is_key(table)))
        }
        _ => false,
    }
}

/// The frames of a list of keyframes.
fn key_frames(node: &Node) -> Option<Vec<f64>> {
    let Value::List(items) = &node.value else { return None };
    let frame = |item: &Node| match &item.value {
        Value::Table(entries) if entries.len() == 2 && entries.iter().any(|e| e.key == "value") => {
            match entries.iter().find(|e| e.key == "frame")?.node.value {
                Value::Int(i) => Some(i as f64),
                Value::Float(x) => Some(x),
                _ => None,
            }
        }
        _ => None,
    };
    let frames: Option<Vec<f64>> = items.iter().map(frame).collect();
    frames.filter(|frames| !frames.is_empty())
}

/// Calls `found` with the path and the frames of every list of keyframes.
fn each_keys(node: &Node, path: &str, found: &mut impl FnMut(&str, &[f64])) {
    if let Some(frames) = key_frames(node) {
        return found(path, &frames);
    }
    let below = |key: &str| if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") };
    match &node.value {
        Value::List(items) => {
            items.iter().enumerate().for_each(|(k, item)| each_keys(item, &below(&k.to_string()), found))
        }
        Value::Table(entries) => entries.iter().for_each(|e| each_keys(&e.node, &below(&e.key), found)),
        _ => {}
    }
}

/// The first and the last frame with a key, and the paths of all keyframed values.
pub fn keys(root: &Node) -> (Option<[f64; 2]>, Vec<String>) {
    let (mut ends, mut paths) = (None, Vec::new());
    each_keys(root, "", &mut |path, frames| {
        paths.push(path.to_owned());
        for frame in frames {
            let [first, last] = ends.unwrap_or([*frame; 2]);
            ends = Some([first.min(*frame), last.max(*frame)]);
        }
    });
    (ends, paths)
}

/// `key=value` texts for `--set` that make `new` of `old`; `None` if a section of `old` is not in `new`.
pub fn assignments(old: &Node, new: &Node) -> Option<Vec<String>> {
    let mut found = Vec::new();
    differences(old, new, "", &mut found).then_some(found)
}

fn differences(old: &Node, new: &Node, path: &str, found: &mut Vec<String>) -> bool {
    let below = |key: &str| if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") };
    match (&old.value, &new.value) {
        (Value::Table(before), Value::Table(after)) => {
            let is_kept = |entry: &Entry| after.iter().any(|e| e.key == entry.key);
            if !before.iter().all(is_kept) {
                // a removed key: the table as a whole, where it has a name
                return !path.is_empty() && assign(new, path, found);
            }
            after.iter().all(|entry| match before.iter().find(|e| e.key == entry.key) {
                Some(known) => differences(&known.node, &entry.node, &below(&entry.key), found),
                None => assign(&entry.node, &below(&entry.key), found),
            })
        }
        (Value::List(before), Value::List(after)) if before.len() == after.len() => {
            let mut pairs = before.iter().zip(after).enumerate();
            pairs.all(|(k, (old, new))| differences(old, new, &below(&k.to_string()), found))
        }
        (before, after) => json_equal(before, after) || assign(new, path, found),
    }
}

fn assign(node: &Node, path: &str, found: &mut Vec<String>) -> bool {
    node.value.inline().is_some_and(|text| {
        found.push(format!("{path}={text}"));
        true
    })
}

/// Equality of values wherever they are written.
fn json_equal(old: &Value, new: &Value) -> bool {
    match (old, new) {
        (Value::List(a), Value::List(b)) => {
            a.len() == b.len() && a.iter().zip(b).all(|(a, b)| json_equal(&a.value, &b.value))
        }
        (Value::Table(a), Value::Table(b)) => {
            let same = |e: &Entry| b.iter().any(|o| o.key == e.key && json_equal(&e.node.value, &o.node.value));
            a.len() == b.len() && a.iter().all(same)
        }
        _ => old == new,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::parse::{Format, parse};
    use std::path::Path;

    fn read(text: &str) -> Node {
        parse(text, Format::Toml, Path::new("s.toml")).unwrap()
    }

    #[test]
    fn values_become_toml_and_json_and_are_the_same_again() {
        let text = "[image]\nwidth = 8\nbackground = [0, 0.5, 1e-300]\n[[mesh]]\nbuiltin = \"a \\\"b\\\"\"\nsmooth = true\n[[mesh]]\n\
                    scale = -0.1\n[camera]\nkind = \"mesh\"\nt_range = [-inf, inf]\nvertices = [{ image = [0, 1] }]\n";
        let root = read(text);
        let again = read(&toml(&root).unwrap());
        assert_eq!(json(&again), json(&root));
        assert_eq!(json(&root)["camera"]["t_range"], serde_json::json!(["-inf", "inf"]));
        assert!(toml(&root).unwrap().contains("[[mesh]]"));
    }

    #[test]
    fn differences_are_the_sets_that_make_them() {
        let old = "a = 1\nb = { c = [1, 2, 3], d = \"x\" }\n[[m]]\ns = 1\n[[m]]\ns = 2\n";
        for (new, expected) in [
            (old, Some(vec![])),
            (
                "a = 1.5\nb = { c = [1, 2, 3], d = \"x y\" }\nm = [{ s = 1 }, { s = 2 }]\n",
                Some(vec!["a=1.5", "b.d=\"x y\""]),
            ),
            ("a = 1\nb = { c = [1, 9, 3], d = \"x\" }\nm = [{ s = 1 }, { s = 3 }]\n", Some(vec!["b.c.1=9", "m.1.s=3"])),
            ("a = 1\nb = { c = [1], d = \"x\", e = 2 }\nm = [{ s = 1 }, { s = 2 }]\n", Some(vec!["b.c=[1]", "b.e=2"])),
            ("a = 1\nb = { c = [1, 2, 3], d = \"x\" }\nm = [{ s = 1 }, { t = 2 }]\n", Some(vec!["m.1={ \"t\" = 2 }"])),
            ("a = 1\nb = { c = [1, 2, 3] }\nm = [{ s = 1 }, { s = 2 }]\n", Some(vec!["b={ \"c\" = [1, 2, 3] }"])),
            ("b = { c = [1, 2, 3], d = \"x\" }\nm = [{ s = 1 }, { s = 2 }]\n", None),
        ] {
            let sets = assignments(&read(old), &read(new));
            let expected = expected.map(|sets| sets.into_iter().map(String::from).collect::<Vec<_>>());
            assert_eq!(sets, expected, "{new}");
            if let Some(sets) = sets {
                let mut root = read(old);
                crate::input::overrides::apply(&mut root, &sets).unwrap();
                assert!(json_equal(&root.value, &read(new).value), "{new}");
            }
        }
    }

    #[test]
    fn keyframes_are_found() {
        let root = read(
            "[camera]\nvfov = [{ frame = 2, value = 1 }, { frame = 30, value = 2 }]\neye = [0, 1, 2]\n[[mesh]]\n\
                         translate = [{ frame = -4.5, value = [0, 0, 0] }]\n",
        );
        let (frames, mut paths) = keys(&root);
        assert_eq!(frames, Some([-4.5, 30.0]));
        paths.sort();
        assert_eq!(paths, ["camera.vfov", "mesh.0.translate"]);
        assert_eq!(keys(&read("a = [{ frame = 1, other = 2 }]")).0, None);
    }
}

//! `--set camera.vfov=40`: values of the command line put into the tree before it is read.

use super::parse::parse_set_value;
use crate::input::tree::{Entry, Node, Place, Value, quote};
use crate::input::{Error, Result};

/// Replaces or adds the value that each `key=value` names. The key is a dotted path; a number in it
/// is an index into a list that is already there. Tables on the way are made where they are missing.
pub(crate) fn apply(root: &mut Node, overrides: &[String]) -> Result<()> {
    for text in overrides {
        let Some((path, value)) = text.split_once('=') else {
            return Err(Error::input(format!("--set {}: no '='; write it as key=value", quote(text))));
        };
        let path = path.trim();
        let keys: Vec<&str> = path.split('.').collect();
        set(root, &keys, parse_set_value(value)).map_err(|m| Error::input(format!("--set {path:?}: {m}")))?;
    }
    Ok(())
}

fn set(node: &mut Node, keys: &[&str], value: Node) -> std::result::Result<(), String> {
    let Some((key, rest)) = keys.split_first() else {
        *node = value;
        return Ok(());
    };
    if key.is_empty() {
        return Err("an empty key; write a dotted path as in camera.vfov".into());
    }
    match &mut node.value {
        Value::Table(entries) => {
            let entry = entry(entries, key);
            if rest.is_empty() {
                entry.place = Place::Set;
            }
            set(&mut entry.node, rest, value)
        }
        Value::List(items) => {
            let count = items.len();
            match key.parse::<usize>().ok().and_then(|index| items.get_mut(index)) {
                Some(item) => set(item, rest, value),
                None => Err(format!("{key:?} is not an index into this list of {count}; they count from 0")),
            }
        }
        other => Err(format!("{key:?} cannot be set in {}", other.describe())),
    }
}

/// The entry of `key`, made as an empty table where there is none.
fn entry<'a>(entries: &'a mut Vec<Entry>, key: &str) -> &'a mut Entry {
    let at = entries.iter().position(|e| e.key == key).unwrap_or_else(|| {
        let node = Node { value: Value::Table(Vec::new()), place: Place::Set };
        entries.push(Entry { key: key.into(), place: Place::Set, node });
        entries.len() - 1
    });
    &mut entries[at]
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::super::parse::{Format, parse};
    use super::*;

    const TEXT: &str = "[camera]\nvfov = 1\n[[mesh]]\nscale = [1, 2, 3]\n";

    fn set_in(text: &str, overrides: &[&str]) -> Result<Node> {
        let mut root = parse(text, Format::Toml, Path::new("s.toml"))?;
        let overrides: Vec<String> = overrides.iter().map(|s| s.to_string()).collect();
        apply(&mut root, &overrides)?;
        Ok(root)
    }

    fn without_places(node: &Node) -> String {
        match &node.value {
            Value::List(items) => format!("[{}]", items.iter().map(without_places).collect::<Vec<_>>().join(",")),
            Value::Table(entries) => {
                let mut items: Vec<_> =
                    entries.iter().map(|e| format!("{}={}", e.key, without_places(&e.node))).collect();
                items.sort();
                format!("{{{}}}", items.join(","))
            }
            other => format!("{other:?}"),
        }
    }

    #[test]
    fn sets_replace_and_add() {
        let expected = "[camera]\nvfov = 40\n[[mesh]]\nscale = [1, 2, 9]\n[output]\ncolor = 'a=b.png'\n";
        let got = set_in(TEXT, &["camera.vfov=40", "mesh.0.scale.2 = 9", "output.color=a=b.png"]).unwrap();
        assert_eq!(without_places(&got), without_places(&set_in(expected, &[]).unwrap()));
        let last_wins = set_in(TEXT, &["camera.vfov=2", "camera.vfov=3"]).unwrap();
        assert!(without_places(&last_wins).contains("vfov=Int(3)"));
    }

    #[test]
    fn wrong_sets_say_why() {
        for (text, why) in [
            ("camera.vfov", "no '='"),
            ("=1", "empty key"),
            ("camera..vfov=1", "empty key"),
            ("mesh.1.scale=2", "list of 1"),
            ("mesh.scale=2", "not an index"),
            ("camera.vfov.x=2", "cannot be set in the whole number 1"),
        ] {
            let error = set_in(TEXT, &[text]).unwrap_err().to_string();
            assert!(error.starts_with("--set ") && error.contains(why), "{text}: {error}");
        }
    }
}

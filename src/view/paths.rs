//! Values in a TOML document by their dotted paths. Everything else of the text, comments and layout, stays as it is.

use super::values::is_keys;
use toml_edit::{Array, DocumentMut, InlineTable, Item, Table, Value};

/// The item that a path leads to.
pub fn get<'a>(document: &'a DocumentMut, steps: &[&str]) -> Option<&'a Item> {
    steps.iter().try_fold(document.as_item(), |at, step| match step.parse::<usize>() {
        // the index of a table in [[...]], or of a value in a list
        Ok(index) if !at.is_table_like() => at.get(index),
        _ => at.get(step),
    })
}

/// The same, to be changed.
fn get_mut<'a>(document: &'a mut DocumentMut, steps: &[&str]) -> Option<&'a mut Item> {
    // `Item::get_mut` adds keys that are not there
    get(document, steps)?;
    steps.iter().try_fold(document.as_item_mut(), |at, step| match step.parse::<usize>() {
        Ok(index) if !at.is_table_like() => at.get_mut(index),
        _ => at.get_mut(step),
    })
}

/// Sets a value; tables on the way to it are added. One past a list's last index adds an item.
pub fn set(document: &mut DocumentMut, steps: &[&str], value: Value) -> Result<(), String> {
    let known = (0..=steps.len()).rev().find(|n| get(document, &steps[..*n]).is_some()).unwrap_or(0);
    let (known, new) = steps.split_at(known);
    let parent = &known[..known.len().saturating_sub(1)];
    let is_of_list = get(document, parent).is_some_and(Item::is_array_of_tables);
    match (get_mut(document, known), new) {
        (Some(item), []) if is_of_list => *item = Item::Table(whole(value)?),
        (Some(item), []) => replace(item, value),
        (Some(item), [step, rest @ ..]) => {
            let is_section = known.is_empty() && !rest.is_empty();
            add(item, step, nested(rest, value), is_section)?;
        }
        (None, _) => return Err(format!("{known:?} leads nowhere")),
    }
    Ok(())
}

/// Adds a key to a table, as a section of its own if it is to be one, or an item to a list.
fn add(item: &mut Item, step: &str, value: Result<Value, String>, is_section: bool) -> Result<(), String> {
    match item {
        Item::ArrayOfTables(tables) => {
            check_index(step, tables.len())?;
            tables.push(whole(value?)?);
        }
        Item::Value(Value::Array(items)) => {
            check_index(step, items.len())?;
            push(items, value?);
        }
        _ => {
            let table = item.as_table_like_mut().ok_or_else(|| format!("{step:?} cannot be set in a single value"))?;
            let added = match value? {
                Value::InlineTable(section) if is_section => Item::Table(section.into_table()),
                other => Item::Value(other),
            };
            table.insert(step, added);
        }
    }
    Ok(())
}

/// A table of `[[...]]`.
fn whole(value: Value) -> Result<Table, String> {
    match value {
        Value::InlineTable(table) => Ok(table.into_table()),
        _ => Err("only a table can stand here".into()),
    }
}

/// A value inside tables and lists that are not there yet.
fn nested(steps: &[&str], value: Value) -> Result<Value, String> {
    steps.iter().rev().try_fold(value, |value, step| match step.parse::<usize>() {
        Ok(0) => Ok(Value::Array(Array::from_iter([value]))),
        Ok(_) => Err(format!("{step:?}: there is no such list; begin with item 0")),
        Err(_) => Ok(Value::InlineTable(InlineTable::from_iter([(*step, value)]))),
    })
}

/// Refuses the index of an item that is added, unless it is one past the last.
fn check_index(step: &str, count: usize) -> Result<(), String> {
    let is_next = step.parse() == Ok(count);
    is_next
        .then_some(())
        .ok_or_else(|| format!("{step:?} is not an index into this list of {count}; they count from 0"))
}

/// Another value in the same place, with the comment and the spaces around it.
fn replace(item: &mut Item, value: Value) {
    match (item, value) {
        (Item::Value(old), mut value) => {
            *value.decor_mut() = old.decor().clone();
            *old = value;
        }
        // a section stays one, in its place
        (Item::Table(old), Value::InlineTable(new)) => {
            let (decor, position) = (old.decor().clone(), old.position());
            *old = new.into_table();
            *old.decor_mut() = decor;
            old.set_position(position);
        }
        (other, value) => *other = Item::Value(value),
    }
}

/// Adds an item, laid out as the last one.
fn push(items: &mut Array, mut value: Value) {
    if let Some(last) = items.iter().last() {
        let prefix = last.decor().prefix().and_then(|p| p.as_str()).filter(|p| p.chars().all(char::is_whitespace));
        value.decor_mut().set_prefix(prefix.unwrap_or(" ").to_owned());
        items.push_formatted(value);
    } else {
        items.push(value);
    }
}

/// Removes a key, or an item of a list.
pub fn remove(document: &mut DocumentMut, steps: &[&str]) -> Result<(), String> {
    let Some((last, before)) = steps.split_last() else { return Err("nothing to remove".into()) };
    let within = |count: usize| last.parse::<usize>().ok().filter(|index| *index < count);
    let removed = match get_mut(document, before) {
        Some(Item::ArrayOfTables(tables)) => within(tables.len()).map(|index| Item::Table(tables.remove(index))),
        Some(Item::Value(Value::Array(items))) => within(items.len()).map(|index| Item::Value(items.remove(index))),
        Some(other) => other.as_table_like_mut().and_then(|table| table.remove(last)),
        None => None,
    };
    removed.map(drop).ok_or_else(|| format!("there is no {last:?} to remove"))
}

/// Sets the value of a keyframed value at a frame: the key of that frame, or a new one.
pub fn set_key(document: &mut DocumentMut, steps: &[&str], frame: f64, value: Value) -> Result<(), String> {
    let keys = get(document, steps).filter(|item| is_keys(item)).ok_or("this has no keys")?;
    let number = |item: &Item| item.as_float().or(item.as_integer().map(|n| n as f64));
    let frames: Vec<Option<f64>> =
        (0..).map_while(|k| keys.get(k)).map(|key: &Item| key.get("frame").and_then(number)).collect();
    let at = frames.iter().position(|found| found.is_some_and(|found| found >= frame)).unwrap_or(frames.len());
    if frames.get(at).is_some_and(|found| *found == Some(frame)) {
        let index = at.to_string();
        return set(document, &[steps, &[&index, "value"]].concat(), value);
    }
    let whole = frame.fract() == 0.0 && frame.abs() < 1e15;
    let frame = if whole { Value::from(frame as i64) } else { Value::from(frame) };
    let key = InlineTable::from_iter([("frame", frame), ("value", value)]);
    match get_mut(document, steps) {
        Some(Item::ArrayOfTables(tables)) => {
            let mut all: Vec<Table> = tables.iter().cloned().collect();
            all.insert(at, key.into_table());
            *tables = all.into_iter().collect();
        }
        Some(Item::Value(Value::Array(items))) => items.insert(at, Value::InlineTable(key)),
        _ => return Err("this has no keys".into()),
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "# a scene\n[camera] # seen\nkind = \"glc\"\nnear = [[0, 0, 1], [1, 0, 1]] # three\nregions = [\n  { rect = [0, 0, 1, 1] },\n]\n\n\
                        [[mesh]]\nscale = 2 # big\n";

    fn after(change: impl FnOnce(&mut DocumentMut) -> Result<(), String>) -> Result<String, String> {
        let mut document: DocumentMut = TEXT.parse().unwrap();
        change(&mut document)?;
        Ok(document.to_string())
    }

    fn set_to(path: &str, value: &str) -> Result<String, String> {
        let steps: Vec<&str> = path.split('.').collect();
        after(|document| set(document, &steps, value.parse().unwrap()))
    }

    #[test]
    fn a_value_changes_and_the_rest_of_the_text_stays() {
        for (path, value, from, to) in [
            ("camera.near.1.0", "1.5", "[1, 0, 1]", "[1.5, 0, 1]"),
            ("camera.near.0", "[7, 8, 9]", "[[0, 0, 1]", "[[7, 8, 9]"),
            ("mesh.0.scale", "3", "scale = 2", "scale = 3"),
            ("camera.regions.0.rect.2", "0.5", "[0, 0, 1, 1] }", "[0, 0, 0.5, 1] }"),
            ("camera.regions.1", "{ eye = 1 }", "1] },\n]", "1] },\n  { eye = 1 },\n]"),
            ("camera.near.2", "[4, 5, 6]", "[1, 0, 1]]", "[1, 0, 1], [4, 5, 6]]"),
            ("camera.up", "[0, 1, 0]", "1] },\n]\n", "1] },\n]\nup = [0, 1, 0]\n"),
        ] {
            assert_eq!(set_to(path, value).unwrap(), TEXT.replacen(from, to, 1), "{path}");
        }
        assert!(
            set_to("camera", "{ kind = \"x\" }")
                .unwrap()
                .starts_with("# a scene\n[camera] # seen\nkind = \"x\"\n\n[[mesh]]")
        );
        assert_eq!(set_to("style.outline", "2").unwrap(), format!("{TEXT}\n[style]\noutline = 2\n"));
        assert_eq!(
            set_to("mesh.1", "{ builtin = \"box\" }").unwrap(),
            format!("{TEXT}\n[[mesh]]\nbuiltin = \"box\"\n")
        );
        assert!(set_to("light.0.direction", "[0, -1, 0]").unwrap().contains("light = [{ direction = [0, -1, 0] }]"));
    }

    #[test]
    fn paths_that_lead_nowhere_are_refused() {
        for (path, why) in [
            ("camera.near.3", "list of 2"),
            ("camera.near.x", "list of 2"),
            ("camera.kind.x", "single value"),
            ("mesh.2.scale", "list of 1"),
            ("camera.list.1", "begin with item 0"),
        ] {
            let refused = set_to(path, "1").unwrap_err();
            assert!(refused.contains(why), "{path}: {refused}");
        }
    }

    #[test]
    fn keys_and_items_are_removed() {
        let without = |path: &str| after(|document| remove(document, &path.split('.').collect::<Vec<_>>()));
        assert_eq!(without("camera.near").unwrap(), TEXT.replace("near = [[0, 0, 1], [1, 0, 1]] # three\n", ""));
        assert_eq!(without("camera.near.1").unwrap(), TEXT.replace(", [1, 0, 1]]", "]"));
        assert!(!without("mesh.0").unwrap().contains("[[mesh]]"));
        assert!(without("camera.far").is_err() && without("mesh.1").is_err() && without("x.y").is_err());
    }

    #[test]
    fn keys_are_set_in_order() {
        let text = "a = [{ frame = 0, value = 1 }, { frame = 10, value = 2 }]\n";
        let with = |frame: f64| {
            let mut document: DocumentMut = text.parse().unwrap();
            set_key(&mut document, &["a"], frame, Value::from(7)).unwrap();
            document.to_string().split_whitespace().collect::<String>()
        };
        assert_eq!(with(10.0), "a=[{frame=0,value=1},{frame=10,value=7}]");
        assert_eq!(with(5.0), "a=[{frame=0,value=1},{frame=5,value=7},{frame=10,value=2}]");
        assert_eq!(with(-0.5), "a=[{frame=-0.5,value=7},{frame=0,value=1},{frame=10,value=2}]");
        assert_eq!(with(11.0), "a=[{frame=0,value=1},{frame=10,value=2},{frame=11,value=7}]");
    }
}

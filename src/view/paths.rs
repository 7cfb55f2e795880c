//! Values in a TOML document by their dotted paths. Everything else of the text, comments and layout, stays as it is.

use super::values::is_keys;
use toml_edit::{Array, DocumentMut, InlineTable, Item, Table, TableLike, Value};

/// The item that a path leads to.
pub fn get<'a>(document: &'a DocumentMut, steps: &[&str]) -> Option<&'a Item> {
    steps.iter().try_fold(document.as_item(), |at, step| match step.parse::<usize>() {
        // the index of a table in [[...]], or of a value in a list
        Ok(index) if !at.is_table_like() => at.get(index),
        _ => at.get(step),
    })
}

/// Sets a value; tables on the way to it are added. One past a list's last index adds an item.
pub fn set(document: &mut DocumentMut, steps: &[&str], value: Value) -> Result<(), String> {
    match steps {
        [section, rest @ ..] if !rest.is_empty() && document.get(section).is_none() => {
            // a section of its own
            let item = match nested(rest, value)? {
                Value::InlineTable(table) => Item::Table(table.into_table()),
                other => Item::Value(other),
            };
            document.insert(section, item);
            Ok(())
        }
        _ => set_in_item(document.as_item_mut(), steps, value),
    }
}

fn set_in_item(item: &mut Item, steps: &[&str], value: Value) -> Result<(), String> {
    let Some((step, rest)) = steps.split_first() else {
        match (item, value) {
            (Item::Value(old), value) => replace(old, value),
            // a section stays one, in its place
            (Item::Table(old), Value::InlineTable(new)) => {
                let (decor, position) = (old.decor().clone(), old.position());
                *old = new.into_table();
                *old.decor_mut() = decor;
                old.set_position(position);
            }
            (other, value) => *other = Item::Value(value),
        }
        return Ok(());
    };
    match item {
        Item::Value(inner) => set_in_value(inner, steps, value),
        Item::ArrayOfTables(tables) => {
            let count = tables.len();
            let index = index_of(step, count)?;
            let whole = |value: Value| match value {
                Value::InlineTable(table) => Ok(table.into_table()),
                _ => Err("only a table can stand here".to_owned()),
            };
            match (tables.get_mut(index), rest) {
                (Some(table), []) => *table = whole(value)?,
                (Some(table), _) => set_in_table(table, rest, value)?,
                (None, _) => tables.push(whole(nested(rest, value)?)?),
            }
            Ok(())
        }
        Item::Table(table) => set_in_table(table, steps, value),
        Item::None => Err(format!("{step:?} leads nowhere")),
    }
}

fn set_in_value(inner: &mut Value, steps: &[&str], value: Value) -> Result<(), String> {
    let Some((step, rest)) = steps.split_first() else {
        replace(inner, value);
        return Ok(());
    };
    match inner {
        Value::Array(items) => {
            let index = index_of(step, items.len())?;
            match items.get_mut(index) {
                Some(item) => set_in_value(item, rest, value),
                None => {
                    push(items, nested(rest, value)?);
                    Ok(())
                }
            }
        }
        Value::InlineTable(table) => set_in_table(table, steps, value),
        _ => Err(format!("{step:?} cannot be set in a single value")),
    }
}

fn set_in_table(table: &mut dyn TableLike, steps: &[&str], value: Value) -> Result<(), String> {
    let Some((step, rest)) = steps.split_first() else { return Err("a table cannot be replaced here".into()) };
    match table.get_mut(step) {
        Some(item) => set_in_item(item, rest, value),
        None => {
            table.insert(step, Item::Value(nested(rest, value)?));
            Ok(())
        }
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

/// Index of an item, or one past the last.
fn index_of(step: &str, count: usize) -> Result<usize, String> {
    let index = step.parse::<usize>().ok().filter(|index| *index <= count);
    index.ok_or_else(|| format!("{step:?} is not an index into this list of {count}; they count from 0"))
}

/// Another value in the same place, with the comment and the spaces around it.
fn replace(old: &mut Value, mut value: Value) {
    *value.decor_mut() = old.decor().clone();
    *old = value;
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
    let none = || format!("there is no {last:?} to remove");
    let mut at = Place::Item(document.as_item_mut());
    for step in before {
        at = at.into(step).ok_or_else(none)?;
    }
    at.remove(last).then_some(()).ok_or_else(none)
}

/// A place in a document.
enum Place<'a> {
    Item(&'a mut Item),
    Value(&'a mut Value),
    Table(&'a mut Table),
}

impl<'a> Place<'a> {
    fn into(self, step: &str) -> Option<Place<'a>> {
        match self {
            Place::Table(table) => table.get_mut(step).map(Place::Item),
            Place::Item(Item::Table(table)) => table.get_mut(step).map(Place::Item),
            Place::Item(Item::ArrayOfTables(tables)) => tables.get_mut(step.parse().ok()?).map(Place::Table),
            Place::Item(Item::Value(value)) => Place::Value(value).into(step),
            Place::Item(Item::None) => None,
            Place::Value(Value::Array(items)) => items.get_mut(step.parse().ok()?).map(Place::Value),
            Place::Value(Value::InlineTable(table)) => table.get_mut(step).map(Place::Value),
            Place::Value(_) => None,
        }
    }

    /// Whether there was something to remove.
    fn remove(self, step: &str) -> bool {
        let within = |count: usize| step.parse::<usize>().ok().filter(|index| *index < count);
        match self {
            Place::Table(table) | Place::Item(Item::Table(table)) => table.remove(step).is_some(),
            Place::Item(Item::ArrayOfTables(tables)) => {
                within(tables.len()).map(|index| tables.remove(index)).is_some()
            }
            Place::Item(Item::Value(value)) | Place::Value(value) => match value {
                Value::Array(items) => within(items.len()).map(|index| items.remove(index)).is_some(),
                Value::InlineTable(table) => table.remove(step).is_some(),
                _ => false,
            },
            Place::Item(Item::None) => false,
        }
    }
}

/// Sets the value of a keyframed value at a frame: the key of that frame, or a new one.
pub fn set_key(document: &mut DocumentMut, steps: &[&str], frame: f64, value: Value) -> Result<(), String> {
    let keys = get(document, steps).filter(|item| is_keys(item)).ok_or("this has no keys")?;
    let number = |item: Option<&Item>| item.and_then(|i| i.as_float().or(i.as_integer().map(|n| n as f64)));
    let of_value = |item: &Value| {
        item.as_inline_table().and_then(|table| number(table.get("frame").map(|v| Item::Value(v.clone())).as_ref()))
    };
    let frames: Vec<Option<f64>> = match keys {
        Item::ArrayOfTables(tables) => tables.iter().map(|table| number(table.get("frame"))).collect(),
        Item::Value(Value::Array(items)) => items.iter().map(of_value).collect(),
        _ => Vec::new(),
    };
    let at = frames.iter().position(|found| found.is_some_and(|found| found >= frame)).unwrap_or(frames.len());
    if frames.get(at).is_some_and(|found| *found == Some(frame)) {
        let index = at.to_string();
        return set(document, &[steps, &[&index, "value"]].concat(), value);
    }
    let whole = frame.fract() == 0.0 && frame.abs() < 1e15;
    let frame = if whole { Value::from(frame as i64) } else { Value::from(frame) };
    let key = InlineTable::from_iter([("frame", frame), ("value", value)]);
    let mut place = Place::Item(document.as_item_mut());
    for step in steps {
        place = place.into(step).ok_or("this has no keys")?;
    }
    match place {
        Place::Item(Item::ArrayOfTables(tables)) => {
            let mut all: Vec<Table> = tables.iter().cloned().collect();
            all.insert(at, key.into_table());
            *tables = all.into_iter().collect();
        }
        Place::Item(Item::Value(Value::Array(items))) | Place::Value(Value::Array(items)) => {
            items.insert(at, Value::InlineTable(key));
        }
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

//! Keyframes: any number or list of numbers may be a list of `{ frame, value }` keys. Numbers are interpolated linearly, quaternions on the
//! sphere. Between two names of a `file` there is a table of both, and of the share of the way from the one to the other.

use super::reader::{Field, Source};
use crate::arrays::MapEach;
use crate::input::Result;
use crate::input::tree::{Entry, Node, Value};
use glam::{DQuat, DVec4};

/// One key: its frame, and its number or list of numbers.
struct Key<'a> {
    frame: f64,
    value: Field<'a>,
    /// One, or those of a list; none of a text.
    numbers: Vec<f64>,
}

/// What lies between two keys at a frame.
type Rule = fn(&Key, &Key, f64) -> Value;

/// Replaces every list of keys below `node`, which `key` leads to, by its value at `frame`: the first key's before it,
/// the last one's after it, and linear between two keys.
pub(crate) fn pick(node: &mut Node, key: &str, source: &Source, frame: f64) -> Result<()> {
    match &mut node.value {
        Value::List(items) if is_keys(items) => {
            let rule = if key.rsplit('.').next() == Some("quaternion") { rotated } else { between };
            // only a mesh's files are on their way from one to the next
            let takes_texts = matches!(key.split('.').collect::<Vec<_>>()[..], ["mesh", _, "file"]);
            node.value = value_at(&Field::new(source, key, node), frame, (rule, takes_texts))?;
            Ok(())
        }
        Value::List(items) => {
            let mut inner = items.iter_mut().enumerate().filter(|(_, item)| item.value.holds_more());
            inner.try_for_each(|(index, item)| pick(item, &format!("{key}.{index}"), source, frame))
        }
        Value::Table(entries) => {
            let mut inner = entries.iter_mut().filter(|entry| entry.node.value.holds_more());
            inner.try_for_each(|entry| {
                let dotted = if key.is_empty() { entry.key.clone() } else { format!("{key}.{}", entry.key) };
                pick(&mut entry.node, &dotted, source, frame)
            })
        }
        _ => Ok(()),
    }
}

/// Puts the number of a frame into all texts below `node`: `{frame}` becomes 7, `{frame:04}` 0007. Of a frame between two the lower number
/// counts.
pub(crate) fn number(node: &mut Node, frame: f64) {
    match &mut node.value {
        Value::Text(text) if text.contains("{frame") => *text = numbered(text, frame.floor() as i64),
        Value::List(items) => items.iter_mut().for_each(|item| number(item, frame)),
        Value::Table(entries) => entries.iter_mut().for_each(|entry| number(&mut entry.node, frame)),
        _ => {}
    }
}

/// Digits that a number may be filled up to.
const DIGITS_MAX: usize = 19;

fn numbered(text: &str, frame: i64) -> String {
    let mut parts = text.split("{frame");
    let mut all = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (format, rest) = part.split_once('}').unwrap_or((" ", part));
        let width = format.strip_prefix(":0").and_then(|digits| digits.parse().ok()).filter(|n| *n <= DIGITS_MAX);
        match (format, width) {
            ("", _) => all += &format!("{frame}{rest}"),
            (_, Some(width)) => all += &format!("{frame:0width$}{rest}"),
            // no number is asked for
            _ => all += &format!("{{frame{part}"),
        }
    }
    all
}

/// The frames of all keys below `node`, in any order; of lists that are no keys none.
pub(crate) fn frames(node: &Node) -> Vec<f64> {
    let number = |node: &Node| match node.value {
        Value::Int(i) => Some(i as f64),
        Value::Float(x) => Some(x),
        _ => None,
    };
    match &node.value {
        Value::List(items) if is_keys(items) => {
            let entries = items.iter().filter_map(|item| match &item.value {
                Value::Table(entries) => entries.iter().find(|e| e.key == "frame"),
                _ => None,
            });
            entries.filter_map(|entry| number(&entry.node)).collect()
        }
        Value::List(items) => items.iter().flat_map(frames).collect(),
        Value::Table(entries) => entries.iter().flat_map(|entry| frames(&entry.node)).collect(),
        _ => Vec::new(),
    }
}

/// Every item is a table of `frame` and `value` and nothing else.
fn is_keys(items: &[Node]) -> bool {
    let is_key = |item: &Node| match &item.value {
        Value::Table(entries) => {
            entries.len() == 2 && ["frame", "value"].iter().all(|k| entries.iter().any(|e| e.key == *k))
        }
        _ => false,
    };
    !items.is_empty() && items.iter().all(is_key)
}

fn value_at(list: &Field, frame: f64, (rule, takes_texts): (Rule, bool)) -> Result<Value> {
    let keys = list.items("keys")?.map(|item| read_key(&item, takes_texts)).collect::<Result<Vec<Key>>>()?;
    keys.windows(2).try_for_each(|pair| check_order(&pair[0], &pair[1]))?;
    let next = keys.partition_point(|k| k.frame <= frame);
    let value = match (next.checked_sub(1).map(|k| &keys[k]), keys.get(next)) {
        (Some(a), Some(b)) if a.frame < frame => rule(a, b, frame),
        // as written: not all whole numbers are f64
        (Some(key), _) | (None, Some(key)) => key.value.node().value.clone(),
        (None, None) => unreachable!("is_keys: there is a key"),
    };
    Ok(whole(value))
}

fn read_key<'a>(item: &Field<'a>, takes_texts: bool) -> Result<Key<'a>> {
    let table = item.table()?;
    let value = table.need("value", "1")?;
    if value.is_list() && value.items("rows")?.any(|row| row.is_list()) {
        return Err(value
            .error("lists of lists have no keyframes; to move a camera give eye and target, or eye and quaternion"));
    }
    let numbers = match value.is_list() {
        _ if takes_texts && is_text(&value) => Vec::new(),
        true => value.items("numbers")?.map(|n| n.number()).collect::<Result<_>>()?,
        false => vec![value.number()?],
    };
    Ok(Key { frame: table.need("frame", "0")?.number()?, value, numbers })
}

/// The second of two neighbours comes later and has as many numbers.
fn check_order(a: &Key, b: &Key) -> Result<()> {
    if a.frame >= b.frame {
        let frames = format!("frame {} comes after frame {}", b.frame, a.frame);
        return Err(b.value.error(format_args!("{frames}; put the keys in order, each frame once")));
    }
    if a.value.is_list() != b.value.is_list()
        || a.numbers.len() != b.numbers.len()
        || is_text(&a.value) != is_text(&b.value)
    {
        let (found, first) = (b.value.node().value.describe(), a.value.node().value.describe());
        return Err(b.value.error(format_args!("{found} after {first}; all keys need as many numbers")));
    }
    Ok(())
}

fn is_text(value: &Field) -> bool {
    matches!(value.node().value, Value::Text(_))
}

/// The table that stands between two texts: its keys.
pub(crate) const BETWEEN: [&str; 3] = ["from", "to", "share"];

fn between_texts(a: &Key, b: &Key, frame: f64) -> Value {
    let share = Value::Float((frame - a.frame) / (b.frame - a.frame));
    let values = [a.value.node().value.clone(), b.value.node().value.clone(), share];
    let place = a.value.node().place;
    let entry = |(key, value): (&str, Value)| Entry { key: key.into(), place, node: Node { value, place } };
    Value::Table(BETWEEN.into_iter().zip(values).map(entry).collect())
}

/// Linear between two keys. Whole frames and numbers give the exact value, rounded once.
fn between(a: &Key, b: &Key, frame: f64) -> Value {
    if is_text(&a.value) {
        return match a.value.node().value == b.value.node().value {
            true => a.value.node().value.clone(),
            false => between_texts(a, b, frame),
        };
    }
    let number = |(&x, &y): (&f64, &f64)| match x == y {
        true => Value::Float(x),
        false => Value::Float((x * (b.frame - frame) + y * (frame - a.frame)) / (b.frame - a.frame)),
    };
    let place = a.value.node().place;
    let mut values = a.numbers.iter().zip(&b.numbers).map(number);
    match a.value.is_list() {
        true => Value::List(values.map(|value| Node { value, place }).collect()),
        false => values.next().unwrap_or(Value::Null),
    }
}

/// Spherical interpolation (slerp) from one quaternion (w, x, y, z) to the next, the shorter way; of unit length.
fn rotated(a: &Key, b: &Key, frame: f64) -> Value {
    let unit = |key: &Key| {
        let [w, x, y, z] = *<&[f64; 4]>::try_from(key.numbers.as_slice()).ok()?;
        DVec4::new(x, y, z, w).try_normalize().map(DQuat::from_vec4)
    };
    // a wrong quaternion is refused when the camera reads it
    let (Some(from), Some(to)) = (unit(a), unit(b)) else { return a.value.node().value.clone() };
    let rotation = from.conjugate() * to;
    let rotation = if rotation.w < 0.0 { -rotation } else { rotation };
    let half_angle = rotation.xyz().length().atan2(rotation.w) * (frame - a.frame) / (b.frame - a.frame);
    let (sin, cos) = half_angle.sin_cos();
    let part = rotation.xyz().normalize_or_zero() * sin;
    let q = (from * DQuat::from_xyzw(part.x, part.y, part.z, cos)).normalize();
    let place = a.value.node().place;
    Value::List([q.w, q.x, q.y, q.z].map_each(|x| Node { value: Value::Float(x), place }).into())
}

/// Whole numbers as such, for the keys that want them.
fn whole(value: Value) -> Value {
    /// All whole f64 up to here are exact.
    const EXACT: f64 = (1u64 << 53) as f64;
    match value {
        Value::Float(x) if x.fract() == 0.0 && x.abs() <= EXACT => Value::Int(x as i128),
        Value::List(items) => Value::List(items.into_iter().map(|n| Node { value: whole(n.value), ..n }).collect()),
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use super::super::parse::{Format, parse};
    use super::*;
    use crate::input::Loading;
    use crate::input::reader::Source;
    use crate::input::tree::Place;
    use std::path::Path;

    /// The value of `key = TEXT` on line 2 at a frame.
    fn at(text: &str, frame: f64) -> Result<Value> {
        at_key("key", text, frame)
    }

    fn at_key(key: &str, text: &str, frame: f64) -> Result<Value> {
        let path = Path::new("s.toml");
        let mut root = parse(&format!("[camera]\n{key} = {text}\n"), Format::Toml, path)?;
        pick(&mut root, "", &Source::new(path, path, &Loading::default()), frame)?;
        Ok(entry(entry(root.value)))
    }

    /// The value of the first key.
    fn entry(table: Value) -> Value {
        let Value::Table(mut entries) = table else { unreachable!() };
        entries.remove(0).node.value
    }

    fn numbers(value: Value) -> Vec<f64> {
        match value {
            Value::List(items) => items.into_iter().flat_map(|n| numbers(n.value)).collect(),
            Value::Int(i) => vec![i as f64],
            Value::Float(x) => vec![x],
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn numbers_go_straight_from_key_to_key() {
        let keys = "[{ frame = -2, value = 1 }, { frame = 2, value = 4 }, { frame = 3.5, value = 4 }, { value = 0.5, frame = 4 }]";
        for (frame, value) in
            [(-1e300, 1.0), (-2.0, 1.0), (0.0, 2.5), (2.0, 4.0), (3.0, 4.0), (3.75, 2.25), (4.0, 0.5), (1e300, 0.5)]
        {
            assert_eq!(numbers(at(keys, frame).unwrap()), [value], "{frame}");
        }
    }

    #[test]
    fn lists_go_element_by_element_wherever_they_are() {
        let keys = "[{ frame = 0, value = [0, 8, 1] }, { frame = 4, value = [4, 0, 1] }]";
        assert_eq!(numbers(at(keys, 1.0).unwrap()), [1.0, 6.0, 1.0]);
        let inside = format!("{{ deep = [[{keys}], 7] }}");
        let Value::Table(entries) = at(&inside, 3.0).unwrap() else { panic!() };
        assert_eq!(numbers(entries[0].node.value.clone()), [3.0, 2.0, 1.0, 7.0]);
    }

    #[test]
    fn whole_numbers_stay_whole() {
        let int = |text, frame| at(text, frame).unwrap();
        for k in 0..=49 {
            let keys = "[{ frame = 0, value = 7 }, { frame = 49, value = 105 }]";
            assert_eq!(int(keys, f64::from(k)), Value::Int(7 + 2 * i128::from(k)), "{k}");
        }
        assert_eq!(int("[{ frame = 0, value = 4.0 }]", 9.0), Value::Int(4));
        let large = "[{ frame = 0, value = 18446744073709551615 }]";
        assert_eq!(int(large, 0.0), Value::Int(u64::MAX.into()));
        assert_eq!(int("[{ frame = 0, value = 1 }, { frame = 2, value = 2 }]", 1.0), Value::Float(1.5));
    }

    #[test]
    fn what_is_no_list_of_keys_stays() {
        for text in
            ["[]", "[1, 2]", "[{ frame = 1 }]", "[{ frame = 1, value = 2, more = 3 }]", "{ frame = 1, value = 2 }"]
        {
            let path = Path::new("s.toml");
            let plain = parse(&format!("[camera]\nkey = {text}\n"), Format::Toml, path).unwrap();
            let mut picked = plain.clone();
            pick(&mut picked, "", &Source::new(path, path, &Loading::default()), 1.0).unwrap();
            assert_eq!(plain, picked, "{text}");
        }
    }

    #[test]
    fn texts_name_the_file_of_their_frame() {
        let named = |text: &str, frame: f64| {
            let mut node = Node { value: Value::Text(text.into()), place: Place::Argument };
            number(&mut node, frame);
            let Value::Text(text) = node.value else { panic!() };
            text
        };
        for (text, frame, file) in [
            ("a{frame}.png", 7.0, "a7.png"),
            ("a{frame:04}.png", 7.9, "a0007.png"),
            ("{frame:03}/{frame}.exr", 12.0, "012/12.exr"),
            ("a{frame:04}.png", -3.0, "a-003.png"),
            ("a{frame:4}.png", 7.0, "a{frame:4}.png"),
            ("a{frames}.png", 7.0, "a{frames}.png"),
            ("a{frame", 7.0, "a{frame"),
            ("a.png", 7.0, "a.png"),
        ] {
            assert_eq!(named(text, frame), file);
        }
    }

    #[test]
    fn between_two_texts_there_are_both_and_a_share() {
        let at_file = |keys: &str, frame: f64| {
            let path = Path::new("s.toml");
            let mut root = parse(&format!("[[mesh]]\nfile = {keys}\n"), Format::Toml, path)?;
            pick(&mut root, "", &Source::new(path, path, &Loading::default()), frame)?;
            let Value::List(mut meshes) = entry(root.value) else { unreachable!() };
            Ok::<_, crate::input::Error>(entry(meshes.remove(0).value))
        };
        let keys = "[{ frame = 0, value = \"a\" }, { frame = 4, value = \"b\" }, { frame = 8, value = \"b\" }]";
        assert_eq!(at_file(keys, -1.0).unwrap(), Value::Text("a".into()));
        assert_eq!(at_file(keys, 4.0).unwrap(), Value::Text("b".into()));
        assert_eq!(at_file(keys, 6.0).unwrap(), Value::Text("b".into()));
        let Value::Table(entries) = at_file(keys, 1.0).unwrap() else { panic!() };
        let values: Vec<Value> = entries.into_iter().map(|e| e.node.value).collect();
        assert_eq!(values, [Value::Text("a".into()), Value::Text("b".into()), Value::Float(0.25)]);
        let mixed = at_file("[{ frame = 0, value = \"a\" }, { frame = 4, value = 1 }]", 1.0).unwrap_err().to_string();
        assert!(mixed.contains("file.1.value: the whole number 1 after the text \"a\""), "{mixed}");
        // at keys too, not only between them
        let other = at_key("picture", keys, 0.0).unwrap_err().to_string();
        assert!(other.contains("picture.0.value: expected a finite number"), "{other}");
    }

    #[test]
    fn quaternions_are_interpolated_on_the_sphere_the_shorter_way() {
        let about_y = |degrees: f64, sign: f64| {
            let (sin, cos) = (degrees.to_radians() / 2.0).sin_cos();
            format!("[{}, 0, {}, 0]", sign * cos, sign * sin)
        };
        let from = about_y(10.0, 3.0);
        // -q and a multiple of q are the same rotation as q
        for to in [about_y(130.0, 1.0), about_y(130.0, -1.0), about_y(130.0, 7.0)] {
            let text = format!("[{{ frame = 0, value = {from} }}, {{ frame = 4, value = {to} }}]");
            let path = Path::new("s.toml");
            let mut root = parse(&format!("quaternion = {text}"), Format::Toml, path).unwrap();
            pick(&mut root, "", &Source::new(path, path, &Loading::default()), 1.0).unwrap();
            let [w, x, y, z] = numbers(entry(root.value))[..] else { panic!() };
            let (sin, cos) = 20f64.to_radians().sin_cos();
            assert!((w - cos).abs() < 1e-15 && (y - sin).abs() < 1e-15 && x == 0.0 && z == 0.0, "{w} {x} {y} {z}");
        }
    }

    #[test]
    fn wrong_keys_say_where_and_why() {
        for (text, says) in [
            ("[{ frame = 1, value = 1 }, { frame = 1, value = 2 }]", "key.1.value: frame 1 comes after frame 1; put"),
            ("[{ frame = 2, value = 1 }, { frame = 1, value = 2 }]", "key.1.value: frame 1 comes after frame 2; put"),
            ("[{ frame = inf, value = 1 }]", "key.0.frame: expected a finite number"),
            ("[{ frame = \"a\", value = 1 }]", "key.0.frame: expected a finite number"),
            ("[{ frame = 0, value = nan }]", "key.0.value: expected a finite number"),
            ("[{ frame = 0, value = true }]", "key.0.value: expected a finite number, found true"),
            ("[{ frame = 0, value = [1, [2]] }]", "key.0.value: lists of lists have no keyframes"),
            (
                "[{ frame = 0, value = [1] }, { frame = 1, value = [1, 2] }]",
                "key.1.value: a list of 2 after a list of 1",
            ),
            (
                "[{ frame = 0, value = 1 }, { frame = 1, value = [1] }]",
                "key.1.value: a list of 1 after the whole number 1",
            ),
        ] {
            let error = at(text, 0.0).unwrap_err();
            assert!(error.to_string().starts_with(&format!("s.toml:2: camera.{says}")), "{text}: {error}");
        }
    }
}

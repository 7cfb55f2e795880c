//! Scene text, TOML or JSON, into the value tree with line numbers.

use std::cell::Cell;
use std::fmt;
use std::io::Read;
use std::path::Path;

use serde::de::{DeserializeSeed, Error as _, MapAccess, SeqAccess, Visitor};
use toml::de::{DeTable, DeValue};

use crate::input::tree::{Entry, Node, Place, Value};
use crate::input::{Error, Result};

/// The two spellings of a scene file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Format {
    Toml,
    Json,
}

impl Format {
    /// By the file's extension; a name without one (a pipe) is read as TOML.
    pub fn of(path: &Path) -> Result<Format> {
        match path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).as_deref() {
            None | Some("toml") => Ok(Format::Toml),
            Some("json") => Ok(Format::Json),
            Some(other) => Err(Error::input(format!(
                "{}: {other:?} is not a scene file's extension; a scene is a .toml or .json file",
                path.display()
            ))),
        }
    }
}

/// Parses a whole document. `path` is only named in errors.
pub(crate) fn parse(text: &str, format: Format, path: &Path) -> Result<Node> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    match format {
        Format::Toml => parse_toml(text, path),
        Format::Json => parse_json(text, path),
    }
}

/// Lines of JSON as one document with a list of them, each where it was.
pub(crate) fn listed(key: &str, lines: &str) -> String {
    let mut text = format!("{{\"{key}\": [");
    let mut is_first = true;
    for (k, line) in lines.lines().enumerate() {
        text.push_str(if k == 0 { "" } else { "\n" });
        if !line.trim().is_empty() {
            text.push_str(if is_first { "" } else { "," });
            text.push_str(line);
            is_first = false;
        }
    }
    text + "]}"
}

/// Parses the value of a `--set`: a TOML value, or else the text itself.
pub(crate) fn parse_set_value(text: &str) -> Node {
    let document = format!("value = {text}");
    let parsed = DeTable::parse(&document).ok().filter(|table| table.get_ref().len() == 1);
    let value = parsed.and_then(|table| {
        let (key, value) = table.into_inner().into_iter().next()?;
        (key.get_ref() == "value").then(|| toml_value(value.get_ref(), &|_| Place::Set))
    });
    Node { value: value.unwrap_or_else(|| Value::Text(text.into())), place: Place::Set }
}

fn parse_toml(text: &str, path: &Path) -> Result<Node> {
    let newlines: Vec<usize> = text.match_indices('\n').map(|(at, _)| at).collect();
    let line_of = |at: usize| 1 + newlines.partition_point(|&newline| newline < at);
    let table = DeTable::parse(text).map_err(|e| {
        let line = e.span().map_or(1, |span| line_of(span.start));
        // Two long messages of the parser have several lines.
        let message = e.message().replace('\n', " ");
        Error::input(format!("{}:{line}: not valid TOML: {message}", path.display()))
    })?;
    let place_of = |at: usize| Place::Line(u32::try_from(line_of(at)).unwrap_or(u32::MAX));
    Ok(Node { value: toml_table(table.get_ref(), &place_of), place: Place::Line(1) })
}

fn toml_table(table: &DeTable, place_of: &dyn Fn(usize) -> Place) -> Value {
    let entries = table.iter().map(|(key, value)| Entry {
        key: key.get_ref().to_string(),
        place: place_of(key.span().start),
        node: Node { value: toml_value(value.get_ref(), place_of), place: place_of(value.span().start) },
    });
    Value::Table(entries.collect())
}

fn toml_value(value: &DeValue, place_of: &dyn Fn(usize) -> Place) -> Value {
    match value {
        DeValue::String(s) => Value::Text(s.to_string()),
        DeValue::Boolean(b) => Value::Bool(*b),
        DeValue::Datetime(d) => Value::Text(d.to_string()),
        // An integer beyond i128 is out of every key's range: keep it as the float it is near.
        DeValue::Integer(i) => match i128::from_str_radix(i.as_str(), i.radix()) {
            Ok(i) => Value::Int(i),
            Err(_) => Value::Float(i.as_str().parse().unwrap_or(f64::INFINITY)),
        },
        DeValue::Float(x) => Value::Float(x.as_str().parse().unwrap_or(f64::NAN)),
        DeValue::Array(items) => {
            let node =
                |item: &toml::Spanned<DeValue>| (toml_value(item.get_ref(), place_of), place_of(item.span().start));
            Value::List(items.iter().map(node).map(|(value, place)| Node { value, place }).collect())
        }
        DeValue::Table(table) => toml_table(table, place_of),
    }
}

fn parse_json(text: &str, path: &Path) -> Result<Node> {
    let line = Cell::new(1);
    let reader = LineReader { rest: text.as_bytes(), line: &line, pending: 0 };
    let mut json = serde_json::Deserializer::from_reader(reader);
    let parsed = NodeSeed { line: &line }.deserialize(&mut json).and_then(|node| json.end().map(|()| node));
    parsed.map_err(|e| json_error(&e, path))
}

/// One line for an error of the JSON parser: its own position becomes `file:line:`.
pub(crate) fn json_error(e: &serde_json::Error, path: &Path) -> Error {
    let text = e.to_string().replace('\n', " ");
    let message = text.split(" at line ").next().unwrap_or(&text);
    Error::input(format!("{}:{}: not valid here: {message}", path.display(), e.line().max(1)))
}

/// Hands out one byte a call, so that `line` is that of the last byte the parser has seen. (The
/// parser asks for single bytes and looks at most one ahead; a newline counts once it is passed.)
struct LineReader<'a> {
    rest: &'a [u8],
    line: &'a Cell<u32>,
    pending: u32,
}

impl Read for LineReader<'_> {
    fn read(&mut self, out: &mut [u8]) -> std::io::Result<usize> {
        let (Some((&byte, rest)), Some(slot)) = (self.rest.split_first(), out.first_mut()) else { return Ok(0) };
        *slot = byte;
        self.rest = rest;
        self.line.set(self.line.get().saturating_add(self.pending));
        self.pending = u32::from(byte == b'\n');
        Ok(1)
    }
}

/// Builds a [`Node`] from any JSON value.
struct NodeSeed<'a> {
    line: &'a Cell<u32>,
}

impl NodeSeed<'_> {
    fn place(&self) -> Place {
        Place::Line(self.line.get())
    }

    fn node<E>(&self, value: Value) -> std::result::Result<Node, E> {
        Ok(Node { value, place: self.place() })
    }
}

impl<'de> DeserializeSeed<'de> for NodeSeed<'_> {
    type Value = Node;

    fn deserialize<D: serde::Deserializer<'de>>(self, json: D) -> std::result::Result<Node, D::Error> {
        json.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for NodeSeed<'_> {
    type Value = Node;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a JSON value")
    }

    fn visit_unit<E>(self) -> std::result::Result<Node, E> {
        self.node(Value::Null)
    }

    fn visit_bool<E>(self, v: bool) -> std::result::Result<Node, E> {
        self.node(Value::Bool(v))
    }

    fn visit_i64<E>(self, v: i64) -> std::result::Result<Node, E> {
        self.node(Value::Int(v.into()))
    }

    fn visit_u64<E>(self, v: u64) -> std::result::Result<Node, E> {
        self.node(Value::Int(v.into()))
    }

    fn visit_f64<E>(self, v: f64) -> std::result::Result<Node, E> {
        self.node(Value::Float(v))
    }

    fn visit_str<E>(self, v: &str) -> std::result::Result<Node, E> {
        self.node(Value::Text(v.into()))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> std::result::Result<Node, A::Error> {
        let place = self.place();
        let mut items = Vec::new();
        while let Some(item) = seq.next_element_seed(NodeSeed { line: self.line })? {
            items.push(item);
        }
        Ok(Node { value: Value::List(items), place })
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> std::result::Result<Node, A::Error> {
        let place = self.place();
        let mut entries: Vec<Entry> = Vec::new();
        let mut keys = std::collections::HashSet::new();
        while let Some(key) = map.next_key::<String>()? {
            let key_place = self.place();
            if !keys.insert(key.clone()) {
                return Err(A::Error::custom(format!("the key {key:?} is there twice; keep one")));
            }
            let node = map.next_value_seed(NodeSeed { line: self.line })?;
            entries.push(Entry { key, place: key_place, node });
        }
        Ok(Node { value: Value::Table(entries), place })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line_at(node: &Node, keys: &[&str]) -> (Place, Place) {
        let mut node = node;
        let mut key_place = node.place;
        for key in keys {
            match &node.value {
                Value::Table(entries) => {
                    let entry = entries.iter().find(|e| e.key == *key).unwrap();
                    (node, key_place) = (&entry.node, entry.place);
                }
                Value::List(items) => node = &items[key.parse::<usize>().unwrap()],
                other => panic!("{other:?} has no {key}"),
            }
        }
        (key_place, node.place)
    }

    #[test]
    fn toml_lines_are_those_of_the_keys() {
        let text = "a = 1\n[t]\nb = [\n 1,\n 2]\n[[m]]\nc = 'x'\n[[m]]\nc = 'y'\n";
        let node = parse(text, Format::Toml, Path::new("x.toml")).unwrap();
        assert_eq!(line_at(&node, &["a"]).0, Place::Line(1));
        assert_eq!(line_at(&node, &["t"]).0, Place::Line(2));
        assert_eq!(line_at(&node, &["t", "b"]).0, Place::Line(3));
        assert_eq!(line_at(&node, &["t", "b", "1"]).1, Place::Line(5));
        assert_eq!(line_at(&node, &["m", "1", "c"]).0, Place::Line(9));
    }

    #[test]
    fn json_lines_are_those_of_the_keys() {
        let text = "{\n \"a\": 1,\n \"b\": {\n  \"c\":\n   12\n , \"d\": [1,\n2\n]},\n\"e\": 5\n}";
        let node = parse(text, Format::Json, Path::new("x.json")).unwrap();
        assert_eq!(line_at(&node, &["a"]), (Place::Line(2), Place::Line(2)));
        assert_eq!(line_at(&node, &["b", "c"]), (Place::Line(4), Place::Line(5)));
        assert_eq!(line_at(&node, &["b", "d", "1"]).1, Place::Line(7));
        assert_eq!(line_at(&node, &["e"]), (Place::Line(9), Place::Line(9)));
    }

    #[test]
    fn syntax_errors_name_file_and_line_once() {
        let toml = parse("a = 1\nb = = 2\n", Format::Toml, Path::new("s.toml")).unwrap_err().to_string();
        assert!(toml.starts_with("s.toml:2: not valid TOML: "), "{toml}");
        let json = parse("{\n\"a\": 1,\n\"b\" 2}", Format::Json, Path::new("s.json")).unwrap_err().to_string();
        assert_eq!(json, "s.json:3: not valid here: expected `:`");
        let twice = parse("{\"a\":1,\n\"a\":2}", Format::Json, Path::new("s.json")).unwrap_err().to_string();
        assert!(twice.starts_with("s.json:2: ") && twice.contains("twice"), "{twice}");
    }

    #[test]
    fn deep_nesting_is_an_error_and_not_a_stack_overflow() {
        let deep = 200_000;
        for text in [
            format!("a = {}", "[".repeat(deep)),
            format!("a = {}", "{b = ".repeat(deep)),
            format!("{}b = 1", "a.".repeat(deep)),
            format!("[{}b]", "a.".repeat(deep)),
            format!("a = {}1{}", "[".repeat(deep), "]".repeat(deep)),
        ] {
            assert!(parse(&text, Format::Toml, Path::new("s.toml")).is_err());
        }
        for text in ["[".repeat(deep), "{\"a\":".repeat(deep)] {
            assert!(parse(&text, Format::Json, Path::new("s.json")).is_err());
        }
    }

    #[test]
    fn set_values_are_toml_or_else_text() {
        let value = |text| parse_set_value(text).value;
        assert_eq!(value("40"), Value::Int(40));
        assert_eq!(value(" 4e1"), Value::Float(40.0));
        assert_eq!(value("true"), Value::Bool(true));
        assert_eq!(value("out.png"), Value::Text("out.png".into()));
        assert_eq!(value("\"40\""), Value::Text("40".into()));
        assert_eq!(value("1\nother = 2"), Value::Text("1\nother = 2".into()));
        assert_eq!(value(""), Value::Text("".into()));
        assert!(matches!(value("[0, inf]"), Value::List(items) if items.len() == 2));
    }
}

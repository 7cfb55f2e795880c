//! The value tree of TOML, JSON and `--set`; each value knows its source position.

/// Where a value was written, for error messages.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Place {
    /// Line of the scene file, counted from 1.
    Line(u32),
    /// A `--set` on the command line.
    Set,
    /// An argument of a function.
    Argument,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Node {
    pub value: Value,
    pub place: Place,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Value {
    /// JSON only; no key accepts it.
    Null,
    Bool(bool),
    /// Wide enough for every i64 and u64.
    Int(i128),
    Float(f64),
    Text(String),
    List(Vec<Node>),
    /// Keys are unique.
    Table(Vec<Entry>),
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Entry {
    pub key: String,
    /// Position of the key; for a table that of its header.
    pub place: Place,
    pub node: Node,
}

impl Node {
    /// The same value, written at `place` with all that it holds.
    pub fn placed(self, place: Place) -> Node {
        let value = match self.value {
            Value::List(items) => Value::List(items.into_iter().map(|item| item.placed(place)).collect()),
            Value::Table(entries) => {
                Value::Table(entries.into_iter().map(|e| Entry { place, node: e.node.placed(place), ..e }).collect())
            }
            plain => plain,
        };
        Node { value, place }
    }
}

/// Longest part of a text that an error message quotes, in characters.
const QUOTED_CHARS: usize = 40;

impl Value {
    /// A list or a table.
    pub fn holds_more(&self) -> bool {
        matches!(self, Value::List(_) | Value::Table(_))
    }

    /// As TOML that `--set` reads back; `None` where a null is in it.
    pub fn inline(&self) -> Option<String> {
        // escapes of JSON are TOML's
        let quoted = |text: &str| serde_json::Value::from(text).to_string();
        Some(match self {
            Value::Null => return None,
            Value::Bool(b) => b.to_string(),
            Value::Int(i) => i.to_string(),
            Value::Float(x) => format!("{x:?}"),
            Value::Text(t) => quoted(t),
            Value::List(items) => {
                let items: Vec<String> = items.iter().map(|item| item.value.inline()).collect::<Option<_>>()?;
                format!("[{}]", items.join(", "))
            }
            Value::Table(entries) => {
                let entry = |e: &Entry| Some(format!("{} = {}", quoted(&e.key), e.node.value.inline()?));
                let entries: Vec<String> = entries.iter().map(entry).collect::<Option<_>>()?;
                format!("{{ {} }}", entries.join(", "))
            }
        })
    }

    /// The name of this kind of value, for "expected ..., found ...".
    pub fn describe(&self) -> String {
        match self {
            Value::Null => "null".into(),
            Value::Bool(b) => b.to_string(),
            Value::Int(i) => format!("the whole number {i}"),
            Value::Float(x) => format!("the number {x}"),
            Value::Text(t) => format!("the text {}", quote(t)),
            Value::List(items) => format!("a list of {}", items.len()),
            Value::Table(_) => "a table".into(),
        }
    }
}

/// `text` in quotes on one line, cut where it is long.
pub(crate) fn quote(text: &str) -> String {
    match text.char_indices().nth(QUOTED_CHARS) {
        Some((cut, _)) => format!("{:?}...", &text[..cut]),
        None => format!("{text:?}"),
    }
}

/// The candidate with the smallest edit distance to the start of `word`; the first of several.
pub(crate) fn nearest<'a>(word: &str, candidates: &[&'a str]) -> Option<&'a str> {
    let word: String = word.chars().take(QUOTED_CHARS).collect();
    candidates.iter().copied().min_by_key(|candidate| strsim::levenshtein(&word, candidate))
}

/// A hint for a name that is unknown: `; did you mean "a" or "b"?`. Candidates that contain it come first, or else those with the fewest edits,
/// at most one in three letters; empty without either.
#[cfg(feature = "cli")]
pub(crate) fn did_you_mean(word: &str, candidates: &[&str]) -> String {
    let word: String = word.chars().take(QUOTED_CHARS).collect::<String>().to_lowercase();
    let mut near: Vec<&str> =
        candidates.iter().copied().filter(|name| word.chars().count() > 2 && name.contains(&word)).collect();
    if near.is_empty() {
        let edits = |name: &&str| strsim::damerau_levenshtein(&word, name);
        let within = |edits: &usize| 3 * edits <= word.chars().count();
        let least = candidates.iter().map(edits).min().filter(within);
        near = candidates.iter().copied().filter(|name| Some(edits(name)) == least).collect();
    }
    let quoted: Vec<String> = near.iter().take(3).map(|name| format!("{name:?}")).collect();
    if quoted.is_empty() { String::new() } else { format!("; did you mean {}?", quoted.join(" or ")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(feature = "cli")]
    #[test]
    fn hints_name_what_is_near_and_nothing_else() {
        let known = ["fisheye", "projector-dome", "projector-wall", "lidar", "linear"];
        for (word, hint) in [
            ("fishey", "; did you mean \"fisheye\"?"),
            ("fishye", "; did you mean \"fisheye\"?"),
            ("Lidra", "; did you mean \"lidar\"?"),
            ("projector", "; did you mean \"projector-dome\" or \"projector-wall\"?"),
            // two letters are in many names
            ("li", ""),
            ("", ""),
            ("teapot", ""),
        ] {
            assert_eq!(did_you_mean(word, &known), hint, "{word}");
        }
    }

    #[test]
    fn nearest_names_the_closest() {
        assert_eq!(nearest("tagret", &["eye", "target", "up"]), Some("target"));
        assert_eq!(nearest("x", &[]), None);
    }

    #[test]
    fn quotes_stay_short_and_on_one_line() {
        assert_eq!(quote("a\nb"), r#""a\nb""#);
        assert!(quote(&"é".repeat(1000)).chars().count() < 50);
    }
}

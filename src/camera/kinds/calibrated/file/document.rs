//! The text of a calibration file as a document: a tree of values (YAML or JSON), XML, or plain text.

use indexmap::IndexMap;
use serde::de::{DeserializeSeed, Deserializer, Error as _, IgnoredAny, MapAccess, SeqAccess, Visitor};
use std::cell::Cell;
use std::fmt;

pub type Result<T> = std::result::Result<T, String>;

/// A calibration file's text, parsed.
pub enum Document<'a> {
    Tree(Tree),
    Xml(roxmltree::Document<'a>),
    /// Other text, and why it is no YAML if that was the reason.
    Text(&'a str, Option<String>),
}

/// A value of a YAML or JSON file.
#[derive(Debug, Clone, PartialEq)]
pub enum Tree {
    Null,
    Bool(bool),
    Number(f64),
    Text(String),
    List(Vec<Tree>),
    Table(IndexMap<String, Tree>),
}

impl<'a> Document<'a> {
    /// Parses JSON if the text begins with a bracket or brace, XML if it begins with `<`, else YAML; text that is no table of YAML stays
    /// text. Of several YAML documents, as `rostopic echo` writes, the first counts.
    ///
    /// # Errors
    /// One line: the text begins as JSON, XML or `%YAML` and is not valid, or is too large.
    pub fn parse(text: &'a str) -> Result<Document<'a>> {
        let text = text.trim_start_matches('\u{feff}').trim_start();
        if text.starts_with('<') {
            let document = roxmltree::Document::parse(text).map_err(|e| one_line(&e))?;
            return Ok(Document::Xml(document));
        }
        // "[image]" heads the .ini files of ROS
        if text.starts_with('{') || text.starts_with('[') && !text.starts_with("[image]") {
            let mut json = serde_json::Deserializer::from_str(text);
            let tree = Seed(&Cell::new(0)).deserialize(&mut json).and_then(|tree| json.end().map(|()| tree));
            return tree.map(Document::Tree).map_err(|e| one_line(&e));
        }
        let first = first_document(text);
        check_brackets(first)?;
        let yaml = if first.starts_with(OPENCV) { from_opencv(first) } else { first.into() };
        let first = serde_norway::Deserializer::from_str(&yaml).next();
        match first.map(|document| Seed(&Cell::new(0)).deserialize(document)) {
            Some(Ok(tree @ Tree::Table(_))) => Ok(Document::Tree(tree)),
            Some(Err(e)) if text.starts_with("%YAML") => Err(one_line(&e)),
            Some(Err(e)) => Ok(Document::Text(text, Some(one_line(&e)))),
            _ => Ok(Document::Text(text, None)),
        }
    }

    /// The tree, without any key for XML and other text.
    pub fn tree(&self) -> &Tree {
        static NOTHING: Tree = Tree::Null;
        if let Document::Tree(tree) = self { tree } else { &NOTHING }
    }

    pub fn text(&self) -> Option<&'a str> {
        if let Document::Text(text, _) = self { Some(text) } else { None }
    }

    /// The root of an XML document, if it has this name.
    pub fn root(&self, name: &str) -> Option<roxmltree::Node<'_, 'a>> {
        match self {
            Document::Xml(document) => Some(document.root_element()).filter(|root| root.has_tag_name(name)),
            _ => None,
        }
    }
}

/// Cuts a YAML text after its first document.
fn first_document(text: &str) -> &str {
    let (mut end, mut has_begun) = (0, false);
    for line in text.split_inclusive('\n') {
        let is_mark = line.trim_end() == "---";
        if is_mark && has_begun {
            return &text[..end];
        }
        has_begun |= !(is_mark || line.trim().is_empty() || line.starts_with(['#', '%']));
        end += line.len();
    }
    text
}

/// First line of a YAML file of OpenCV.
const OPENCV: &str = "%YAML:1.0";

/// Converts YAML as OpenCV reads it to YAML: its first line becomes a comment, so that lines keep their numbers, and a space follows each
/// key's colon. ORB-SLAM's own settings have `Viewer.PointSize:2` and `data:[...]`.
fn from_opencv(text: &str) -> String {
    let spaced = |line: &str| {
        let is_of_key = |c: char| c.is_ascii_alphanumeric() || matches!(c, '_' | '.' | '-');
        let key = line.trim_start().trim_start_matches(is_of_key).len();
        let (key, rest) = line.split_at(line.len() - key);
        match rest.strip_prefix(':') {
            Some(value)
                if !(key.trim().is_empty() || value.is_empty() || value.starts_with([' ', '\t', '\r', '\n'])) =>
            {
                format!("{key}: {value}")
            }
            _ => line.into(),
        }
    };
    text.replacen(OPENCV, "# YAML 1.0", 1).split_inclusive('\n').map(spaced).collect()
}

pub fn one_line(e: &dyn fmt::Display) -> String {
    e.to_string().replace('\n', " ")
}

/// Most lists and tables in brackets of a YAML file. A calibration has some tens; the parser's time grows with the square of nested ones.
const BRACKETS_MAX: usize = 10_000;

fn check_brackets(text: &str) -> Result<()> {
    let count = text.bytes().filter(|b| matches!(b, b'[' | b'{')).count();
    if count <= BRACKETS_MAX {
        return Ok(());
    }
    Err(format!(
        "has {count} lists and tables in brackets, over the limit of {BRACKETS_MAX}; remove all but the camera's keys"
    ))
}

/// Most values of a file: those of 100,000 images with a pose each. Aliases of YAML repeat values.
const VALUES_MAX: usize = 1 << 21;

/// Keys whose values are left out: the reconstructed points of OpenSfM and AliceVision, of which there may be millions.
const LEFT_OUT: [&str; 2] = ["points", "structure"];

/// Builds a [`Tree`] from YAML or JSON, and counts its values.
struct Seed<'a>(&'a Cell<usize>);

impl<'de> DeserializeSeed<'de> for Seed<'_> {
    type Value = Tree;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> std::result::Result<Tree, D::Error> {
        self.0.set(self.0.get() + 1);
        if self.0.get() > VALUES_MAX {
            return Err(D::Error::custom(format_args!("it has more than {VALUES_MAX} values")));
        }
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for Seed<'_> {
    type Value = Tree;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a value")
    }

    fn visit_unit<E>(self) -> std::result::Result<Tree, E> {
        Ok(Tree::Null)
    }

    fn visit_bool<E>(self, v: bool) -> std::result::Result<Tree, E> {
        Ok(Tree::Bool(v))
    }

    fn visit_i64<E>(self, v: i64) -> std::result::Result<Tree, E> {
        Ok(Tree::Number(v as f64))
    }

    fn visit_u64<E>(self, v: u64) -> std::result::Result<Tree, E> {
        Ok(Tree::Number(v as f64))
    }

    fn visit_f64<E>(self, v: f64) -> std::result::Result<Tree, E> {
        Ok(Tree::Number(v))
    }

    fn visit_str<E>(self, v: &str) -> std::result::Result<Tree, E> {
        Ok(Tree::Text(v.into()))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> std::result::Result<Tree, A::Error> {
        let mut items = Vec::new();
        while let Some(item) = seq.next_element_seed(Seed(self.0))? {
            items.push(item);
        }
        Ok(Tree::List(items))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> std::result::Result<Tree, A::Error> {
        let mut entries = IndexMap::new();
        while let Some(key) = map.next_key::<String>()? {
            if LEFT_OUT.contains(&key.as_str()) {
                map.next_value::<IgnoredAny>()?;
                continue;
            }
            let value = map.next_value_seed(Seed(self.0))?;
            if entries.contains_key(&key) {
                return Err(A::Error::custom(format_args!("the key {key:?} is there twice; keep one")));
            }
            entries.insert(key, value);
        }
        Ok(Tree::Table(entries))
    }
}

impl Tree {
    /// The value of a key; `None` if it is absent or null, or if this is no table.
    pub fn get(&self, key: &str) -> Option<&Tree> {
        match self {
            Tree::Table(entries) => entries.get(key).filter(|value| **value != Tree::Null),
            _ => None,
        }
    }

    /// The value at the end of keys of tables in tables.
    pub fn at(&self, keys: &[&str]) -> Option<&Tree> {
        keys.iter().try_fold(self, |tree, key| tree.get(key))
    }

    pub fn has(&self, keys: &[&str]) -> bool {
        keys.iter().all(|key| self.get(key).is_some())
    }

    pub fn is_table(&self) -> bool {
        matches!(self, Tree::Table(_))
    }

    pub fn entries(&self) -> impl Iterator<Item = (&str, &Tree)> {
        let entries = if let Tree::Table(entries) = self { Some(entries) } else { None };
        entries.into_iter().flatten().map(|(key, value)| (key.as_str(), value))
    }

    /// The items of a list; none of anything else.
    pub fn items(&self) -> &[Tree] {
        if let Tree::List(items) = self { items } else { &[] }
    }

    pub fn text(&self) -> Option<&str> {
        if let Tree::Text(text) = self { Some(text) } else { None }
    }

    /// A finite number, also one that is written as text.
    pub fn number(&self) -> Option<f64> {
        let number = match self {
            Tree::Number(number) => Some(*number),
            Tree::Text(text) => text.trim().parse().ok(),
            _ => None,
        };
        number.filter(|x: &f64| x.is_finite())
    }

    /// The finite numbers of a list, of lists in a list, of a matrix's `data`, or of text with spaces between them.
    pub fn numbers(&self) -> Option<Vec<f64>> {
        match self {
            Tree::List(items) => {
                let mut all = Vec::new();
                for item in items {
                    match item {
                        Tree::List(_) => all.extend(item.numbers()?),
                        _ => all.push(item.number()?),
                    }
                }
                Some(all)
            }
            Tree::Table(_) => self.get("data")?.numbers(),
            Tree::Text(text) => {
                let number = |word: &str| word.parse().ok().filter(|x: &f64| x.is_finite());
                text.split_ascii_whitespace().map(number).collect()
            }
            _ => None,
        }
    }

    /// # Errors
    /// The key is missing.
    pub fn need(&self, key: &str) -> Result<&Tree> {
        self.get(key).ok_or_else(|| format!("{key} is missing"))
    }

    /// # Errors
    /// The key is missing, or its value is no finite number.
    pub fn need_number(&self, key: &str) -> Result<f64> {
        self.need(key)?.number().ok_or_else(|| format!("{key} must be a finite number"))
    }

    /// # Errors
    /// The key's value is no finite number.
    pub fn number_or(&self, key: &str, default: f64) -> Result<f64> {
        self.get(key).map_or(Ok(default), |_| self.need_number(key))
    }

    /// # Errors
    /// A key's value is no finite number.
    pub fn numbers_or_0<const N: usize>(&self, keys: [&str; N]) -> Result<[f64; N]> {
        each(keys, |key| self.number_or(key, 0.0))
    }

    /// # Errors
    /// A key is missing, or its value is no finite number.
    pub fn need_each<const N: usize>(&self, keys: [&str; N]) -> Result<[f64; N]> {
        each(keys, |key| self.need_number(key))
    }

    /// # Errors
    /// The key is missing, or its value is no list of finite numbers.
    pub fn need_numbers(&self, key: &str) -> Result<Vec<f64>> {
        self.need(key)?.numbers().ok_or_else(|| format!("{key} must be a list of finite numbers"))
    }

    /// # Errors
    /// The key is missing, or its value is no list of N finite numbers.
    pub fn need_list<const N: usize>(&self, key: &str) -> Result<[f64; N]> {
        let all = self.need_numbers(key)?;
        <[f64; N]>::try_from(&all[..]).map_err(|_| format!("{key} must be a list of {N} numbers, not {}", all.len()))
    }

    /// # Errors
    /// The key is missing, or its value is no text.
    pub fn need_text(&self, key: &str) -> Result<&str> {
        self.need(key)?.text().ok_or_else(|| format!("{key} must be a text"))
    }

    /// Width and height.
    ///
    /// # Errors
    /// A key is missing, or its value is no whole number.
    pub fn need_size(&self, keys: [&str; 2]) -> Result<[u64; 2]> {
        whole(self.need_each(keys)?).map_err(|why| format!("{} and {}: {why}", keys[0], keys[1]))
    }
}

/// The numbers of some keys, up to the first error.
pub fn each<const N: usize>(keys: [&str; N], number: impl Fn(&str) -> Result<f64>) -> Result<[f64; N]> {
    let mut all = [0.0; N];
    for (value, key) in all.iter_mut().zip(keys) {
        *value = number(key)?;
    }
    Ok(all)
}

/// A size that is written as numbers, which may have a decimal point.
pub fn whole(size: [f64; 2]) -> Result<[u64; 2]> {
    let [width, height] = size;
    if size.iter().any(|s| s.fract() != 0.0 || *s < 0.0) {
        return Err(format!("{width} x {height} must be whole numbers"));
    }
    // what is too large becomes u64::MAX, which is refused as a size
    Ok([width as u64, height as u64])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tree(text: &str) -> Tree {
        match Document::parse(text).unwrap() {
            Document::Tree(tree) => tree,
            _ => panic!("no tree: {text}"),
        }
    }

    #[test]
    fn yaml_and_json_are_the_same_tree() {
        let yaml = "%YAML:1.0\n---\na: 1.\nb: [1, [2, 3e0]]\nc: !!opencv-matrix\n  data: [ 4 ]\nd: '5'\n";
        let json = "{\"a\": 1, \"b\": [1, [2, 3]], \"c\": {\"data\": [4]}, \"d\": \"5\"}";
        assert_eq!(tree(yaml), tree(json));
        let tree = tree(yaml);
        assert_eq!(tree.need_list::<3>("b"), Ok([1.0, 2.0, 3.0]));
        assert_eq!((tree.need_numbers("c"), tree.need_number("d")), (Ok(vec![4.0]), Ok(5.0)));
        assert_eq!(tree.need_number("e").unwrap_err(), "e is missing");
        assert_eq!(tree.need_number("b").unwrap_err(), "b must be a finite number");
    }

    #[test]
    fn the_first_of_several_yaml_documents_counts() {
        assert_eq!(tree("a: 1\n---\na: 2\n---\n"), tree("a: 1\n"));
        // messages of an hour have more brackets than a calibration may have
        let messages = format!("# of a topic\n---\na: 1\n{}", "---\na: [2]\n".repeat(BRACKETS_MAX + 1));
        assert_eq!(tree(&messages), tree("a: 1\n"));
    }

    #[test]
    fn keys_of_opencv_need_no_space() {
        let text = "%YAML:1.0\r\n---\r\na.b:2\r\nc: !!opencv-matrix\n  data:[1,\n    2]\nd: \"x:y\"\ne:\n  - 1:2\n";
        let spaced = "a.b: 2\nc:\n  data: [1, 2]\nd: 'x:y'\ne:\n  - '1:2'\n";
        assert_eq!(tree(text), tree(spaced));
        // YAML has no such key
        assert!(matches!(Document::parse("a:2\n").unwrap(), Document::Text(..)));
    }

    #[test]
    fn a_key_that_is_there_twice_is_refused() {
        for text in ["{\"a\": 1, \"a\": 2}", "%YAML:1.0\na: 1\na: 2\n"] {
            let error = Document::parse(text).err().unwrap();
            assert!(error.contains("\"a\" is there twice") && !error.contains('\n'), "{error}");
        }
    }

    #[test]
    fn reconstructed_points_are_left_out() {
        let points = vec!["{\"x\": [1, 2, 3]}"; VALUES_MAX / 4].join(", ");
        assert_eq!(tree(&format!("{{\"points\": [{points}], \"a\": 1}}")), tree("{\"a\": 1}"));
        assert!(Document::parse(&format!("{{\"other\": [{points}]}}")).is_err());
    }

    /// Ten levels of eight aliases are 2^30 values.
    #[test]
    fn aliases_do_not_fill_the_memory() {
        let levels = (1..10).map(|n| format!("a{n}: &a{n} [{}]\n", vec![format!("*a{}", n - 1); 8].join(", ")));
        let text = format!("%YAML:1.0\n---\na0: &a0 [1, 1, 1, 1, 1, 1, 1, 1]\n{}", levels.collect::<String>());
        assert!(Document::parse(&text).is_err());
    }
}

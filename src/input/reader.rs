//! Typed reading of the value tree. Every error is one line: where, what is wrong, and what to write.

use crate::arrays::MapEach;
use std::cell::Cell;
use std::path::{Path, PathBuf};

use glam::{DAffine3, DMat3, DVec3};

use crate::input::tree::{Entry, Node, Place, Value, nearest, quote};
use crate::input::{Error, Limits, Loading, Result};

/// The file that is being read.
pub struct Source<'a> {
    /// Its name in errors.
    pub path: &'a Path,
    /// Folder that relative paths start from.
    pub dir: &'a Path,
    /// The load that reads the files which this one names.
    pub loading: &'a Loading,
    /// A value was read as a file name.
    names_files: Cell<bool>,
}

impl<'a> Source<'a> {
    pub fn new(path: &'a Path, dir: &'a Path, loading: &'a Loading) -> Source<'a> {
        Source { path, dir, loading, names_files: Cell::new(false) }
    }

    /// Whether a value was read as a file name so far.
    pub fn names_files(&self) -> bool {
        self.names_files.get()
    }
}

/// One value and the dotted key that leads to it (`mesh.0.scale`).
#[derive(Clone)]
pub struct Field<'a> {
    source: &'a Source<'a>,
    key: String,
    place: Place,
    node: &'a Node,
}

/// A table whose keys are all known.
pub struct Table<'a> {
    field: Field<'a>,
    entries: &'a [Entry],
    /// Keys that [`Table::allow`] lets pass, because others read them.
    read_elsewhere: &'static [&'static str],
}

impl<'a> Field<'a> {
    /// `key` leads to `node`; it is empty for the whole file.
    pub(crate) fn new(source: &'a Source<'a>, key: &str, node: &'a Node) -> Self {
        Field { source, key: key.into(), place: node.place, node }
    }

    /// The same value in another source.
    pub(crate) fn of(self, source: &'a Source<'a>) -> Self {
        Field { source, ..self }
    }

    pub(crate) fn node(&self) -> &'a Node {
        self.node
    }

    /// The load that reads the files named here.
    pub fn loading(&self) -> &'a Loading {
        self.source.loading
    }

    /// The limits of the load.
    pub fn limits(&self) -> Limits {
        self.source.loading.limits()
    }

    /// An error about this value: `scene.toml:12: camera.vfov: message`.
    pub fn error(&self, message: impl std::fmt::Display) -> Error {
        let key = if self.key.is_empty() { String::new() } else { format!("{}: ", self.key) };
        error_at(self.source, self.place, format_args!("{key}{message}"))
    }

    fn wrong(&self, expected: &str) -> Error {
        let is_key =
            |value: &Value| matches!(value, Value::Table(e) if e.iter().any(|e| ["frame", "value"].contains(&&*e.key)));
        let is_keyed = match &self.node.value {
            Value::List(items) => items.iter().any(|item| is_key(&item.value)),
            value => is_key(value),
        };
        let hint = if is_keyed { "; each keyframe has the keys frame and value, and no other" } else { "" };
        self.error(format_args!("expected {expected}, found {}{hint}", self.node.value.describe()))
    }

    pub fn is_table(&self) -> bool {
        matches!(self.node.value, Value::Table(_))
    }

    pub fn is_list(&self) -> bool {
        matches!(self.node.value, Value::List(_))
    }

    /// The value as `--set` reads it back.
    pub fn inline(&self) -> Result<String> {
        self.node.value.inline().ok_or_else(|| self.error("null is no value"))
    }

    /// A finite number.
    pub fn number(&self) -> Result<f64> {
        let number = self.number_or_inf("a finite number")?;
        if number.is_finite() { Ok(number) } else { Err(self.wrong("a finite number")) }
    }

    /// A number, +-inf (also as the texts "inf", "+inf", "-inf"), not NaN. `expected` is what the error asks for.
    pub fn number_or_inf(&self, expected: &str) -> Result<f64> {
        match &self.node.value {
            Value::Int(i) => Ok(*i as f64),
            Value::Float(x) if !x.is_nan() => Ok(*x),
            Value::Text(t) => match t.as_str() {
                "inf" | "+inf" => Ok(f64::INFINITY),
                "-inf" => Ok(f64::NEG_INFINITY),
                _ => Err(self.wrong(expected)),
            },
            _ => Err(self.wrong(expected)),
        }
    }

    /// A number that is one in f32 too.
    pub fn above_zero(&self) -> Result<f64> {
        let is_number = |value| (f64::from(f32::MIN_POSITIVE)..=f64::from(f32::MAX)).contains(&value);
        self.number_if(is_number, "is out of range; use a number above 0, from 1e-37 to 1e38")
    }

    /// A finite number that `suits`. The error of another is the number with `wrong` behind it.
    pub fn number_if(&self, suits: impl Fn(f64) -> bool, wrong: impl std::fmt::Display) -> Result<f64> {
        match self.number()? {
            value if suits(value) => Ok(value),
            value => Err(self.error(format_args!("{value} {wrong}"))),
        }
    }

    /// One of two values, by its name.
    pub fn choice<T>(&self, [(a, first), (b, second)]: [(&str, T); 2]) -> Result<T> {
        match self.text()? {
            text if text == a => Ok(first),
            text if text == b => Ok(second),
            _ => Err(self.error(format_args!("use {a:?} or {b:?}"))),
        }
    }

    /// A whole number in `least..=most`.
    pub fn integer(&self, least: u64, most: u64) -> Result<u64> {
        let found = match &self.node.value {
            Value::Int(i) => u64::try_from(*i).ok(),
            _ => None,
        };
        let in_range = found.filter(|i| (least..=most).contains(i));
        in_range.ok_or_else(|| self.wrong(&format!("a whole number from {least} to {most}")))
    }

    pub fn boolean(&self) -> Result<bool> {
        match &self.node.value {
            Value::Bool(b) => Ok(*b),
            _ => Err(self.wrong("true or false")),
        }
    }

    pub fn text(&self) -> Result<&'a str> {
        match &self.node.value {
            Value::Text(t) => Ok(t),
            _ => Err(self.wrong("a text in quotes")),
        }
    }

    /// A file name; relative ones start from the scene file's folder.
    pub fn path(&self) -> Result<PathBuf> {
        match self.text()? {
            "" => Err(self.error("the file name is empty; name a file")),
            text if text.contains('\0') => Err(self.error("a file name cannot hold a NUL character")),
            text => {
                self.source.names_files.set(true);
                Ok(self.source.dir.join(text))
            }
        }
    }

    /// Three finite numbers.
    pub fn vec3(&self) -> Result<DVec3> {
        Ok(DVec3::from_array(self.numbers("three numbers, as [x, y, z]")?))
    }

    /// Exactly `N` finite numbers.
    pub fn numbers<const N: usize>(&self, expected: &str) -> Result<[f64; N]> {
        let mut numbers = [0.0; N];
        for (number, item) in numbers.iter_mut().zip(self.array::<N>(expected)?) {
            *number = item.number()?;
        }
        Ok(numbers)
    }

    /// A matrix of 3 or 4 rows of four finite numbers; the fourth row must be 0, 0, 0, 1.
    pub fn affine(&self) -> Result<DAffine3> {
        let expected = "a matrix of 3 or 4 rows, as [[1, 0, 0, x], [0, 1, 0, y], [0, 0, 1, z], [0, 0, 0, 1]]";
        let rows: Vec<Field> = self.items(expected)?.collect();
        let [a, b, c, last @ ..] = rows.as_slice() else { return Err(self.wrong(expected)) };
        let row = |field: &Field| field.numbers::<4>("a row of four numbers");
        match last {
            [] => {}
            [last] if row(last)? == [0.0, 0.0, 0.0, 1.0] => {}
            [last] => {
                return Err(last.error("the last row must be [0, 0, 0, 1]; the translation is the last column"));
            }
            _ => return Err(self.wrong(expected)),
        }
        let [a, b, c] = [row(a)?, row(b)?, row(c)?];
        let [x, y, z, translation] = [0, 1, 2, 3].map_each(|k| DVec3::new(a[k], b[k], c[k]));
        Ok(DAffine3 { matrix3: DMat3::from_cols(x, y, z), translation })
    }

    /// A linear RGB colour, each in [0, 1].
    pub fn color(&self) -> Result<[f32; 3]> {
        let rgb: [f64; 3] = self.numbers("a linear RGB colour, as [r, g, b]")?;
        if rgb.iter().any(|c| !(0.0..=1.0).contains(c)) {
            let [r, g, b] = rgb;
            return Err(self.error(format_args!("colours lie in [0, 1]; [{r}, {g}, {b}] does not")));
        }
        Ok(rgb.map_each(|c| c as f32))
    }

    /// The items of a list; `expected` says what the error asks for.
    pub fn items(&self, expected: &str) -> Result<impl ExactSizeIterator<Item = Field<'a>> + use<'a>> {
        let Value::List(items) = &self.node.value else { return Err(self.wrong(expected)) };
        let (source, key) = (self.source, self.key.clone());
        Ok(items.iter().enumerate().map(move |(index, node)| Field {
            source,
            key: format!("{key}.{index}"),
            place: node.place,
            node,
        }))
    }

    /// Exactly `N` items.
    pub fn array<const N: usize>(&self, expected: &str) -> Result<[Field<'a>; N]> {
        let items: Vec<_> = self.items(expected)?.collect();
        items.try_into().map_err(|_| self.wrong(expected))
    }

    /// A table; [`Table::allow`] must follow before its keys are trusted.
    pub fn table(&self) -> Result<Table<'a>> {
        match &self.node.value {
            Value::Table(entries) => Ok(Table { field: self.clone(), entries, read_elsewhere: &[] }),
            _ => Err(self.wrong("a table")),
        }
    }
}

impl<'a> Table<'a> {
    /// The same table, some of whose keys are read by others.
    pub fn with_keys_read_elsewhere(self, read_elsewhere: &'static [&'static str]) -> Table<'a> {
        Table { read_elsewhere, ..self }
    }

    /// Refuses any key that is not in `known`, naming the nearest that is.
    pub fn allow(&self, known: &[&str]) -> Result<()> {
        let is_known = |key: &str| known.contains(&key) || self.read_elsewhere.contains(&key);
        let Some(entry) = self.entries.iter().find(|e| !is_known(&e.key)) else { return Ok(()) };
        let key = quote(&entry.key);
        let place = if self.field.key.is_empty() { "here".into() } else { format!("in {}", self.field.key) };
        let known = [known, self.read_elsewhere].concat();
        let near = nearest(&entry.key, &known).map_or(String::new(), |near| format!("; nearest known key: {near:?}"));
        let message = format!("unknown key {key} {place}{near} (known: {})", known.join(", "));
        Err(error_at(self.field.source, entry.place, message))
    }

    pub fn has(&self, key: &str) -> bool {
        self.entries.iter().any(|e| e.key == key)
    }

    pub fn get(&self, key: &str) -> Option<Field<'a>> {
        let entry = self.entries.iter().find(|e| e.key == key)?;
        let dotted = if self.field.key.is_empty() { key.into() } else { format!("{}.{key}", self.field.key) };
        Some(Field { source: self.field.source, key: dotted, place: entry.node.place, node: &entry.node })
    }

    /// The load that reads the files named here.
    pub fn loading(&self) -> &'a Loading {
        self.field.loading()
    }

    /// All keys, in the file's order, and their values.
    pub fn fields(&self) -> impl Iterator<Item = (&'a str, Field<'a>)> + '_ {
        self.entries.iter().filter_map(|e| Some((e.key.as_str(), self.get(&e.key)?)))
    }

    /// The value of `key`, or an error that shows how to write it.
    pub fn need(&self, key: &str, example: &str) -> Result<Field<'a>> {
        self.get(key).ok_or_else(|| self.field.error(format_args!("{key} is missing; add e.g. {key} = {example}")))
    }

    /// The value of `key` by `read`, or `default` if it is absent.
    pub fn or<T>(&self, key: &str, default: T, read: impl FnOnce(&Field<'a>) -> Result<T>) -> Result<T> {
        self.get(key).map_or(Ok(default), |field| read(&field))
    }

    /// The value of `key` by `read`, or `None` if it is absent.
    pub fn optional<T>(&self, key: &str, read: impl FnOnce(&Field<'a>) -> Result<T>) -> Result<Option<T>> {
        self.get(key).map(|field| read(&field)).transpose()
    }

    pub fn error(&self, message: impl std::fmt::Display) -> Error {
        self.field.error(message)
    }
}

fn error_at(source: &Source, place: Place, message: impl std::fmt::Display) -> Error {
    let path = source.path.display();
    match place {
        Place::Line(line) => Error::input(format!("{path}:{line}: {message}")),
        Place::Set => Error::input(format!("{path}: --set: {message}")),
        Place::Argument => Error::input(message.to_string()),
    }
}

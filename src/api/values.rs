//! Values of keys as Rust values, where a scene file has text.

use crate::input::tree::{self, Entry, Node, Place};

/// The value of a key: a number, a text, true or false, a list or a [`Table`], each by [`From`].
///
/// Lists nest, and a list of unlike items is one of values: `vec![Value::from(1), Value::from("a")]`. A key that takes a whole number, such as
/// `pieces`, refuses a float, as in a scene file.
#[derive(Debug, Clone, PartialEq)]
pub struct Value(tree::Value);

/// Keys and their values, for a key that holds a table, such as `mirror` of a `reflection` camera, and for the items of a list of tables.
///
/// ```
/// use anamorph::Table;
///
/// let mirror = Table::new().key("shape", "sphere").key("center", [0.0, 1.0, 0.0]).key("radius", 0.5);
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Table {
    entries: Vec<Entry>,
}

impl Table {
    /// A table without keys.
    pub fn new() -> Table {
        Table::default()
    }

    /// Sets a key, and replaces its value if it has one. Names are checked when the camera is built.
    #[must_use]
    pub fn key(mut self, name: impl Into<String>, value: impl Into<Value>) -> Table {
        let (key, node) = (name.into(), value.into().node());
        match self.entries.iter_mut().find(|entry| entry.key == key) {
            Some(entry) => entry.node = node,
            None => self.entries.push(Entry { key, place: Place::Argument, node }),
        }
        self
    }
}

impl Value {
    /// The value as the reader of scene files takes it.
    pub(super) fn node(self) -> Node {
        Node { value: self.0, place: Place::Argument }
    }

    fn list(items: impl IntoIterator<Item = impl Into<Value>>) -> Value {
        Value(tree::Value::List(items.into_iter().map(|item| item.into().node()).collect()))
    }
}

impl From<Table> for Value {
    fn from(table: Table) -> Value {
        Value(tree::Value::Table(table.entries))
    }
}

/// Conversions from types that the standard library converts to the one that is stored.
macro_rules! from_plain {
    ($($plain:ty => $stored:ident),+) => {
        $(impl From<$plain> for Value {
            fn from(value: $plain) -> Value {
                Value(tree::Value::$stored(value.into()))
            }
        })+
    };
}

from_plain!(bool => Bool, i32 => Int, i64 => Int, u32 => Int, u64 => Int, f32 => Float, f64 => Float, &str => Text, String => Text);

impl From<usize> for Value {
    fn from(value: usize) -> Value {
        // i128 holds every usize
        Value(tree::Value::Int(value as i128))
    }
}

impl<T: Into<Value>> From<Vec<T>> for Value {
    fn from(items: Vec<T>) -> Value {
        Value::list(items)
    }
}

impl<T: Into<Value>, const N: usize> From<[T; N]> for Value {
    fn from(items: [T; N]) -> Value {
        Value::list(items)
    }
}

impl<T: Into<Value> + Clone> From<&[T]> for Value {
    fn from(items: &[T]) -> Value {
        Value::list(items.iter().cloned())
    }
}

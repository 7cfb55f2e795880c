//! Buffer views in a compressed form, by `EXT_meshopt_compression` or its successor `KHR_meshopt_compression`.

use super::source::part;
use crate::input::{Error, Limits, Result};
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::sync::Arc;

/// What a document has in compressed form alone.
#[derive(Debug, Default)]
pub(super) struct Meshopt {
    pub views: Vec<Compressed>,
    /// Buffers without bytes, in whose place the views are decoded.
    pub placeholders: BTreeSet<usize>,
}

/// A buffer view of `count` elements of `stride` bytes.
#[derive(Debug)]
#[cfg_attr(not(feature = "simplify"), expect(dead_code, reason = "the decoder reads all of it"))]
pub(super) struct Compressed {
    view: usize,
    buffer: usize,
    offset: usize,
    length: usize,
    stride: usize,
    count: usize,
    mode: String,
    filter: String,
}

impl Meshopt {
    /// Of a document, in which each compressed view becomes all of a buffer of its own, behind the others.
    ///
    /// # Errors
    /// [`Error::Input`] naming the view: a number of its compressed form is missing.
    pub(super) fn take(json: &mut Value) -> Result<Meshopt> {
        let mut found = Meshopt::default();
        let list = |json: &Value, key: &str| json.get(key).and_then(Value::as_array).cloned().unwrap_or_default();
        let (mut views, mut buffers) = (list(json, "bufferViews"), list(json, "buffers"));
        for (k, view) in views.iter_mut().enumerate() {
            let Some(form) = compressed_form(view) else { continue };
            let buffer = view.get("buffer").and_then(Value::as_u64).unwrap_or(0) as usize;
            // a buffer without a file, and marked by an extension, has no bytes; others have the same in a plain form
            let is_empty = |buffer: &Value| buffer.get("uri").is_none() && buffer.get("extensions").is_some();
            if !buffers.get(buffer).is_some_and(is_empty) {
                continue;
            }
            let compressed = Compressed::read(k, form)?;
            found.placeholders.insert(buffer);
            let length = compressed.decoded_length();
            view["buffer"] = buffers.len().into();
            view["byteOffset"] = 0.into();
            view["byteLength"] = length.into();
            buffers.push(json!({ "byteLength": length }));
            found.views.push(compressed);
        }
        if !found.views.is_empty() {
            json["bufferViews"] = views.into();
            json["buffers"] = buffers.into();
        }
        Ok(found)
    }
}

/// The extension's object of a view.
fn compressed_form(view: &Value) -> Option<&Value> {
    let extensions = view.get("extensions")?.as_object()?;
    extensions.iter().find(|(name, _)| name.ends_with("_meshopt_compression")).map(|(_, form)| form)
}

impl Compressed {
    fn read(view: usize, form: &Value) -> Result<Compressed> {
        let number = |key: &str, default: Option<usize>| {
            let found = form.get(key).map_or(default, |value| value.as_u64().and_then(|n| usize::try_from(n).ok()));
            found.ok_or_else(|| {
                Error::input(format!("buffer view {view}: its compressed form has no {key}; export it again"))
            })
        };
        let word = |key: &str| form.get(key).and_then(Value::as_str).unwrap_or_default().to_owned();
        let compressed = Compressed {
            view,
            buffer: number("buffer", None)?,
            offset: number("byteOffset", Some(0))?,
            length: number("byteLength", None)?,
            stride: number("byteStride", None)?,
            count: number("count", None)?,
            mode: word("mode"),
            filter: word("filter"),
        };
        match compressed.stride.checked_mul(compressed.count) {
            Some(bytes) if bytes <= u32::MAX as usize => Ok(compressed),
            _ => Err(compressed.wrong("is over 4 GiB; split the file")),
        }
    }

    /// Bytes; at most 4 GiB.
    fn decoded_length(&self) -> usize {
        self.stride * self.count
    }

    fn wrong(&self, what: &str) -> Error {
        Error::input(format!("buffer view {}: its compressed form {what}", self.view))
    }

    /// The bytes of the view.
    ///
    /// # Errors
    /// [`Error::Input`] naming the view: its bytes are damaged, or of a kind that the extension does not have; [`Error::Work`] if memory
    /// does not suffice.
    pub(super) fn decode(&self, buffers: &[Arc<Vec<u8>>], limits: Limits) -> Result<Vec<u8>> {
        let bytes = part(buffers, self.buffer, (self.offset, self.length));
        let bytes = bytes.ok_or_else(|| self.wrong("exceeds its buffer; export it again"))?;
        let what = format_args!("buffer view {}", self.view);
        limits.check_memory(3 * self.decoded_length() as u64, what, "split the file")?;
        self.decoded(bytes)
    }

    #[cfg(not(feature = "simplify"))]
    fn decoded(&self, _: &[u8]) -> Result<Vec<u8>> {
        Err(self.wrong("is not read by a library that was built without the feature simplify"))
    }

    #[cfg(feature = "simplify")]
    fn decoded(&self, bytes: &[u8]) -> Result<Vec<u8>> {
        let decoded = match (self.mode.as_str(), self.stride) {
            ("ATTRIBUTES", _) => vertices(bytes, self.count, self.stride),
            // the decoder takes whole triangles
            ("TRIANGLES", 2) if self.count.is_multiple_of(3) => {
                indices(meshopt::decode_index_buffer(bytes, self.count), u16::to_le_bytes)
            }
            ("TRIANGLES", 4) if self.count.is_multiple_of(3) => {
                indices(meshopt::decode_index_buffer(bytes, self.count), u32::to_le_bytes)
            }
            ("INDICES", 2) => indices(meshopt::decode_index_sequence(bytes, self.count), u16::to_le_bytes),
            ("INDICES", 4) => indices(meshopt::decode_index_sequence(bytes, self.count), u32::to_le_bytes),
            _ => None,
        };
        let decoded = decoded.ok_or_else(|| self.wrong("is damaged; export it again"))?;
        let filtered = match (self.filter.as_str(), self.stride) {
            ("" | "NONE", _) => Some(decoded),
            ("OCTAHEDRAL", 4) => {
                Some(filtered(&decoded, i8::from_le_bytes, i8::to_le_bytes, meshopt::decode_filter_oct))
            }
            ("OCTAHEDRAL", 8) => {
                Some(filtered(&decoded, i16::from_le_bytes, i16::to_le_bytes, meshopt::decode_filter_oct))
            }
            ("QUATERNION", 8) => {
                Some(filtered(&decoded, i16::from_le_bytes, i16::to_le_bytes, meshopt::decode_filter_quat))
            }
            ("COLOR", 4) => Some(filtered(&decoded, u8::from_le_bytes, u8::to_le_bytes, meshopt::decode_filter_color)),
            ("COLOR", 8) => {
                Some(filtered(&decoded, u16::from_le_bytes, u16::to_le_bytes, meshopt::decode_filter_color))
            }
            // each number by itself
            ("EXPONENTIAL", stride) if stride.is_multiple_of(4) => {
                Some(filtered::<_, 4, 1>(&decoded, u32::from_le_bytes, u32::to_le_bytes, meshopt::decode_filter_exp))
            }
            _ => None,
        };
        filtered.ok_or_else(|| self.wrong("has a filter or a stride that the extension does not have; export it again"))
    }
}

/// Elements of so many bytes.
#[cfg(feature = "simplify")]
fn vertices(bytes: &[u8], count: usize, stride: usize) -> Option<Vec<u8>> {
    macro_rules! of_words {
        ($($words:literal)*) => {
            match stride / 4 {
                $($words => {
                    let found = meshopt::decode_vertex_buffer::<[[u8; 4]; $words]>(bytes, count).ok()?;
                    Some(found.as_flattened().as_flattened().to_vec())
                })*
                _ => None,
            }
        };
    }
    if !stride.is_multiple_of(4) {
        return None;
    }
    of_words!(1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 22 23 24 25 26 27 28 29 30 31 32)
}

#[cfg(feature = "simplify")]
fn indices<T: Copy, const N: usize>(found: meshopt::Result<Vec<T>>, bytes: fn(T) -> [u8; N]) -> Option<Vec<u8>> {
    Some(found.ok()?.into_iter().flat_map(bytes).collect())
}

/// The bytes after a filter of elements of `N` numbers, each of `BYTES`.
#[cfg(feature = "simplify")]
fn filtered<T: Copy, const BYTES: usize, const N: usize>(
    bytes: &[u8],
    number: fn([u8; BYTES]) -> T,
    back: fn(T) -> [u8; BYTES],
    filter: fn(&mut [[T; N]]),
) -> Vec<u8> {
    let numbers: Vec<T> = bytes.as_chunks::<BYTES>().0.iter().map(|b| number(*b)).collect();
    let mut elements = numbers.as_chunks::<N>().0.to_vec();
    filter(&mut elements);
    elements.into_iter().flatten().flat_map(back).collect()
}

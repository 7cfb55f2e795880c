//! The parts of a glTF file: its checked JSON document and its buffers.

use std::borrow::Cow;
use std::collections::HashMap;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use gltf::json::validation::{Error as Wrong, Validate};
use gltf::json::{Path as JsonPath, Root};
use gltf::{Document, buffer};

use super::json::{self, Kept};
use super::meshopt::Meshopt;
use super::{Files, draco};
use crate::geometry::texture::{has_known_start, is_missing};
use crate::input::{Error, Limits, Loading, Prefix, Result};
use serde_json::Value as Json;

/// How to find the files that a glTF file names.
#[derive(Debug, Clone, Copy)]
pub(super) struct FileAccess<'a> {
    /// The folder of the glTF file.
    pub folder: &'a Path,
    pub files: Files,
    pub loading: &'a Loading,
}

/// What was read from a file, or the path where it does not exist.
pub(super) type Found<T> = std::result::Result<T, PathBuf>;

/// A document whose indices are valid, and its buffers, each at least as long as it says.
pub(super) struct Source {
    pub document: Document,
    /// What the document holds beyond the crate's types.
    pub kept: Kept,
    pub buffers: Vec<Arc<Vec<u8>>>,
    /// What is wrong with its materials, which not every reader uses.
    pub material_error: Option<Error>,
    pub limits: Limits,
}

impl Source {
    /// # Errors
    /// [`Error::Input`]: see [`super::load`].
    pub(super) fn parse(bytes: Cow<[u8]>, access: FileAccess) -> Result<Source> {
        let is_glb = bytes.starts_with(b"glTF");
        let (json, binary) = if is_glb { split_glb(&bytes)? } else { (0..bytes.len(), None) };
        let json = &bytes[json];
        let json = json.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(json);
        if json.is_empty() {
            return Err(Error::input("is empty; a glTF 2.0 file is needed"));
        }
        let mut json: Json = serde_json::from_slice(json).map_err(wrong)?;
        let mut binary = binary.map(|chunk| cut_out(bytes, chunk));
        json::prepare(&mut json);
        let meshopt = Meshopt::take(&mut json)?;
        let draco = draco::take(&mut json)?;
        let kept = Kept::of(&json);
        let root: Root = serde_json::from_value(json).map_err(wrong)?;
        let material_error = check_root(&root)?;
        let document = Document::from_json_without_validation(root);
        let (mut buffers, mut known) = (Vec::new(), HashMap::new());
        let decoded = meshopt.views.len() + draco.iter().map(|primitive| primitive.buffers()).sum::<usize>();
        for buffer in document.buffers().take(document.buffers().len() - decoded) {
            if meshopt.placeholders.contains(&buffer.index()) {
                buffers.push(Arc::default());
                continue;
            }
            let bytes = read_buffer(&buffer, access, &mut binary, &mut known)
                .map_err(|message| Error::input(format!("buffer {}: {message}", buffer.index())))?;
            buffers.push(bytes);
        }
        drop(known);
        let limits = access.loading.limits();
        for view in &meshopt.views {
            buffers.push(Arc::new(view.decode(&buffers, limits)?));
        }
        for primitive in &draco {
            let decoded = primitive.decode(&buffers, limits)?;
            buffers.extend(decoded.into_iter().map(Arc::new));
        }
        Ok(Source { document, kept, buffers, material_error, limits })
    }

    /// The bytes of an image's file.
    pub(super) fn read_image(
        &self,
        image: &gltf::Image,
        access: FileAccess,
    ) -> std::result::Result<Found<Cow<'_, [u8]>>, String> {
        let json = &self.document.as_json().images[image.index()];
        let view = json.buffer_view.and_then(|k| self.document.views().nth(k.value()));
        match (view, &json.uri) {
            (None, Some(uri)) => {
                let found = read_uri(uri, access, |start| Ok(has_known_start(start.bytes())))?;
                Ok(found.map(Cow::Owned))
            }
            (None, None) => Err("has neither a uri nor a bufferView; export it again".into()),
            (Some(view), _) => {
                let bytes = part(&self.buffers, view.buffer().index(), (view.offset(), view.length()));
                Ok(Ok(bytes.ok_or("exceeds its buffer; export it again")?.into()))
            }
        }
    }
}

/// So many bytes of a buffer from an offset on; `None` if it does not have them.
pub(super) fn part(buffers: &[Arc<Vec<u8>>], buffer: usize, (offset, length): (usize, usize)) -> Option<&[u8]> {
    buffers.get(buffer)?.get(offset..offset.checked_add(length)?)
}

fn wrong(e: serde_json::Error) -> Error {
    Error::input(format!("is not glTF 2.0: {e}"))
}

/// Refuses a file by its first bytes and its length: a GLB that is cut short, or text that is no JSON.
///
/// # Errors
/// [`Error::Input`] as [`Source::parse`] gives it.
pub(super) fn check_start(bytes: &[u8], length: u64) -> Result<()> {
    let json = match bytes {
        [b'g', b'l', b'T', b'F', ..] => {
            glb_length(bytes, length)?;
            let size = word(bytes, GLB_HEADER)?;
            let chunk = bytes.get(GLB_HEADER + 8..).filter(|_| bytes[GLB_HEADER + 4..].starts_with(b"JSON"));
            chunk.map(|chunk| &chunk[..chunk.len().min(size as usize)])
        }
        _ => Some(bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes)),
    };
    // bytes that end too early may go on in the file
    match json.filter(|json| !json.is_empty()).map(serde_json::from_slice::<serde::de::IgnoredAny>) {
        Some(Err(e)) if !e.is_eof() => Err(wrong(e)),
        _ => Ok(()),
    }
}

/// The extension by which animations move other things than nodes.
pub(super) const POINTERS: &str = "KHR_animation_pointer";

/// Bytes of a GLB before its chunks.
const GLB_HEADER: usize = 12;

fn truncated() -> Error {
    Error::input("GLB is cut short; copy or export it again")
}

fn word(bytes: &[u8], at: usize) -> Result<u32> {
    let word = bytes.get(at..at + 4).and_then(|b| b.try_into().ok()).ok_or_else(truncated)?;
    Ok(u32::from_le_bytes(word))
}

/// The length in the header of a GLB, whose file is at least as long.
fn glb_length(bytes: &[u8], in_file: u64) -> Result<usize> {
    let (version, length) = (word(bytes, 4)?, word(bytes, 8)?);
    if version != 2 {
        return Err(Error::input(format!("GLB version {version}, only 2 can be read; export it as glTF 2.0")));
    }
    if u64::from(length) > in_file {
        return Err(truncated());
    }
    Ok(length as usize)
}

/// A part of a file's bytes; a file that is not kept is not copied.
fn cut_out(bytes: Cow<[u8]>, part: Range<usize>) -> Vec<u8> {
    match bytes {
        Cow::Borrowed(bytes) => bytes[part].to_vec(),
        Cow::Owned(mut bytes) => {
            bytes.truncate(part.end);
            bytes.drain(..part.start);
            bytes
        }
    }
}

/// The places of the JSON and BIN chunks of a GLB file; chunks of other types are skipped.
fn split_glb(bytes: &[u8]) -> Result<(Range<usize>, Option<Range<usize>>)> {
    let length = glb_length(bytes, bytes.len() as u64)?;
    let (mut json, mut binary) = (None, None);
    let mut at = GLB_HEADER;
    while at < length {
        let (size, kind) = (word(bytes, at)? as usize, word(bytes, at + 4)?.to_le_bytes());
        let chunk = at + 8..at + 8 + size;
        bytes.get(chunk.clone()).ok_or_else(truncated)?;
        match &kind {
            b"JSON" if json.is_none() => json = Some(chunk),
            b"BIN\0" if binary.is_none() => binary = Some(chunk),
            _ => {}
        }
        // Some programs do not pad a chunk, others leave the padding out of its size.
        let unpadded = at + 8 + size;
        at += 8 + size.next_multiple_of(4);
        if bytes.get(unpadded + 4..unpadded + 8).is_some_and(|kind| matches!(kind, b"JSON" | b"BIN\0")) {
            at = unpadded;
        }
    }
    let json = json.ok_or_else(|| Error::input("GLB has no JSON chunk; export it again"))?;
    Ok((json, binary))
}

/// Version, required extensions, and every index and enumeration of the parts that are read; what is wrong with textures alone.
fn check_root(root: &Root) -> Result<Option<Error>> {
    let version = &root.asset.version;
    if !version.starts_with("2.") {
        return Err(Error::input(format!("glTF version {version:?}, only 2.x can be read; export it as glTF 2.0")));
    }
    if let Some(extension) = root.extensions_required.iter().find(|name| !keeps_triangles(name)) {
        return Err(Error::input(format!("requires {extension}, which is not supported; export it without")));
    }
    check_attributes(root)?;
    let (mut first, mut material) = (None, None);
    root.validate(root, JsonPath::new, &mut |path, wrong| {
        let path = path().0;
        let is_in = |parts: &[&str]| parts.iter().any(|part| path.starts_with(part));
        // the crate looks up a material's textures at once
        let is_read = is_in(&["scene", "nodes", "meshes", "accessors", "bufferViews", "buffers"])
            || (wrong == Wrong::IndexOutOfBounds && is_in(&["materials"]));
        if !is_read && material.is_none() && is_in(&["materials", "textures", "images", "samplers"]) {
            material = Some((path, wrong));
            return;
        }
        // The required minimum and maximum of positions are often left out, and are not needed; an accessor without a buffer view holds zeros.
        let is_needless = [".min", ".max", ".bufferView"].iter().any(|end| path.ends_with(end));
        if is_read && !(wrong == Wrong::Missing && is_needless) && first.is_none() {
            first = Some((path, wrong));
        }
    });
    let error = |(path, wrong)| Error::input(format!("{path}: {}; export it again", reason(wrong)));
    match first {
        Some(first) => Err(error(first)),
        None => Ok(material.map(error)),
    }
}

/// The crate's own validation indexes the position accessors before it checks them.
fn check_attributes(root: &Root) -> Result<()> {
    for (mesh, primitives) in root.meshes.iter().map(|mesh| &mesh.primitives).enumerate() {
        for (primitive, attributes) in primitives.iter().map(|primitive| &primitive.attributes).enumerate() {
            if let Some(index) = attributes.values().find(|index| index.value() >= root.accessors.len()) {
                let (index, count) = (index.value(), root.accessors.len());
                return Err(Error::input(format!(
                    "mesh {mesh}, primitive {primitive}: accessor {index} of {count}; export it again"
                )));
            }
        }
    }
    Ok(())
}

fn reason(wrong: Wrong) -> &'static str {
    match wrong {
        Wrong::IndexOutOfBounds => "index out of range",
        Wrong::Invalid => "not a valid value",
        Wrong::Missing => "missing",
        Wrong::Oversize => "too large",
        Wrong::Unsupported => "not supported",
    }
}

/// Whether a file that requires the extension can be read without it: it is about materials, or it is handled.
fn keeps_triangles(extension: &str) -> bool {
    const PREFIXES: [&str; 6] =
        ["KHR_materials_", "KHR_texture_", "EXT_texture_", "KHR_lights_", "EXT_lights_", "KHR_xmp"];
    const NAMES: [&str; 2] = ["MSFT_texture_dds", "MSFT_packing_normalRoughnessMetallic"];
    NAMES.contains(&extension)
        || json::is_read(extension)
        || PREFIXES.iter().any(|prefix| extension.starts_with(prefix))
}

/// The buffer's bytes. A file is read once: `known` holds the bytes by URI.
fn read_buffer<'a>(
    buffer: &gltf::Buffer<'a>,
    access: FileAccess,
    binary: &mut Option<Vec<u8>>,
    known: &mut HashMap<&'a str, Arc<Vec<u8>>>,
) -> std::result::Result<Arc<Vec<u8>>, String> {
    let bytes = match buffer.source() {
        buffer::Source::Bin => binary.take().ok_or("has no uri and no BIN chunk; export it again")?.into(),
        buffer::Source::Uri(uri) => match known.get(uri) {
            Some(bytes) => bytes.clone(),
            None => match read_uri(uri, access, |start| check_length(start.length(), buffer).map(|()| true))? {
                Ok(bytes) => known.entry(uri).or_insert(bytes.into()).clone(),
                Err(file) => return Err(format!("{} cannot be read: the file does not exist", file.display())),
            },
        },
    };
    check_length(bytes.len() as u64, buffer)?;
    Ok(bytes)
}

fn check_length(has: u64, buffer: &gltf::Buffer) -> std::result::Result<(), String> {
    let says = buffer.length();
    if has < says as u64 { Err(format!("has {has} of its {says} bytes; copy or export it again")) } else { Ok(()) }
}

/// The bytes of a `data:` URI or of a file. `needs_rest` refuses a file by its first bytes and its length, or tells whether more than these are
/// needed.
fn read_uri(
    uri: &str,
    access: FileAccess,
    needs_rest: impl FnOnce(&Prefix) -> std::result::Result<bool, String>,
) -> std::result::Result<Found<Vec<u8>>, String> {
    if let Some(data) = uri.strip_prefix("data:") {
        return decode_data(data).map(Ok);
    }
    if uri.contains("://") {
        return Err("lies elsewhere on the net; put it beside the file".into());
    }
    let name = decode_percent(uri);
    let file = access.folder.join(&name);
    if access.files == Files::Below && !crate::input::files::is_below(&name, access.folder) {
        return Err(format!(
            "{name:?} is outside of the glTF's folder; move it there, or set outside_files = true in the [[mesh]]"
        ));
    }
    let unreadable = |e| format!("{} cannot be read: {e}", file.display());
    let start = match access.loading.prefix(&file) {
        Ok(start) => start,
        Err(e) if is_missing(&e) => return Ok(Err(file)),
        Err(e) => return Err(unreadable(e)),
    };
    let is_needed = needs_rest(&start)?;
    start.read_if(is_needed).map(Ok).map_err(unreadable)
}

/// The bytes of a `data:` URI, from behind the colon.
fn decode_data(data: &str) -> std::result::Result<Vec<u8>, String> {
    let Some((kind, payload)) = data.split_once(',') else {
        return Err("data URI has no comma; export it again".into());
    };
    if !kind.ends_with(";base64") {
        return Err("data URI is not base64; export it again".into());
    }
    decode_base64(payload.as_bytes()).ok_or_else(|| "data URI has wrong base64; export it again".into())
}

/// RFC 4648 base64, with or without padding at the end.
fn decode_base64(text: &[u8]) -> Option<Vec<u8>> {
    let end = text.iter().rposition(|&b| b != b'=').map_or(0, |last| last + 1);
    let (digits, padding) = text.split_at(end);
    if padding.len() > 2 || digits.len() % 4 == 1 {
        return None;
    }
    let mut bytes = Vec::with_capacity(digits.len() / 4 * 3 + 2);
    let (mut bits, mut bit_count) = (0u32, 0);
    for &digit in digits {
        let value = match digit {
            b'A'..=b'Z' => digit - b'A',
            b'a'..=b'z' => digit - b'a' + 26,
            b'0'..=b'9' => digit - b'0' + 52,
            b'+' | b'-' => 62,
            b'/' | b'_' => 63,
            _ => return None,
        };
        bits = bits << 6 | u32::from(value);
        bit_count += 6;
        if bit_count >= 8 {
            bit_count -= 8;
            bytes.push((bits >> bit_count) as u8);
            bits &= (1 << bit_count) - 1;
        }
    }
    Some(bytes)
}

/// A file name from a relative URI: `%20` is a blank. Other text stays as it is.
fn decode_percent(uri: &str) -> String {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let [first, after @ ..] = rest {
        let digits = after.get(..2).filter(|d| *first == b'%' && d.iter().all(u8::is_ascii_hexdigit));
        let code = digits.and_then(|d| u8::from_str_radix(std::str::from_utf8(d).ok()?, 16).ok());
        bytes.push(code.unwrap_or(*first));
        rest = if code.is_some() { &after[2..] } else { after };
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_and_percent_signs() {
        assert_eq!(decode_base64(b"aGVsbG8=").as_deref(), Some(&b"hello"[..]));
        assert_eq!(decode_base64(b"aGVsbG8").as_deref(), Some(&b"hello"[..]));
        assert_eq!(decode_base64(b"+/-_").as_deref(), Some(&[0xfb, 0xff, 0xbf][..]));
        for wrong in [&b"a"[..], b"aGVs bG8=", b"a===", b"aGV\n"] {
            assert_eq!(decode_base64(wrong), None);
        }
        assert_eq!(decode_percent("my%20box%2e%zz%"), "my box.%zz%");
    }
}

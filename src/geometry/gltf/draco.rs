//! Primitives whose vertices are there in a compressed form alone: the extension `KHR_draco_mesh_compression`.

use super::source::part;
use crate::input::{Error, Limits, Result};
use serde_json::{Value, json};
use std::sync::Arc;

pub(super) const DRACO: &str = "KHR_draco_mesh_compression";

/// A primitive's compressed form, and the buffers that its numbers are decoded to.
#[derive(Debug)]
pub(super) struct Compressed {
    mesh: usize,
    primitive: usize,
    /// Buffer, offset and length of the compressed bytes.
    bytes: [usize; 3],
    attributes: Vec<Attribute>,
    /// How many indices are decoded, if they are; behind all attributes.
    indices: Option<usize>,
}

#[derive(Debug)]
#[cfg_attr(not(feature = "draco"), expect(dead_code, reason = "the decoder reads all of it"))]
struct Attribute {
    /// Its number within the compressed form.
    id: u32,
    components: usize,
    count: usize,
    /// Integers that stand for fractions are divided by this.
    full: f32,
}

/// Takes the compressed forms out of a document: each of their accessors becomes f32 numbers, or u32 indices, in a buffer of its own behind
/// the others, in the order of [`Compressed::decode`].
///
/// # Errors
/// [`Error::Input`] naming the primitive: a part of its compressed form is missing, or is of another kind than the extension's.
pub(super) fn take(json: &mut Value) -> Result<Vec<Compressed>> {
    let mut found = Vec::new();
    for mesh in 0..length(json, "meshes") {
        for primitive in 0..json["meshes"][mesh]["primitives"].as_array().map_or(0, Vec::len) {
            let has_no_other_form = |json: &Value| {
                let own = &json["meshes"][mesh]["primitives"][primitive];
                let positions = own["attributes"]["POSITION"].as_u64().map(|k| &json["accessors"][k as usize]);
                own["extensions"].get(DRACO).is_some()
                    && positions.is_some_and(|p| p.is_object() && p.get("bufferView").is_none())
            };
            if has_no_other_form(json) {
                let taken = Compressed::take(json, mesh, primitive);
                found.push(
                    taken.ok_or_else(|| wrong([mesh, primitive], "is not as the extension has it; export it again"))?,
                );
            }
        }
    }
    Ok(found)
}

fn length(json: &Value, list: &str) -> usize {
    json[list].as_array().map_or(0, Vec::len)
}

fn wrong([mesh, primitive]: [usize; 2], what: &str) -> Error {
    Error::input(format!("mesh {mesh}, primitive {primitive}: its form by {DRACO} {what}"))
}

fn number(value: &Value) -> Option<usize> {
    usize::try_from(value.as_u64()?).ok()
}

impl Compressed {
    fn take(json: &mut Value, mesh: usize, primitive: usize) -> Option<Compressed> {
        let own = json["meshes"][mesh]["primitives"][primitive].clone();
        let form = &own["extensions"][DRACO];
        let view = json["bufferViews"].get(number(&form["bufferView"])?)?;
        let offset = view.get("byteOffset").map_or(Some(0), number)?;
        let bytes = [number(&view["buffer"])?, offset, number(&view["byteLength"])?];
        let mut attributes = Vec::new();
        for (name, id) in form["attributes"].as_object()? {
            let accessor = json["accessors"].get_mut(number(&own["attributes"][name])?)?;
            let components = match accessor["type"].as_str()? {
                "SCALAR" => 1,
                "VEC2" => 2,
                "VEC3" => 3,
                "VEC4" => 4,
                _ => return None,
            };
            let full =
                match (accessor.get("normalized") == Some(&Value::Bool(true)), accessor["componentType"].as_u64()?) {
                    (true, 5120) => f32::from(i8::MAX),
                    (true, 5121) => f32::from(u8::MAX),
                    (true, 5122) => f32::from(i16::MAX),
                    (true, 5123) => f32::from(u16::MAX),
                    _ => 1.0,
                };
            let count = number(&accessor["count"])?;
            (accessor["componentType"], accessor["normalized"]) = (5126.into(), false.into());
            attributes.push(Attribute { id: u32::try_from(number(id)?).ok()?, components, count, full });
            let [of, length] = [number(&own["attributes"][name])?, count.checked_mul(4 * components)?];
            add_buffer(json, of, length)?;
        }
        let indices = match own.get("indices") {
            None => None,
            Some(of) => {
                let accessor = json["accessors"].get_mut(number(of)?)?;
                let count = number(&accessor["count"])?;
                accessor["componentType"] = 5125.into();
                add_buffer(json, number(of)?, count.checked_mul(4)?)?;
                Some(count)
            }
        };
        Some(Compressed { mesh, primitive, bytes, attributes, indices })
    }

    /// How many buffers [`Compressed::decode`] makes.
    pub(super) fn buffers(&self) -> usize {
        self.attributes.len() + usize::from(self.indices.is_some())
    }

    /// The bytes of the accessors' buffers.
    ///
    /// # Errors
    /// [`Error::Input`] naming the primitive: its bytes are damaged, or hold other numbers of vertices than the accessors;
    /// [`Error::Work`] if memory does not suffice.
    pub(super) fn decode(&self, buffers: &[Arc<Vec<u8>>], limits: Limits) -> Result<Vec<Vec<u8>>> {
        let wrong = |what: &str| wrong([self.mesh, self.primitive], what);
        let [buffer, offset, length] = self.bytes;
        let bytes = part(buffers, buffer, (offset, length));
        let bytes = bytes.ok_or_else(|| wrong("exceeds its buffer; export it again"))?;
        let numbers = self.attributes.iter().map(|a| (a.components * a.count) as u64).sum::<u64>();
        let size = 4 * (numbers + self.indices.unwrap_or(0) as u64);
        // what is decoded, and what it is decoded to
        let what = format_args!("mesh {}, primitive {}", self.mesh, self.primitive);
        limits.check_memory(3 * size, what, "split the file")?;
        self.decoded(bytes, size)
    }

    #[cfg(not(feature = "draco"))]
    fn decoded(&self, _: &[u8], _: u64) -> Result<Vec<Vec<u8>>> {
        Err(wrong([self.mesh, self.primitive], "is not read by a library that was built without the feature draco"))
    }

    /// `size`: the bytes that the accessors promise.
    #[cfg(feature = "draco")]
    fn decoded(&self, bytes: &[u8], size: u64) -> Result<Vec<Vec<u8>>> {
        use draco_core::decode_limits::DecodeLimits;
        use draco_core::decoder_buffer::DecoderBuffer;
        let wrong = |what: &str| wrong([self.mesh, self.primitive], what);
        let points = self.attributes.first().map_or(0, |a| a.count);
        // attributes that no accessor names are decoded, too
        let limits = DecodeLimits::default()
            .with_max_points(points as u64)
            .with_max_faces(self.indices.map_or(u64::MAX, |count| count as u64 / 3))
            .with_max_decoded_bytes(size.saturating_mul(4));
        let mut mesh = draco_core::mesh::Mesh::new();
        let mut input = DecoderBuffer::new(bytes).with_limits(limits);
        let decoded = draco_core::mesh_decoder::MeshDecoder::new().decode(&mut input, &mut mesh);
        decoded
            .map_err(|_| wrong("is damaged, or has other numbers of vertices than its accessors; export it again"))?;
        let has_all = self.attributes.iter().all(|a| a.count == mesh.num_points());
        if !has_all || self.indices.is_some_and(|count| count != 3 * mesh.num_faces()) {
            return Err(wrong("has other numbers of vertices or indices than its accessors; export it again"));
        }
        let of_attribute = |a: &Attribute| {
            let found = mesh.attribute_by_unique_id(a.id);
            let found = found.ok_or_else(|| wrong("lacks an attribute that it names; export it again"))?;
            let numbers = found.read_f32s(a.count, a.components);
            // the least integer stands for -1, too
            let value = |v: f32| if a.full > 1.0 { (v / a.full).max(-1.0) } else { v };
            Ok(numbers.into_iter().flat_map(|v| value(v).to_le_bytes()).collect())
        };
        let mut all = self.attributes.iter().map(of_attribute).collect::<Result<Vec<Vec<u8>>>>()?;
        if self.indices.is_some() {
            all.push(mesh.faces().iter().flatten().flat_map(|point| point.0.to_le_bytes()).collect());
        }
        Ok(all)
    }
}

/// Gives an accessor a buffer of its own.
fn add_buffer(json: &mut Value, accessor: usize, length: usize) -> Option<()> {
    let [buffer, view] = ["buffers", "bufferViews"].map(|list| self::length(json, list));
    json["buffers"].as_array_mut()?.push(json!({ "byteLength": length }));
    json["bufferViews"].as_array_mut()?.push(json!({ "buffer": buffer, "byteLength": length }));
    let accessor = json["accessors"].get_mut(accessor)?.as_object_mut()?;
    accessor.insert("bufferView".into(), view.into());
    accessor.remove("byteOffset");
    Some(())
}

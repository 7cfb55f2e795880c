//! Typed reading of buffers: every range is checked before it is read.

use crate::arrays::MapEach;
use glam::{DMat4, DQuat, DVec2, DVec3, DVec4};
use gltf::Accessor;
use gltf::accessor::sparse::{IndexType, Sparse};
use gltf::accessor::{DataType, Dimensions};
use gltf::buffer::View;

use super::MAX_TRIANGLES;
use super::json::Instances;
use super::source::{Source, part};
use crate::input::{Error, Result};
use crate::parallel;

impl Source {
    /// The elements of an accessor of this shape, each after `of`. `what` names them in the error.
    fn read_shaped<T: Send>(
        &self,
        accessor: &Accessor,
        (shape, what): (Dimensions, &str),
        of: impl Fn(&[f64]) -> T + Sync,
    ) -> Result<Vec<T>> {
        if accessor.dimensions() != shape {
            return Err(at(accessor, format!("must hold {what}; export it again")));
        }
        self.read_each(accessor, of)
    }

    /// The accessor's vectors of three.
    ///
    /// # Errors
    /// [`Error::Input`] naming the accessor: another shape, or out of its buffer's range.
    pub(super) fn read_vectors(&self, accessor: &Accessor) -> Result<Vec<DVec3>> {
        self.read_shaped(accessor, (Dimensions::Vec3, "vectors of 3"), DVec3::from_slice)
    }

    /// The accessor's scalars.
    ///
    /// # Errors
    /// As [`Source::read_vectors`].
    pub(super) fn read_scalars(&self, accessor: &Accessor) -> Result<Vec<f64>> {
        self.read_shaped(accessor, (Dimensions::Scalar, "single numbers"), |v| v[0])
    }

    /// The accessor's vectors of four.
    ///
    /// # Errors
    /// As [`Source::read_vectors`].
    pub(super) fn read_fours(&self, accessor: &Accessor) -> Result<Vec<DVec4>> {
        self.read_shaped(accessor, (Dimensions::Vec4, "vectors of 4"), DVec4::from_slice)
    }

    /// The accessor's matrices of four by four.
    ///
    /// # Errors
    /// As [`Source::read_vectors`].
    pub(super) fn read_matrices(&self, accessor: &Accessor) -> Result<Vec<DMat4>> {
        self.read_shaped(accessor, (Dimensions::Mat4, "matrices of 4 x 4"), DMat4::from_cols_slice)
    }

    /// The accessor's vectors of two.
    ///
    /// # Errors
    /// As [`Source::read_vectors`].
    pub(super) fn read_pairs(&self, accessor: &Accessor) -> Result<Vec<DVec2>> {
        self.read_shaped(accessor, (Dimensions::Vec2, "vectors of 2"), DVec2::from_slice)
    }

    /// The accessor's colours with their opacity, which is 1 where they have none.
    ///
    /// # Errors
    /// As [`Source::read_vectors`].
    pub(super) fn read_colors(&self, accessor: &Accessor) -> Result<Vec<[f32; 4]>> {
        if !matches!(accessor.dimensions(), Dimensions::Vec3 | Dimensions::Vec4) {
            return Err(at(accessor, "must hold vectors of 3 or 4 as colours; export it again".into()));
        }
        let color = |v: &[f64]| [v[0], v[1], v[2], v.get(3).copied().unwrap_or(1.0)].map_each(|c| c as f32);
        self.read_each(accessor, color)
    }

    /// The transforms of `EXT_mesh_gpu_instancing`, each of translation, rotation and scale where there is one.
    ///
    /// # Errors
    /// [`Error::Input`]: an accessor does not exist, has another shape, or has another number of values than the others.
    pub(super) fn read_instances(&self, instances: &Instances) -> Result<Vec<DMat4>> {
        let find = |index: usize| {
            let accessor = self.document.accessors().nth(index);
            accessor.ok_or_else(|| Error::input(format!("its instances have accessor {index}, which does not exist")))
        };
        let vectors = |index: Option<usize>| index.map(|k| self.read_vectors(&find(k)?)).transpose();
        let (translations, scales) = (vectors(instances.translation)?, vectors(instances.scale)?);
        let rotations = instances.rotation.map(|k| self.read_fours(&find(k)?)).transpose()?;
        let counts =
            [translations.as_ref().map(Vec::len), scales.as_ref().map(Vec::len), rotations.as_ref().map(Vec::len)];
        let count = counts.iter().flatten().copied().max().unwrap_or(0);
        if counts.iter().flatten().any(|other| *other != count) || count > MAX_TRIANGLES {
            return Err(Error::input(format!(
                "its {count} instances have lists of different lengths, or are over 2^28"
            )));
        }
        let of = |k: usize| {
            let rotation = rotations.as_ref().map_or(DQuat::IDENTITY, |r| DQuat::from_vec4(r[k]).normalize());
            DMat4::from_scale_rotation_translation(
                scales.as_ref().map_or(DVec3::ONE, |s| s[k]),
                rotation,
                translations.as_ref().map_or(DVec3::ZERO, |t| t[k]),
            )
        };
        Ok((0..count).map(of).collect())
    }

    /// The accessor's indices, each below `limit`.
    ///
    /// # Errors
    /// [`Error::Input`] naming the accessor: another shape, out of its buffer's range, or an index that is too
    /// large.
    pub(super) fn read_indices(&self, accessor: &Accessor, limit: u32) -> Result<Vec<u32>> {
        let is_index = matches!(accessor.data_type(), DataType::U8 | DataType::U16 | DataType::U32);
        if accessor.dimensions() != Dimensions::Scalar || !is_index || accessor.normalized() {
            return Err(at(accessor, "must hold unsigned integers as indices; export it again".into()));
        }
        // exact: they were u8, u16 or u32
        let indices = self.read_each(accessor, |v| v[0] as u32)?;
        match indices.iter().find(|&&index| index >= limit) {
            Some(index) => Err(at(accessor, format!("index {index} of {limit} vertices; export it again"))),
            None => Ok(indices),
        }
    }

    /// Calls `of` with the components of each element, as [`Source::read`] has them, on all cores.
    fn read_each<T: Send>(&self, accessor: &Accessor, of: impl Fn(&[f64]) -> T + Sync) -> Result<Vec<T>> {
        let (kind, components) = (accessor.data_type(), accessor.dimensions().multiplicity());
        let Some(view) = accessor.view().filter(|_| accessor.sparse().is_none()) else {
            return Ok(self.read(accessor)?.chunks_exact(components).map(of).collect());
        };
        let run = Run { offset: accessor.offset(), count: accessor.count(), bytes: accessor.size() };
        let elements = self.elements(&view, &run).map_err(|message| at(accessor, message))?;
        let is_normalized = accessor.normalized();
        Ok(parallel::map(0..run.count, |k| {
            // a matrix of 4 x 4 has most
            let mut values = [0.0; 16];
            for (value, bytes) in values.iter_mut().zip(elements.get(k).chunks_exact(kind.size())) {
                let component = component(kind, bytes);
                *value = if is_normalized { normalised(kind, component) } else { component };
            }
            of(&values[..components])
        }))
    }

    /// All components of all elements as f64, which holds each component type exactly; normalised ones divided.
    ///
    /// # Errors
    /// [`Error::Input`] naming the accessor: out of its buffer's range.
    pub(super) fn read(&self, accessor: &Accessor) -> Result<Vec<f64>> {
        let wrong = |message: String| at(accessor, message);
        let kind = accessor.data_type();
        let components = accessor.dimensions().multiplicity();
        let count = accessor.count();
        let mut values = match accessor.view() {
            Some(view) => {
                let run = Run { offset: accessor.offset(), count, bytes: accessor.size() };
                let elements = self.elements(&view, &run).map_err(wrong)?;
                elements.all().flat_map(|e| e.chunks_exact(kind.size()).map(|c| component(kind, c))).collect()
            }
            None if count > 3 * MAX_TRIANGLES => {
                return Err(wrong(format!("{count} elements are too many; split the file")));
            }
            // zeros (glTF specification 5.1.1)
            None => {
                let bytes = 8 * count as u64 * components as u64;
                let what = format_args!("accessor {}: {count} elements", accessor.index());
                self.limits.check_memory(bytes, what, "split the file")?;
                vec![0.0; count * components]
            }
        };
        if let Some(sparse) = accessor.sparse() {
            self.substitute(&sparse, accessor, &mut values).map_err(wrong)?;
        }
        if accessor.normalized() {
            values.iter_mut().for_each(|value| *value = normalised(kind, *value));
        }
        Ok(values)
    }

    /// Writes a sparse accessor's values over the dense ones.
    fn substitute(&self, sparse: &Sparse, accessor: &Accessor, values: &mut [f64]) -> std::result::Result<(), String> {
        let (indices, kind, count) = (sparse.indices(), accessor.data_type(), sparse.count());
        let index_kind = match indices.index_type() {
            IndexType::U8 => DataType::U8,
            IndexType::U16 => DataType::U16,
            IndexType::U32 => DataType::U32,
        };
        let run = Run { offset: indices.offset(), count, bytes: index_kind.size() };
        let places = self.elements(&indices.view(), &run)?.all().map(|bytes| component(index_kind, bytes) as usize);
        let run = Run { offset: sparse.values().offset(), count, bytes: accessor.size() };
        let elements = self.elements(&sparse.values().view(), &run)?;
        let components = accessor.dimensions().multiplicity();
        for (place, element) in places.zip(elements.all()) {
            let Some(target) = values.chunks_exact_mut(components).nth(place) else {
                return Err(format!("sparse index {place} of {} elements; export it again", accessor.count()));
            };
            for (value, bytes) in target.iter_mut().zip(element.chunks_exact(kind.size())) {
                *value = component(kind, bytes);
            }
        }
        Ok(())
    }

    /// The elements of a run in a buffer view, in order.
    fn elements(&self, view: &View, run: &Run) -> std::result::Result<Elements<'_>, String> {
        let buffer = &self.buffers[view.buffer().index()];
        let stride = view.stride().unwrap_or(run.bytes);
        let (index, length) = (view.index(), view.length());
        let Some(bytes) = part(&self.buffers, view.buffer().index(), (view.offset(), length)) else {
            return Err(format!("buffer view {index} exceeds its buffer of {} bytes; export it again", buffer.len()));
        };
        if stride < run.bytes {
            let size = run.bytes;
            return Err(format!(
                "stride {stride} of buffer view {index} is less than its {size} bytes; export it again"
            ));
        }
        let needed = match run.count {
            0 => Some(0),
            count => (count - 1).checked_mul(stride).and_then(|before_last| before_last.checked_add(run.bytes)),
        };
        let end = needed.and_then(|needed| needed.checked_add(run.offset)).filter(|&end| end <= length);
        let Some(end) = end else {
            return Err(format!("exceeds buffer view {index} of {length} bytes; export it again"));
        };
        Ok(Elements { bytes: &bytes[run.offset.min(end)..end], stride, size: run.bytes, count: run.count })
    }
}

/// A run of elements in a buffer view.
struct Run {
    /// Bytes before the first element.
    offset: usize,
    count: usize,
    /// Bytes of one element.
    bytes: usize,
}

/// Elements in a buffer view, all within its bytes.
struct Elements<'a> {
    bytes: &'a [u8],
    stride: usize,
    /// Bytes of one element.
    size: usize,
    count: usize,
}

impl<'a> Elements<'a> {
    fn get(&self, k: usize) -> &'a [u8] {
        &self.bytes[k * self.stride..][..self.size]
    }

    fn all(self) -> impl Iterator<Item = &'a [u8]> {
        (0..self.count).map(move |k| self.get(k))
    }
}

fn at(accessor: &Accessor, message: String) -> Error {
    Error::input(message).at(format!("accessor {}", accessor.index()))
}

/// One little-endian component; `bytes` has the size of its type.
fn component(kind: DataType, bytes: &[u8]) -> f64 {
    let mut word = [0; 4];
    word[..bytes.len()].copy_from_slice(bytes);
    match kind {
        DataType::I8 => f64::from(word[0] as i8),
        DataType::U8 => f64::from(word[0]),
        DataType::I16 => f64::from(i16::from_le_bytes([word[0], word[1]])),
        DataType::U16 => f64::from(u16::from_le_bytes([word[0], word[1]])),
        DataType::U32 => f64::from(u32::from_le_bytes(word)),
        DataType::F32 => f64::from(f32::from_le_bytes(word)),
    }
}

/// A normalised integer's value: over the largest, from -1 (glTF specification 3.11).
fn normalised(kind: DataType, value: f64) -> f64 {
    match kind {
        DataType::I8 => (value / f64::from(i8::MAX)).max(-1.0),
        DataType::U8 => value / f64::from(u8::MAX),
        DataType::I16 => (value / f64::from(i16::MAX)).max(-1.0),
        DataType::U16 => value / f64::from(u16::MAX),
        DataType::U32 | DataType::F32 => value,
    }
}

//! OpenEXR files: one layer, one channel per plane, 32-bit values kept bit for bit.

pub mod tiled;

use std::fs::File;
use std::io::{self, BufRead, BufReader, BufWriter, Read, Seek, SeekFrom, Write};
use std::path::Path;

use ::exr::image::{AnyChannel, AnyChannels, Blocks, Encoding, FlatSamples, Image, Layer};
use ::exr::meta::MetaData;
use ::exr::meta::attribute::{AttributeValue, LineOrder, Text};
use ::exr::meta::header::LayerAttributes;
use ::exr::prelude::{Compression, ReadChannels, ReadLayers, WritableImage};

use crate::image::file::whole::write_whole;
use crate::image::frame::{Channel, Frame, Plane};
use crate::image::size::check_size;
use crate::input::{Error, Loading, Result};

type Flat = AnyChannels<FlatSamples>;

/// Writes every channel of `frame` (f32 as FLOAT, ids as UINT, ZIP compression) and `attributes` as
/// texts in the header. The same input gives the same bytes.
///
/// # Errors
/// [`Error::Write`] if a plane does not fill the frame, an attribute has a reserved name, or `path`
/// cannot be written.
pub fn write_exr(path: &Path, frame: &Frame, attributes: &[(String, String)]) -> Result<()> {
    write_exr_with(path, frame, Vec::new(), &Attributes { texts: attributes.to_vec(), ..Attributes::default() })
}

/// Attributes of an EXR's header.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Attributes {
    /// Name and value.
    pub texts: Vec<(String, String)>,
    /// OpenEXR's `worldToCamera`, for row vectors, row by row. Camera space has x to the right, y up and z forward.
    pub world_to_camera: Option<[f32; 16]>,
    /// OpenEXR's `worldToNDC`. The image's upper left corner is (0, 0), its lower right corner (1, 1).
    pub world_to_ndc: Option<[f32; 16]>,
}

/// As [`write_exr`], with `more` named planes of floats beside the frame's, and attributes of all types.
///
/// # Errors
/// As [`write_exr`].
pub fn write_exr_with(
    path: &Path,
    frame: &Frame,
    more: Vec<(String, Vec<f32>)>,
    attributes: &Attributes,
) -> Result<()> {
    let refuse = |why: String| Error::work(format!("{}: cannot be written as EXR: {why}", path.display()));
    let size = (frame.width as usize, frame.height as usize);
    let own = frame.planes.iter().map(|(channel, plane)| (channel.name().to_owned(), plane.clone()));
    let more = more.into_iter().map(|(name, values)| (name, Plane::F32(values)));
    let channels = own.chain(more).map(|(name, plane)| channel_from(&name, plane, size.0 * size.1));
    let channels = channels.collect::<std::result::Result<_, _>>().map_err(refuse)?;
    let header = layer_attributes(attributes).map_err(refuse)?;
    let encoding =
        Encoding { compression: Compression::ZIP16, blocks: Blocks::ScanLines, line_order: LineOrder::Increasing };
    let image = Image::from_layer(Layer::new(size, header, encoding, AnyChannels::sort(channels)));
    write_whole(path, |file| {
        let mut writer = BufWriter::new(&mut *file);
        image.write().to_buffered(&mut writer).map_err(of_file)?;
        writer.flush()?;
        drop(writer);
        sort_attributes(file)
    })
}

/// An error of the file, in its own words.
fn of_file(e: ::exr::error::Error) -> io::Error {
    match e {
        ::exr::error::Error::Io(e) => e,
        other => io::Error::other(other.to_string()),
    }
}

fn layer_attributes(attributes: &Attributes) -> std::result::Result<LayerAttributes, String> {
    let mut header = LayerAttributes {
        world_to_camera: attributes.world_to_camera,
        world_to_normalized_device: attributes.world_to_ndc,
        ..LayerAttributes::default()
    };
    for (name, text) in &attributes.texts {
        if name.is_empty() || name.contains('\0') {
            return Err(format!("{name:?} is no name for an attribute"));
        }
        let name = Text::from_slice_unchecked(name.as_bytes());
        header.other.insert(name, AttributeValue::Text(Text::from_slice_unchecked(text.as_bytes())));
    }
    Ok(header)
}

fn channel_from(name: &str, plane: Plane, pixels: usize) -> std::result::Result<AnyChannel<FlatSamples>, String> {
    let samples = match plane {
        Plane::F32(values) => FlatSamples::F32(values),
        Plane::U32(values) => FlatSamples::U32(values),
    };
    if samples.len() != pixels || pixels == 0 {
        return Err(format!("channel {name} has {} values for {pixels} pixels", samples.len()));
    }
    Ok(AnyChannel::new(name, samples))
}

/// Bytes before the first attribute: the magic number and the version.
const ATTRIBUTES_START: u64 = 8;

/// Puts the header's attributes in the order of their names, in place: the library keeps them in a
/// hash table, so they would come in another order at every run.
fn sort_attributes(file: &mut (impl Read + Write + Seek)) -> io::Result<()> {
    file.seek(SeekFrom::Start(ATTRIBUTES_START))?;
    let mut reader = BufReader::new(&mut *file);
    let mut attributes: Vec<Vec<u8>> = Vec::new();
    loop {
        // Name and type, each up to its NUL; then the value's size and the value. An empty name ends the header.
        let mut attribute = Vec::new();
        if reader.read_until(0, &mut attribute)? <= 1 {
            break;
        }
        reader.read_until(0, &mut attribute)?;
        let mut size = [0; 4];
        reader.read_exact(&mut size)?;
        attribute.extend(size);
        let size = u64::from(u32::from_le_bytes(size));
        reader.by_ref().take(size).read_to_end(&mut attribute)?;
        attributes.push(attribute);
    }
    attributes.sort();
    file.seek(SeekFrom::Start(ATTRIBUTES_START))?;
    file.write_all(&attributes.concat())
}

/// Reads the channels that a [`Frame`] knows from the first layer; others are ignored. Half floats
/// become f32.
///
/// # Errors
/// [`Error::Missing`] or [`Error::Read`] if the file cannot be read; [`Error::Input`] naming it: damaged, without a known channel, or a known channel
/// of another type.
pub fn read_exr(path: &Path, loading: &Loading) -> Result<Frame> {
    let refuse = |why: String| Error::input(format!("{}: {why}", path.display()));
    let (width, height, mut layer) = read_layer(open(path, loading)?).map_err(refuse)?;
    let mut planes = Vec::new();
    for channel in Channel::every() {
        if let Some(samples) = take_channel(&mut layer, channel.name()) {
            let plane = plane_from(channel, samples, width as usize * height as usize).map_err(refuse)?;
            planes.push((channel, plane));
        }
    }
    if planes.is_empty() {
        let known: Vec<_> = Channel::every().map(Channel::name).collect();
        return Err(refuse(format!(
            "none of its channels is known; at least one of {} must be there",
            known.join(" ")
        )));
    }
    Ok(Frame { width, height, planes })
}

/// Names and values of the text attributes in an EXR's header; if it has several layers, those of the first.
///
/// # Errors
/// [`Error::Missing`] or [`Error::Read`] if the file cannot be read, [`Error::Input`] naming it if it is damaged.
#[cfg(feature = "cli")]
pub fn read_exr_texts(path: &Path, loading: &Loading) -> Result<Vec<(String, String)>> {
    let refuse = |why: String| Error::input(format!("{}: {why}", path.display()));
    let file = open(path, loading)?;
    let meta = MetaData::read_from_buffered(BufReader::new(&file), false)
        .map_err(|e| refuse(format!("not an EXR image that can be read: {e}")))?;
    let first = meta.headers.first().map(|header| &header.own_attributes.other);
    let text = |(name, value): (&Text, &AttributeValue)| match value {
        AttributeValue::Text(text) => Some((name.to_string(), text.to_string())),
        _ => None,
    };
    Ok(first.into_iter().flatten().filter_map(text).collect())
}

/// Reads float channels: width, height, and one plane each. `holds` describes them in errors, as in "R G B must hold x y z".
pub(super) fn read_planes<const N: usize>(
    path: &Path,
    channels: [Channel; N],
    holds: &str,
    loading: &Loading,
) -> Result<(u32, u32, [Vec<f32>; N])> {
    let refuse = |why: String| Error::input(format!("{}: {why}", path.display()));
    let (width, height, mut layer) = read_layer(open(path, loading)?).map_err(refuse)?;
    let mut plane = |channel: Channel| {
        let name = channel.name();
        let samples =
            take_channel(&mut layer, name).ok_or_else(|| refuse(format!("there is no channel {name}; {holds}")))?;
        match plane_from(channel, samples, width as usize * height as usize).map_err(refuse)? {
            Plane::F32(values) => Ok(values),
            Plane::U32(_) => Err(refuse(format!("channel {name} holds whole numbers, not floats"))),
        }
    };
    let mut planes = [const { Vec::new() }; N];
    for (values, channel) in planes.iter_mut().zip(channels) {
        *values = plane(channel)?;
    }
    Ok((width, height, planes))
}

/// Most bytes a damaged header may make of one byte of file: deflate reaches 1032, and a run-length
/// coder before it (DWA) 128 times that.
const MAX_EXPANSION: u64 = 1032 * 128;

fn open(path: &Path, loading: &Loading) -> Result<File> {
    loading.open(path).map_err(|e| Error::unreadable(path, format_args!("{e}; check the path")))
}

fn read_layer(file: File) -> std::result::Result<(u32, u32, Flat), String> {
    let unreadable = |e: io::Error| format!("cannot be read: {e}");
    let damaged = |e: ::exr::error::Error| format!("not an EXR image that can be read: {e}");
    let file_bytes = file.metadata().map_err(unreadable)?.len();
    let meta = MetaData::read_from_buffered(BufReader::new(&file), false).map_err(damaged)?;
    for header in &meta.headers {
        let size = header.layer_size;
        check_size(size.0 as u64, size.1 as u64).map_err(|e| e.to_string())?;
        let pixels = size.0 as u64 * size.1 as u64;
        let bytes = (header.channels.bytes_per_pixel as u64).saturating_mul(pixels);
        if bytes / MAX_EXPANSION > file_bytes {
            return Err(format!("the header promises {bytes} bytes of pixels and the file has {file_bytes} in all"));
        }
    }
    let reader = ::exr::prelude::read().no_deep_data().largest_resolution_level().all_channels();
    let mut start = &file;
    start.rewind().map_err(unreadable)?;
    let image = reader.first_valid_layer().all_attributes().from_buffered(BufReader::new(start)).map_err(damaged)?;
    let layer = image.layer_data;
    let (shown, at) = (image.attributes.display_window, layer.attributes.layer_position);
    if (shown.position, shown.size) != (at, layer.size) {
        return Err("its data window is not its display window: it is cropped, or larger; save the whole image".into());
    }
    // Both sides are far under 2^32 by the check above.
    Ok((layer.size.0 as u32, layer.size.1 as u32, layer.channel_data))
}

fn take_channel(layer: &mut Flat, name: &str) -> Option<FlatSamples> {
    let at = layer.list.iter().position(|channel| channel.name.eq(name))?;
    Some(layer.list.swap_remove(at).sample_data)
}

/// The plane of a channel, checked to be of the channel's type and to fill the image.
fn plane_from(channel: Channel, samples: FlatSamples, pixels: usize) -> std::result::Result<Plane, String> {
    let name = channel.name();
    if samples.len() != pixels {
        return Err(format!("channel {name} is subsampled; write it at full size"));
    }
    let is_id = channel.is_id();
    match samples {
        FlatSamples::U32(values) if is_id => Ok(Plane::U32(values)),
        FlatSamples::F32(values) if !is_id => Ok(Plane::F32(values)),
        FlatSamples::F16(values) if !is_id => Ok(Plane::F32(values.into_iter().map(|v| v.to_f32()).collect())),
        _ if is_id => Err(format!("channel {name} must be of type UINT")),
        _ => Err(format!("channel {name} must be of type FLOAT or HALF")),
    }
}

#[cfg(test)]
mod tests;

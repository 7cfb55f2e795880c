//! Tiled EXR files, written strip by strip, for images too large for memory.

use std::io::{BufWriter, Write};
use std::path::Path;

use ::exr::block::writer::{ChunksWriter, write_chunks_with};
use ::exr::block::{BlockIndex, UncompressedBlock, enumerate_ordered_header_block_indices};
use ::exr::math::RoundingMode;
use ::exr::meta::BlockDescription;
use ::exr::meta::attribute::{ChannelDescription, ChannelList, LevelMode, LineOrder, SampleType, TileDescription};
use ::exr::meta::header::Header;
use ::exr::prelude::{Compression, Text, Vec2};

use super::{Attributes, layer_attributes, of_file, sort_attributes};
use crate::image::file::whole::write_whole;
use crate::image::frame::{Channel, Frame, Plane};
use crate::input::{Error, Result};
use crate::parallel;

/// Tile size, pixels; the rows of every strip but the last are a multiple of it.
pub const TILE: u32 = 64;

/// Writes an image of `size` from its strips, top to bottom; each holds all `channels`, in the order of [`Channel`]. As
/// [`super::write_exr`] otherwise: ZIP compression, the same bytes for the same input.
///
/// # Errors
/// Those of `next`; [`Error::Work`] if strips are not those of the image, or `path` cannot be written.
pub fn write_exr_tiled(
    path: &Path,
    (width, height): (u32, u32),
    channels: &[Channel],
    attributes: &Attributes,
    mut next: impl FnMut() -> Result<Frame>,
) -> Result<()> {
    let refuse = |why: String| Error::work(format!("{}: cannot be written as EXR: {why}", path.display()));
    let mut sorted = channels.to_vec();
    sorted.sort_by_key(|channel| channel.name());
    let header = header((width, height), &sorted, layer_attributes(attributes).map_err(refuse)?);
    // what goes wrong with a strip, not with the file
    let mut failed = None;
    let written = write_whole(path, |file| {
        let mut writer = BufWriter::new(&mut *file);
        let mut strips = || -> ::exr::error::Result<(u32, Frame)> {
            let strip = next().and_then(|strip| checked(strip, width, &sorted).map_err(refuse));
            let strip = strip.map_err(|e| {
                failed = Some(e);
                ::exr::error::Error::Aborted
            })?;
            Ok((strip.height, strip))
        };
        let done = write_chunks_with(&mut writer, [header].into_iter().collect(), true, |meta, chunks| {
            let mut blocks = enumerate_ordered_header_block_indices(&meta.headers).peekable();
            let mut top = 0;
            while blocks.peek().is_some() {
                let (rows, strip) = strips()?;
                let end = (top + rows) as usize;
                let mut own = Vec::new();
                while let Some(block) = blocks.next_if(|(_, block)| block.pixel_position.y() < end) {
                    own.push(block);
                }
                let compressed = parallel::try_map(&own, |&(k, index)| {
                    let block = block(&strip, &sorted, &meta.headers[0].channels, index, top as usize);
                    Ok::<_, ::exr::error::Error>((k, block.compress_to_chunk(&meta.headers)?))
                })?;
                for (k, chunk) in compressed {
                    chunks.write_chunk(k, chunk)?;
                }
                top += rows;
            }
            Ok(())
        });
        done.map_err(of_file)?;
        writer.flush()?;
        drop(writer);
        sort_attributes(file)
    });
    match failed {
        Some(e) => Err(e),
        None => written,
    }
}

fn header((width, height): (u32, u32), channels: &[Channel], own: ::exr::meta::header::LayerAttributes) -> Header {
    let tiles = TileDescription {
        tile_size: Vec2(TILE as usize, TILE as usize),
        level_mode: LevelMode::Singular,
        rounding_mode: RoundingMode::Down,
    };
    let described = |channel: &Channel| {
        let kind = if channel.is_id() { SampleType::U32 } else { SampleType::F32 };
        ChannelDescription::named(channel.name(), kind)
    };
    Header::new(Text::default(), (width as usize, height as usize), channels.iter().map(described).collect())
        .with_encoding(Compression::ZIP16, BlockDescription::Tiles(tiles), LineOrder::Increasing)
        .with_attributes(own)
}

/// The strip with its planes in the order of the file.
fn checked(strip: Frame, width: u32, channels: &[Channel]) -> std::result::Result<Frame, String> {
    let Frame { width: own, height, mut planes } = strip;
    planes.sort_by_key(|(channel, _)| channel.name());
    let pixels = width as usize * height as usize;
    let is_whole = own == width && height > 0 && planes.iter().map(|p| p.0).eq(channels.iter().copied());
    if is_whole && planes.iter().all(|(_, plane)| plane.count() == pixels) {
        return Ok(Frame { width, height, planes });
    }
    Err(format!("a strip of {own} x {height} with {} channels is none of this image", planes.len()))
}

/// A tile of a strip whose first row is the image's row `top`.
fn block(strip: &Frame, channels: &[Channel], list: &ChannelList, index: BlockIndex, top: usize) -> UncompressedBlock {
    debug_assert_eq!(channels.len(), strip.planes.len());
    UncompressedBlock::from_lines(list, index, |line| {
        let place = line.location;
        let first = (place.position.y() - top) * strip.width as usize + place.position.x();
        let range = first..first + place.sample_count;
        // the bytes of the machine, which the compressor reads
        let bytes: &[u8] = match &strip.planes[place.channel].1 {
            Plane::F32(values) => bytemuck::cast_slice(&values[range]),
            Plane::U32(values) => bytemuck::cast_slice(&values[range]),
        };
        line.value.copy_from_slice(bytes);
    })
}

//! 8-bit sRGB PNG files.

use crate::arrays::MapEach;
use std::io::{self, BufWriter, Write};
use std::path::Path;

use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder};

use crate::image::file::whole::write_whole;
use crate::image::frame::{Channel, Frame};
use crate::image::tone::Tone;
use crate::input::{Error, Result};

/// Writes `srgb8`, three (RGB) or four (RGBA) bytes per pixel, row 0 on top.
///
/// # Errors
/// [`Error::Work`] if the bytes do not fit the size, [`Error::Write`] if `path` cannot be written.
pub fn write_png(path: &Path, width: u32, height: u32, srgb8: &[u8]) -> Result<()> {
    let color = color_type(width, height, srgb8).map_err(|why| Error::work(format!("{}: {why}", path.display())))?;
    write_whole(path, |file| {
        let mut writer = BufWriter::new(file);
        encode(&mut writer, (width, height), srgb8, color)?;
        writer.flush()
    })
}

/// The bytes of the file that [`write_png`] writes.
///
/// # Errors
/// [`Error::Work`] if the bytes do not fit the size.
#[cfg(any(feature = "cli", feature = "view"))]
pub fn png_bytes(width: u32, height: u32, srgb8: &[u8]) -> Result<Vec<u8>> {
    let color = color_type(width, height, srgb8).map_err(Error::work)?;
    let mut bytes = Vec::new();
    encode(&mut bytes, (width, height), srgb8, color).map_err(|e| Error::work(e.to_string()))?;
    Ok(bytes)
}

fn color_type(width: u32, height: u32, srgb8: &[u8]) -> std::result::Result<ExtendedColorType, String> {
    let pixels = u64::from(width) * u64::from(height);
    match srgb8.len() as u64 {
        bytes if pixels > 0 && bytes == 3 * pixels => Ok(ExtendedColorType::Rgb8),
        bytes if pixels > 0 && bytes == 4 * pixels => Ok(ExtendedColorType::Rgba8),
        bytes => Err(format!("{bytes} bytes are not {width} x {height} pixels")),
    }
}

fn encode(to: &mut dyn Write, (width, height): (u32, u32), srgb8: &[u8], color: ExtendedColorType) -> io::Result<()> {
    PngEncoder::new(to).write_image(srgb8, width, height, color).map_err(|e| match e {
        image::ImageError::IoError(e) => e,
        other => io::Error::other(other),
    })
}

/// Writes an image of `size` from its strips of whole rows, top to bottom: three bytes (RGB) per pixel.
///
/// # Errors
/// Those of `next`; [`Error::Work`] if strips are not those of the image, [`Error::Write`] if `path` cannot be written.
pub fn write_png_strips(
    path: &Path,
    (width, height): (u32, u32),
    mut next: impl FnMut() -> Result<Vec<u8>>,
) -> Result<()> {
    // what goes wrong with a strip, not with the file
    let mut failed = None;
    let written = write_whole(path, |file| {
        let mut encoder = png::Encoder::new(BufWriter::new(file), width, height);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_compression(png::Compression::Fast);
        encoder.set_filter(png::Filter::Adaptive);
        let mut writer = encoder.write_header()?;
        let mut rows = writer.stream_writer_with_size(STREAMED)?;
        let row = 3 * width as usize;
        let mut left = height as usize;
        while left > 0 {
            let strip = next().and_then(|strip| match strip.len() / row {
                count if (1..=left).contains(&count) && strip.len() == count * row => Ok(strip),
                _ => {
                    let (path, bytes) = (path.display(), strip.len());
                    Err(Error::work(format!("{path}: {bytes} bytes are no rows of {width} x {height} pixels")))
                }
            });
            let strip = strip.map_err(|e| {
                failed = Some(e);
                io::Error::other("a strip failed")
            })?;
            rows.write_all(&strip)?;
            left -= strip.len() / row;
        }
        rows.finish()?;
        Ok(writer.finish()?)
    });
    match failed {
        Some(e) => Err(e),
        None => written,
    }
}

/// Bytes of a chunk of a file that is written strip by strip.
const STREAMED: usize = 1 << 16;

/// Without the fourth of each four bytes.
pub fn rgb8(rgba: &[u8]) -> Vec<u8> {
    rgba.chunks_exact(4).flat_map(|p| [p[0], p[1], p[2]]).collect()
}

/// [`srgb8`] of a tone-mapped linear value.
pub fn toned8(tone: Tone, linear: f32) -> u8 {
    srgb8(tone.shown(f64::from(linear)) as f32)
}

/// A frame's colour as opaque 8-bit sRGB, four bytes a pixel; `None` without colour.
pub fn opaque8(frame: &Frame, tone: Tone) -> Option<Vec<u8>> {
    let [r, g, b] = [Channel::R, Channel::G, Channel::B].map_each(|channel| frame.f32(channel));
    let byte = |linear: &f32| toned8(tone, *linear);
    Some(r?.iter().zip(g?).zip(b?).flat_map(|((r, g), b)| [byte(r), byte(g), byte(b), u8::MAX]).collect())
}

/// The 8-bit sRGB value nearest to a linear one; NaN and negative values give 0, above 1 gives 255.
/// (IEC 61966-2-1, its piecewise curve.)
pub fn srgb8(linear: f32) -> u8 {
    let linear = f64::from(linear);
    let encoded = if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 };
    // `as` saturates and takes NaN to 0.
    (encoded * 255.0).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn srgb_ends_and_middle() {
        for (linear, expected) in [
            (0.0, 0),
            (1.0, 255),
            (0.5, 188),
            (0.214_041_14, 128),
            (0.003_130_8, 10),
            (-1.0, 0),
            (2.0, 255),
            (f32::NAN, 0),
            (f32::INFINITY, 255),
            (f32::NEG_INFINITY, 0),
        ] {
            assert_eq!(srgb8(linear), expected, "{linear}");
        }
    }

    #[test]
    fn srgb_inverts_the_decoding_of_every_byte() {
        for byte in 0..=255u8 {
            let encoded = f64::from(byte) / 255.0;
            let linear = if encoded <= 0.04045 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) };
            assert_eq!(srgb8(linear as f32), byte);
        }
    }

    #[test]
    fn png_reads_back_as_written() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.png");
        for channels in [3, 4] {
            let bytes: Vec<u8> = (0..5 * 7 * channels).map(|i| (i * 37 % 256) as u8).collect();
            write_png(&path, 5, 7, &bytes).unwrap();
            let back = image::open(&path).unwrap();
            assert_eq!((back.width(), back.height()), (5, 7));
            assert_eq!(back.as_bytes(), bytes);
        }
        assert!(matches!(write_png(&path, 5, 7, &[0; 5]), Err(Error::Work(_))));
        assert!(matches!(write_png(&path, 0, 0, &[]), Err(Error::Work(_))));
    }

    #[test]
    fn strips_read_back_as_the_image_that_they_are_of() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.png");
        let row = |y: usize| (0..15).map(move |i| ((15 * y + i) * 37 % 251) as u8);
        let strip = |rows: std::ops::Range<usize>| Ok(rows.flat_map(row).collect::<Vec<u8>>());
        let mut strips = [strip(0..3), strip(3..4), strip(4..7)].into_iter();
        write_png_strips(&path, (5, 7), || strips.next().unwrap()).unwrap();
        let back = image::open(&path).unwrap();
        assert_eq!((back.width(), back.height()), (5, 7));
        assert_eq!(back.as_bytes(), strip(0..7).unwrap());
    }

    #[test]
    fn strips_that_are_not_the_image_s_leave_the_file_as_it_was() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.png");
        std::fs::write(&path, "before").unwrap();
        for bytes in [0, 14, 16, 15 * 8] {
            let refused = write_png_strips(&path, (5, 7), || Ok(vec![0; bytes]));
            assert!(matches!(&refused, Err(Error::Work(text)) if text.contains("are no rows of 5 x 7")));
        }
        let failed = write_png_strips(&path, (5, 7), || Err(Error::input("it failed")));
        assert!(matches!(failed, Err(Error::Input(text)) if text == "it failed"));
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "before");
    }
}

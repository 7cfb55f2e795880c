//! Images on surfaces, decoded to linear light.

use crate::arrays::MapEach;
use crate::input::{Error, Limits, Loading, Result};
use crate::parallel;
use glam::DVec2;
use half::f16;
use image::{DynamicImage, ImageBuffer, ImageError, ImageFormat, ImageReader};
use std::collections::HashMap;
use std::fmt;
use std::io::Cursor;
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};
use tiff::decoder::DecodingResult;
use tiff::{ColorType, TiffError};

/// Texels of an image, row 0 on top.
#[derive(Debug, PartialEq)]
pub struct Texels {
    pub width: u32,
    pub height: u32,
    /// Linear RGB and opacity, as the kernels see them: half floats keep 11 bits, which is finer than 8-bit sRGB everywhere.
    pub rgba: Vec<[f16; 4]>,
}

/// Wrap modes beyond an image's borders.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[repr(u32)]
pub enum Wrap {
    Repeat,
    Clamp,
    Mirror,
}

/// An image on surfaces: (0, 0) is its lower left corner, (1, 1) its upper right one.
#[derive(Debug, Clone)]
pub struct Texture {
    pub texels: Arc<Texels>,
    /// To the right and upwards.
    pub wrap: [Wrap; 2],
    /// Alpha cutoff: the least opacity of the surface; `None`: opaque everywhere.
    pub cutoff: Option<f32>,
}

impl PartialEq for Texture {
    fn eq(&self, other: &Texture) -> bool {
        let same = Arc::ptr_eq(&self.texels, &other.texels) || self.texels == other.texels;
        same && self.wrap == other.wrap && self.cutoff == other.cutoff
    }
}

impl Texture {
    /// Repeats, and is opaque.
    pub fn new(texels: Arc<Texels>) -> Texture {
        Texture { texels, wrap: [Wrap::Repeat; 2], cutoff: None }
    }

    /// Linear RGB and opacity at `uv`, of the image itself: between the middles of its texels bilinear, colours by their opacity
    /// where that counts.
    pub fn at(&self, uv: DVec2) -> [f64; 4] {
        let Texels { width, height, .. } = *self.texels;
        let u = into_image(uv.x, self.wrap[0]);
        let v = into_image(1.0 - uv.y, self.wrap[1]);
        let place = DVec2::new(u, v) * DVec2::new(width.into(), height.into()) - 0.5;
        let (first, part) = (place.floor(), place - place.floor());
        let mean = |a: [f64; 4], b: [f64; 4], part: f64| std::array::from_fn(|k| a[k] + part * (b[k] - a[k]));
        let row = |dy: i64| {
            let texel = |dx: i64| self.texel(first.x as i64 + dx, first.y as i64 + dy);
            mean(texel(0), texel(1), part.x)
        };
        let [r, g, b, a] = mean(row(0), row(1), part.y);
        if a > 0.0 { [r / a, g / a, b / a, a] } else { [0.0; 4] }
    }

    /// The same alpha mask in white.
    pub fn white(&self) -> Texture {
        let Texels { width, height, rgba } = &*self.texels;
        let rgba = parallel::map(rgba, |t| [f16::ONE, f16::ONE, f16::ONE, t[3]]);
        Texture { texels: Arc::new(Texels { width: *width, height: *height, rgba }), ..self.clone() }
    }

    /// Whether it is an alpha mask: some cutoff is above 0.
    pub fn has_alpha_mask(&self) -> bool {
        self.least().is_some_and(|least| least > f16::ZERO)
    }

    /// Whether the surface exists at `uv`: its opacity reaches the cutoff.
    pub fn is_there(&self, uv: DVec2) -> bool {
        self.least().is_none_or(|least| self.at(uv)[3] >= f64::from(least))
    }

    /// The cutoff, rounded as opacities are: one that is meant to reach it does.
    pub fn least(&self) -> Option<f16> {
        self.cutoff.map(f16::from_f32)
    }

    /// Colours times their opacity, where that counts, and it.
    fn texel(&self, column: i64, row: i64) -> [f64; 4] {
        let Texels { width, height, rgba } = &*self.texels;
        let x = wrapped(column, i64::from(*width), self.wrap[0]);
        let y = wrapped(row, i64::from(*height), self.wrap[1]);
        let [r, g, b, a] = rgba[(y * i64::from(*width) + x) as usize].map_each(f64::from);
        let a = if self.cutoff.is_some() { a } else { 1.0 };
        [r * a, g * a, b * a, a]
    }
}

/// The same place of an image, near it.
fn into_image(u: f64, wrap: Wrap) -> f64 {
    match wrap {
        Wrap::Repeat => u.rem_euclid(1.0),
        Wrap::Clamp => u.clamp(0.0, 1.0),
        Wrap::Mirror => u.rem_euclid(2.0),
    }
}

/// A texel's index within `count`.
fn wrapped(index: i64, count: i64, wrap: Wrap) -> i64 {
    match wrap {
        Wrap::Repeat => index.rem_euclid(count),
        Wrap::Clamp => index.clamp(0, count - 1),
        Wrap::Mirror => {
            let place = index.rem_euclid(2 * count);
            place.min(2 * count - 1 - place)
        }
    }
}

/// Most texels a side, of a program's images.
const SIDE_MAX: usize = 1 << 16;

impl Texels {
    /// Those of 8-bit sRGB colours, three (RGB) or four (RGBA) bytes each.
    ///
    /// # Errors
    /// [`Error::Input`] if there are not so many bytes, or too many texels.
    pub fn of_srgb8(width: usize, height: usize, srgb8: &[u8]) -> Result<Texels> {
        let count = width.saturating_mul(height);
        let is_side = |side: usize| (1..=SIDE_MAX).contains(&side);
        let each = srgb8.len().checked_div(count).unwrap_or(0);
        if !is_side(width) || !is_side(height) || !matches!(each, 3 | 4) || srgb8.len() != each * count {
            let bytes = srgb8.len();
            return Err(Error::input(format!(
                "{bytes} bytes are no image of {width} x {height} pixels, of 3 or 4 bytes each"
            )));
        }
        let texel = |p: &[u8]| texel_of([p[0], p[1], p[2], p.get(3).copied().unwrap_or(u8::MAX)], tables());
        let rgba = srgb8.chunks_exact(each).map(texel).collect();
        Ok(Texels { width: width as u32, height: height as u32, rgba })
    }
}

/// Which textures are loaded.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ImagesRead {
    #[default]
    All,
    /// Alpha masks only: enough if no colour is asked for.
    Masks,
    None,
}

impl ImagesRead {
    /// Whether an image is read that is an alpha mask, or is none.
    pub fn reads(self, is_mask: bool) -> bool {
        match self {
            ImagesRead::All => true,
            ImagesRead::Masks => is_mask,
            ImagesRead::None => false,
        }
    }
}

/// The textures of mesh files, each decoded once.
#[derive(Default)]
pub struct Images {
    known: HashMap<PathBuf, Arc<Texels>>,
    pub read: ImagesRead,
    /// Materials with an opacity are blended; otherwise they are there where it reaches their cutoff.
    pub blends: bool,
}

impl Images {
    /// No images are read.
    pub fn left_out() -> Images {
        Images::of(ImagesRead::None)
    }

    pub fn of(read: ImagesRead) -> Images {
        Images { read, ..Images::default() }
    }

    /// The texels of an image file: PNG, JPEG, Radiance, WebP, BMP, TGA, TIFF or GIF.
    ///
    /// # Errors
    /// [`Error::Missing`] or [`Error::Read`] where it cannot be read, [`Error::Input`] naming the file where it is none of these.
    pub fn load(&mut self, path: &Path, loading: &Loading) -> Result<Arc<Texels>> {
        self.find(path, loading)?.map_err(|absent| match absent {
            Absent::NoFile => Error::unreadable(path, absent),
            Absent::Format(_) => Error::input(format!("{}: {absent}; save it as PNG", path.display())),
        })
    }

    /// As [`Images::load`], or why a mesh is shown without the image.
    ///
    /// # Errors
    /// [`Error::Missing`] or [`Error::Read`] if it exists and cannot be read, [`Error::Input`] naming the file if it is no image.
    pub fn find(&mut self, path: &Path, loading: &Loading) -> Result<std::result::Result<Arc<Texels>, Absent>> {
        if let Some(known) = self.known.get(path) {
            loading.note(path);
            return Ok(Ok(known.clone()));
        }
        let start = match loading.prefix(path) {
            Ok(start) => start,
            Err(e) if is_missing(&e) => return Ok(Err(Absent::NoFile)),
            Err(e) => return Err(Error::unreadable(path, e)),
        };
        if let Some(format) = unread_format(start.bytes()) {
            return Ok(Err(Absent::Format(format)));
        }
        let is_tga = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("tga"));
        let is_image = if is_tga { is_tga_start(start.bytes()) } else { has_known_start(start.bytes()) };
        let bytes = start.read_if(is_image).map_err(|e| Error::unreadable(path, e))?;
        // the bytes of TGA images do not tell the format
        let image = decoded(&bytes, is_tga.then_some(ImageFormat::Tga)).map_err(|e| e.at(path.display()))?;
        let texels = Arc::new(texels_of(image));
        self.known.insert(path.to_owned(), texels.clone());
        Ok(Ok(texels))
    }
}

/// Why an image is not there.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Absent {
    NoFile,
    /// It is an image of a kind that is not read.
    Format(&'static str),
}

impl fmt::Display for Absent {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Absent::NoFile => f.write_str("the file does not exist"),
            Absent::Format(format) => write!(f, "{format} images are not read"),
        }
    }
}

/// The kind of an image that models have and that is not read.
pub fn unread_format(bytes: &[u8]) -> Option<&'static str> {
    const FORMATS: [(usize, &[u8], &str); 8] = [
        (0, b"\xABKTX 20\xBB", "KTX2"),
        (0, b"\xABKTX 11\xBB", "KTX"),
        (0, b"DDS ", "DDS"),
        (0, b"8BPS", "PSD"),
        (0, b"\x76\x2F\x31\x01", "OpenEXR"),
        (4, b"ftypavif", "AVIF"),
        (4, b"ftyphei", "HEIF"),
        (4, b"jP  \r\n", "JPEG 2000"),
    ];
    FORMATS.iter().find(|(at, magic, _)| bytes.get(*at..).is_some_and(|b| b.starts_with(magic))).map(|f| f.2)
}

/// Whether a file that starts so may be an image. Others are refused by their first bytes.
pub fn has_known_start(bytes: &[u8]) -> bool {
    is_tiff(bytes) || image::guess_format(bytes).is_ok()
}

fn is_tiff(bytes: &[u8]) -> bool {
    bytes.starts_with(b"II*\0") || bytes.starts_with(b"MM\0*")
}

/// Whether the third byte is a type of TGA images: with a palette, of colors or gray, each also compressed.
fn is_tga_start(bytes: &[u8]) -> bool {
    matches!(bytes.get(2), Some(1..=3 | 9..=11))
}

/// Whether the error means that the file does not exist.
pub fn is_missing(e: &std::io::Error) -> bool {
    matches!(e.kind(), std::io::ErrorKind::NotFound | std::io::ErrorKind::NotADirectory)
}

/// The texels of an image, whose colours are sRGB (IEC 61966-2-1), or of a Radiance picture, which are linear light.
///
/// # Errors
/// [`Error::Input`] if it is none that is read, damaged, or too large for memory.
pub fn decode(bytes: &[u8]) -> Result<Texels> {
    decoded(bytes, None).map(texels_of)
}

fn texels_of(image: DynamicImage) -> Texels {
    let (width, height) = (image.width(), image.height());
    let rgba = match image {
        DynamicImage::ImageLuma16(_)
        | DynamicImage::ImageLumaA16(_)
        | DynamicImage::ImageRgb16(_)
        | DynamicImage::ImageRgba16(_) => {
            let linear = |v: u16| f16::from_f64(linear_of_srgb(f64::from(v) / 65535.0));
            let pixel =
                |[r, g, b, a]: [u16; 4]| [linear(r), linear(g), linear(b), f16::from_f64(f64::from(a) / 65535.0)];
            parallel::map(image.into_rgba16().as_chunks::<4>().0, |p| pixel(*p))
        }
        // light as it is
        DynamicImage::ImageRgb32F(_) | DynamicImage::ImageRgba32F(_) => {
            let clamped = |v: f32| f16::from_f32(v.clamp(0.0, f16::MAX.to_f32()));
            parallel::map(image.into_rgba32f().as_chunks::<4>().0, |p| p.map_each(clamped))
        }
        _ => {
            let tables = tables();
            parallel::map(image.into_rgba8().as_chunks::<4>().0, |p| texel_of(*p, tables))
        }
    };
    Texels { width, height, rgba }
}

/// Begins the line of an error.
const NO_IMAGE: &str = "is no PNG, JPEG or HDR, nor WebP, BMP, TGA, TIFF or GIF, that can be read";

/// The pixels of such a file as they are stored, one at least, from the bytes of a format; `None`: the one that they tell.
///
/// # Errors
/// Those of [`decode`].
pub fn decoded(bytes: &[u8], format: Option<ImageFormat>) -> Result<DynamicImage> {
    let wrong = |e: String| Error::input(format!("{NO_IMAGE}: {e}"));
    if format.is_none() && is_tiff(bytes) {
        return decoded_tiff(bytes).map_err(wrong);
    }
    let reader = match format {
        Some(format) => ImageReader::with_format(Cursor::new(bytes), format),
        None => ImageReader::new(Cursor::new(bytes)).with_guessed_format().map_err(|e| wrong(e.to_string()))?,
    };
    let image = reader.decode().map_err(|e| match e {
        ImageError::Limits(_) => {
            let most = image::Limits::default().max_alloc.unwrap_or(u64::MAX) >> 20;
            Error::input(format!(
                "is an image that takes more than {most} MiB of memory, the limit for one; make it smaller"
            ))
        }
        other => wrong(other.to_string()),
    })?;
    if image.width() == 0 || image.height() == 0 {
        return Err(Error::input("is an image without pixels"));
    }
    Ok(image)
}

/// The first image of a TIFF of 8 or 16 bits a sample.
fn decoded_tiff(bytes: &[u8]) -> std::result::Result<DynamicImage, String> {
    use ColorType::{Gray, GrayA, RGB, RGBA};
    use DecodingResult::{U8, U16};
    let wrong = |e: TiffError| e.to_string();
    let mut tiff = tiff::decoder::Decoder::new(Cursor::new(bytes)).map_err(wrong)?;
    let (width, height) = tiff.dimensions().map_err(wrong)?;
    let color = tiff.colortype().map_err(wrong)?;
    let samples = tiff.read_image().map_err(wrong)?;
    let image = match (samples, color) {
        (U8(s), Gray(8)) => ImageBuffer::from_raw(width, height, s).map(DynamicImage::ImageLuma8),
        (U8(s), GrayA(8)) => ImageBuffer::from_raw(width, height, s).map(DynamicImage::ImageLumaA8),
        (U8(s), RGB(8)) => ImageBuffer::from_raw(width, height, s).map(DynamicImage::ImageRgb8),
        (U8(s), RGBA(8)) => ImageBuffer::from_raw(width, height, s).map(DynamicImage::ImageRgba8),
        (U16(s), Gray(16)) => ImageBuffer::from_raw(width, height, s).map(DynamicImage::ImageLuma16),
        (U16(s), RGB(16)) => ImageBuffer::from_raw(width, height, s).map(DynamicImage::ImageRgb16),
        (U16(s), RGBA(16)) => ImageBuffer::from_raw(width, height, s).map(DynamicImage::ImageRgba16),
        (_, other) => return Err(format!("its samples are {other:?}; 8 or 16 bits of grey or RGB are read")),
    };
    let image = image.ok_or("it has fewer samples than pixels")?;
    if width == 0 || height == 0 {
        return Err("it has no pixels".into());
    }
    Ok(image)
}

/// Colours, or white, with the opacities of another image that lies `offset` from them, as many texels as the larger of both: its
/// alpha, or how light it is where that is 1 everywhere.
///
/// # Errors
/// [`Error::Work`] if that does not fit the free memory.
pub fn with_opacity(colours: Option<Texture>, mask: Texture, offset: DVec2, limits: Limits) -> Result<Arc<Texels>> {
    let by_alpha = mask.texels.rgba.iter().any(|t| t[3] < f16::ONE);
    let mask = Texture { cutoff: by_alpha.then_some(0.0), ..mask };
    let size = |t: &Texture| [t.texels.width, t.texels.height];
    let [width, height] = match &colours {
        Some(colours) => [0, 1].map_each(|k| size(colours)[k].max(size(&mask)[k])),
        None => size(&mask),
    };
    let what = format_args!("an image with its mask, {width} x {height} texels,");
    limits.check_memory(8 * u64::from(width) * u64::from(height), what, "make one of the two smaller")?;
    let texel = |k: usize| {
        let (x, y) = (k % width as usize, k / width as usize);
        let uv = DVec2::new((x as f64 + 0.5) / f64::from(width), 1.0 - (y as f64 + 0.5) / f64::from(height));
        let [r, g, b, _] = colours.as_ref().map_or([1.0; 4], |c| c.at(uv));
        let [light, _, _, alpha] = mask.at(uv + offset);
        [r, g, b, if by_alpha { alpha } else { srgb_of_linear(light) }].map_each(f16::from_f64)
    };
    let rgba = parallel::map(0..width as usize * height as usize, texel);
    Ok(Arc::new(Texels { width, height, rgba }))
}

/// Of each byte its linear value as sRGB, and as a share.
fn tables() -> &'static [[f16; 256]; 2] {
    static TABLES: OnceLock<[[f16; 256]; 2]> = OnceLock::new();
    TABLES.get_or_init(|| {
        let share = |k: usize| k as f64 / 255.0;
        [
            std::array::from_fn(|k| f16::from_f64(linear_of_srgb(share(k)))),
            std::array::from_fn(|k| f16::from_f64(share(k))),
        ]
    })
}

/// The texel of an sRGB colour and its opacity.
fn texel_of([r, g, b, a]: [u8; 4], [linear, plain]: &[[f16; 256]; 2]) -> [f16; 4] {
    let [r, g, b] = [r, g, b].map_each(|v| linear[usize::from(v)]);
    [r, g, b, plain[usize::from(a)]]
}

pub(super) fn linear_of_srgb(v: f64) -> f64 {
    if v <= 0.040_45 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
}

/// The value of a full colour in a file that does not say it: 255 where all values are whole numbers and one is above 1, else 1. NaN stands
/// for no colour.
pub(super) fn full_color<'a>(values: impl Iterator<Item = &'a f64> + Clone) -> f64 {
    let is_bytes = values.clone().any(|c| *c > 1.0) && values.filter(|c| !c.is_nan()).all(|c| c.fract() == 0.0);
    if is_bytes { 255.0 } else { 1.0 }
}

/// Linear light of an sRGB colour from 0 to `full`; white where it is not finite.
pub(super) fn linear_color(srgb: [f64; 3], full: f64) -> [f32; 3] {
    match srgb.iter().all(|c| c.is_finite()) {
        true => srgb.map_each(|c| linear_of_srgb((c / full).clamp(0.0, 1.0)) as f32),
        false => [1.0; 3],
    }
}

fn srgb_of_linear(v: f64) -> f64 {
    if v <= 0.003_130_8 { 12.92 * v } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 }
}

#[cfg(test)]
mod tests;

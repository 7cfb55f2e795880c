//! TIFFs with one band. Tags of GeoTIFF (OGC 19-008r4) and GDAL are used if present.

use super::{Georeference, Grid, check_sides};
use crate::parallel;
use glam::DVec2;
use std::io::Cursor;
use tiff::decoder::{Decoder, DecodingResult, Limits};
use tiff::tags::Tag;
use tiff::{ColorType, TiffError};

type Tiff<'a> = Decoder<Cursor<&'a [u8]>>;

/// Most bytes of one tag's value: the offsets of 8 million strips.
const VALUE_BYTES_MAX: usize = 1 << 26;

/// Reads the first image of the file.
///
/// # Errors
/// What is wrong, without the name of the file.
pub fn read(bytes: &[u8]) -> Result<Grid, String> {
    let mut tiff = Decoder::new(Cursor::new(bytes)).map_err(wrong)?;
    let (columns, rows) = tiff.dimensions().map_err(wrong)?;
    check_sides(columns.into(), rows.into())?;
    match tiff.colortype().map_err(wrong)? {
        ColorType::Gray(_) => {}
        other => return Err(format!("is no height image: its samples are {other:?}; one band of heights is needed")),
    }
    let no_data = no_data(&mut tiff);
    let georeference = georeference(&mut tiff, columns, rows)?;
    let mut limits = Limits::default();
    limits.decoding_buffer_size = columns as usize * rows as usize * size_of::<f64>();
    limits.intermediate_buffer_size = limits.decoding_buffer_size.max(limits.intermediate_buffer_size);
    limits.ifd_value_size = VALUE_BYTES_MAX;
    let mut tiff = tiff.with_limits(limits);
    let image = tiff.read_image().map_err(wrong)?;
    // some programs write too few digits for an f32, as in -3.40282346638529e+38
    let no_data = no_data.map(|h| if matches!(image, DecodingResult::F32(_)) { f64::from(h as f32) } else { h });
    let mut samples = numbers(image);
    parallel::for_each_mut(&mut samples, |_, h| {
        if Some(*h) == no_data || !h.is_finite() {
            *h = f64::NAN;
        }
    });
    let (columns, rows) = (columns as usize, rows as usize);
    if samples.len() != columns * rows {
        return Err(format!("is no height image: it has {} numbers for {columns} x {rows} heights", samples.len()));
    }
    Ok(Grid { columns, rows, samples, georeference })
}

fn wrong(e: TiffError) -> String {
    format!("is no TIFF that can be read: {e}")
}

fn numbers(image: DecodingResult) -> Vec<f64> {
    fn of<T: Into<f64> + Copy + Send + Sync>(list: Vec<T>) -> Vec<f64> {
        parallel::map(&list, |h| (*h).into())
    }
    match image {
        DecodingResult::U8(list) => of(list),
        DecodingResult::U16(list) => of(list),
        DecodingResult::U32(list) => of(list),
        DecodingResult::U64(list) => list.into_iter().map(|h| h as f64).collect(),
        DecodingResult::I8(list) => of(list),
        DecodingResult::I16(list) => of(list),
        DecodingResult::I32(list) => of(list),
        DecodingResult::I64(list) => list.into_iter().map(|h| h as f64).collect(),
        DecodingResult::F16(list) => list.into_iter().map(f64::from).collect(),
        DecodingResult::F32(list) => of(list),
        DecodingResult::F64(list) => list,
    }
}

/// The value for no data, which GDAL stores as text.
fn no_data(tiff: &mut Tiff) -> Option<f64> {
    let text = tiff.get_tag_ascii_string(Tag::GdalNodata).ok()?;
    text.trim_matches(['\0', ' ']).parse().ok()
}

/// GeoKeys, and values of them.
const MODEL_TYPE: u16 = 1024;
const GEOGRAPHIC: u16 = 2;
const RASTER_TYPE: u16 = 1025;
const PIXEL_IS_POINT: u16 = 2;

/// `None` if the TIFF has no tags of GeoTIFF.
fn georeference(tiff: &mut Tiff, columns: u32, rows: u32) -> Result<Option<Georeference>, String> {
    let keys = tiff.get_tag_u16_vec(Tag::GeoKeyDirectoryTag).unwrap_or_default();
    let key = |id: u16| keys.chunks_exact(4).skip(1).find(|k| k[0] == id && k[1] == 0).map(|k| k[3]);
    let scale = tiff.get_tag_f64_vec(Tag::ModelPixelScaleTag).ok();
    let tie = tiff.get_tag_f64_vec(Tag::ModelTiepointTag).ok();
    let matrix = tiff.get_tag_f64_vec(Tag::ModelTransformationTag).ok();
    // the map coordinates of raster coordinates (0, 0), and the cell to the east and south
    let (origin, cell) = match (scale.as_deref(), tie.as_deref(), matrix.as_deref()) {
        (Some([sx, sy, ..]), Some([i, j, _, x, y, ..]), _) => {
            (DVec2::new(x - i * sx, y + j * sy), DVec2::new(*sx, *sy))
        }
        (_, _, Some([xx, xy, _, x, yx, yy, _, y, ..])) if *xy == 0.0 && *yx == 0.0 => {
            (DVec2::new(*x, *y), DVec2::new(*xx, -yy))
        }
        (_, _, Some(_)) => return Err("its rows do not run from west to east; resample it with north up".into()),
        _ => return Ok(None),
    };
    if !(cell.is_finite() && origin.is_finite() && cell.min_element() > 0.0) {
        return Err(format!("its cells are {} x {}; both must be above 0, with north up", cell.x, cell.y));
    }
    // whole raster coordinates are at the corners of pixels, or at their centres if pixels are points
    let inset = if key(RASTER_TYPE) == Some(PIXEL_IS_POINT) { 1.0 } else { 0.0 };
    let half = (DVec2::new(columns.into(), rows.into()) - inset) / 2.0;
    let middle = origin + cell * half * DVec2::new(1.0, -1.0);
    Ok(Some(Georeference { cell, middle, in_degrees: key(MODEL_TYPE) == Some(GEOGRAPHIC) }))
}

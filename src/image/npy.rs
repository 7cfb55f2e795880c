//! NumPy's .npy arrays: <https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html>.

use std::fs::File;
use std::io::{self, BufReader, BufWriter, Read, Write};
use std::path::Path;

use glam::DAffine3;

use crate::image::file::whole::write_whole;
use crate::image::number::{Format, NumberType};
use crate::image::size::check_size;
use crate::input::{Error, Limits, Loading, Result};

/// A number of an array that is written.
pub trait NpyNumber {
    /// NumPy's name of the type: little-endian, kind, bytes.
    const TYPE: &'static str;

    fn put(&self, writer: &mut impl Write) -> io::Result<()>;
}

macro_rules! npy_number {
    ($($number:ident $name:literal),+) => {$(
        impl NpyNumber for $number {
            const TYPE: &'static str = $name;

            fn put(&self, writer: &mut impl Write) -> io::Result<()> {
                writer.write_all(&self.to_le_bytes())
            }
        }
    )+};
}
npy_number!(f32 "<f4", f64 "<f8", u32 "<u4");

/// Writes numbers in C order.
///
/// # Errors
/// [`Error::Work`] if `data` does not fill `shape`, [`Error::Write`] if `path` cannot be written.
pub fn write_npy<T: NpyNumber>(path: &Path, shape: &[u64], data: &[T]) -> Result<()> {
    let count = shape.iter().try_fold(1u64, |count, side| count.checked_mul(*side));
    if count != Some(data.len() as u64) {
        return Err(Error::work(format!("{}: {} numbers do not fill {shape:?}", path.display(), data.len())));
    }
    write_whole(path, |file| {
        let mut writer = BufWriter::new(file);
        put_npy(&mut writer, shape, data)?;
        writer.flush()
    })
}

/// As [`write_npy`], to a writer, which should be buffered.
///
/// # Errors
/// Those of the writer.
pub fn put_npy<T: NpyNumber>(mut writer: impl Write, shape: &[u64], data: &[T]) -> io::Result<()> {
    let sides: String = shape.iter().map(|side| format!("{side}, ")).collect();
    let mut header = format!("{{'descr': '{}', 'fortran_order': False, 'shape': ({sides}), }}", T::TYPE);
    // magic, version and the header's length take 10 bytes; numbers begin at a multiple of 64, after a line break
    let length = (10 + header.len() + 1).next_multiple_of(64) - 10;
    header.extend(std::iter::repeat_n(' ', length - 1 - header.len()));
    header.push('\n');
    let length = u16::try_from(length).map_err(io::Error::other)?;
    writer.write_all(b"\x93NUMPY\x01\x00")?;
    writer.write_all(&length.to_le_bytes())?;
    writer.write_all(header.as_bytes())?;
    data.iter().try_for_each(|number| number.put(&mut writer))
}

/// The header of an array that can be read.
#[derive(Debug, PartialEq)]
struct Header {
    shape: Vec<u64>,
    number: NumberType,
    big_endian: bool,
}

/// Why an array of whole numbers is not read where there should be others.
const WHOLE: &str = "they must be f4 or f8 (float32 or float64), or, of a volume, whole numbers of up to 4 bytes";

/// Reads an f32 or f64 array in C order, shape H x W x `N`, as width, height, and row by row `N` numbers each.
///
/// # Errors
/// What is wrong, without the file's name.
pub(super) fn read_npy_vectors<const N: usize>(
    file: File,
    limits: Limits,
) -> std::result::Result<(u32, u32, Vec<[f64; N]>), String> {
    let (shape, numbers) = read_array(file, limits, |shape| match *shape {
        [height, width, each] if each == N as u64 => {
            check_size(width, height).map_err(|e| e.to_string())?;
            Ok(width * height * each)
        }
        _ => Err(format!("the array's shape is {shape:?}; it must be height x width x {N}")),
    })?;
    // Both sides are far under 2^32 by the check above.
    Ok((shape[1] as u32, shape[0] as u32, in_rows(&numbers)))
}

/// Numbers as rows of `N`.
fn in_rows<const N: usize>(numbers: &[f64]) -> Vec<[f64; N]> {
    numbers.as_chunks().0.to_vec()
}

/// Most rows of [`read_npy_rows`]: their numbers' bytes cannot overflow.
const MAX_ROWS: u64 = 1 << 32;

/// Reads an f32 or f64 array in C order, shape N x `C`, row by row.
///
/// # Errors
/// [`Error::Missing`] or [`Error::Read`] if the file cannot be read; [`Error::Input`] naming it: another shape or type, or cut short.
pub fn read_npy_rows<const C: usize>(path: &Path, loading: &Loading) -> Result<Vec<[f64; C]>> {
    let (_, numbers) = read_npy_columns(path, &[C as u64], |_| Ok(()), loading)?;
    Ok(in_rows(&numbers))
}

/// Reads an f32 or f64 array in C order, shape N x C, of which C is one of `columns`: C, and the numbers row by row. `check` refuses a number of
/// rows before they are read.
///
/// # Errors
/// As [`read_npy_rows`], and the refusal by `check`.
pub fn read_npy_columns(
    path: &Path,
    columns: &[u64],
    check: impl FnOnce(u64) -> std::result::Result<(), String>,
    loading: &Loading,
) -> Result<(usize, Vec<f64>)> {
    let count = |shape: &[u64]| match *shape {
        [rows, own] if columns.contains(&own) && rows <= MAX_ROWS => check(rows).map(|()| rows * own),
        _ => {
            let known = columns.iter().map(|c| format!("N x {c}")).collect::<Vec<_>>().join(" or ");
            Err(format!("the array's shape is {shape:?}; it must be {known}"))
        }
    };
    let (shape, numbers) = of_file(path, loading, |file, limits| read_array(file, limits, count))?;
    // one of `columns` by the check above
    Ok((shape[1] as usize, numbers))
}

/// Numbers in a list, or in rows.
pub struct Grid {
    /// Width and height; `None` of a list.
    pub size: Option<(u32, u32)>,
    pub numbers: Vec<f64>,
}

/// Reads an f32 or f64 array in C order of shape N, or height x width.
///
/// # Errors
/// [`Error::Missing`] or [`Error::Read`] if the file cannot be read; [`Error::Input`] naming it: another shape or type, or it ends early.
pub fn read_npy_grid(path: &Path, loading: &Loading) -> Result<Grid> {
    let count = |shape: &[u64]| match *shape {
        [n] if (1..=MAX_ROWS).contains(&n) => Ok(n),
        [height, width] => check_size(width, height).map(|()| width * height).map_err(|e| e.to_string()),
        _ => Err(format!("the array's shape is {shape:?}; it must be N, or height x width")),
    };
    let (shape, numbers) = of_file(path, loading, |file, limits| read_array(file, limits, count))?;
    // both sides are far under 2^32 by the check above
    Ok(Grid { size: shape.get(1).map(|width| (*width as u32, shape[0] as u32)), numbers })
}

/// Reads an array of any [`NumberType`] in C order of three sides, 2 to `side_max` each, as f32.
///
/// # Errors
/// [`Error::Missing`] or [`Error::Read`] if the file cannot be read; [`Error::Input`] naming it: another shape or type, or it ends early.
pub fn read_npy_volume(path: &Path, side_max: u64, loading: &Loading) -> Result<([u64; 3], Vec<f32>)> {
    of_file(path, loading, |file, limits| volume_of(file, side_max, limits))
}

fn volume_of(file: File, side_max: u64, limits: Limits) -> std::result::Result<([u64; 3], Vec<f32>), String> {
    let count = |Header { shape, .. }: &Header| match shape[..] {
        [z, y, x] if [z, y, x].iter().all(|side| (2..=side_max).contains(side)) => Ok(z * y * x),
        _ => Err(format!("the array's shape is {shape:?}; it must have three sides of 2 to {side_max}")),
    };
    let (shape, numbers) = read_any(file, limits, count, ["a volume", "use a coarser one"], |number| number as f32)?;
    Ok(([shape[0], shape[1], shape[2]], numbers))
}

/// Reads matrices, row by row, from an f32 or f64 array in C order of shape N x 3 x 4, or N x 4 x 4 with the last row 0, 0, 0, 1.
///
/// # Errors
/// [`Error::Missing`] or [`Error::Read`] if the file cannot be read; [`Error::Input`] naming it: another shape or type, it ends early, or a fourth row is another.
pub fn read_npy_affines(path: &Path, loading: &Loading) -> Result<Vec<DAffine3>> {
    of_file(path, loading, affines_of)
}

/// The value that `read` makes of a file, and errors that name it.
pub(super) fn of_file<T>(
    path: &Path,
    loading: &Loading,
    read: impl FnOnce(File, Limits) -> std::result::Result<T, String>,
) -> Result<T> {
    let file = loading.open(path).map_err(|e| Error::unreadable(path, format_args!("{e}; check the path")))?;
    read(file, loading.limits()).map_err(|why| Error::input(format!("{}: {why}", path.display())))
}

fn affines_of(file: File, limits: Limits) -> std::result::Result<Vec<DAffine3>, String> {
    let (shape, numbers) = read_array(file, limits, |shape| match *shape {
        [n, rows @ (3 | 4), 4] if n <= MAX_ROWS => Ok(n * rows * 4),
        _ => Err(format!("the array's shape is {shape:?}; it must be N x 4 x 4 or N x 3 x 4")),
    })?;
    let matrix = |(k, m): (usize, &[f64])| {
        if m.len() == 16 && m[12..] != [0.0, 0.0, 0.0, 1.0] {
            return Err(format!("matrix {k}: the last row must be 0, 0, 0, 1; the translation is the last column"));
        }
        Ok(DAffine3::from_cols_array(&std::array::from_fn(|i| m[4 * (i % 3) + i / 3])))
    };
    // chunks of 12 or 16 numbers, by the check above
    numbers.chunks_exact(4 * shape[1] as usize).enumerate().map(matrix).collect()
}

/// The shape of an array of f32 or f64 and its numbers, as many as `count` makes of the shape.
fn read_array(
    file: File,
    limits: Limits,
    count: impl FnOnce(&[u64]) -> std::result::Result<u64, String>,
) -> std::result::Result<(Vec<u64>, Vec<f64>), String> {
    let count = |header: &Header| match header.number.is_whole() {
        true => Err(format!("the numbers are whole, of {} bytes; {WHOLE}", header.number.size())),
        false => count(&header.shape),
    };
    read_any(file, limits, count, ["an array", "use a smaller one"], |number| number)
}

/// The shape of an array and its numbers, as many as `count` makes of the header, each after `of`. `what` and `advice` are for the error of too
/// little memory.
fn read_any<T>(
    file: File,
    limits: Limits,
    count: impl FnOnce(&Header) -> std::result::Result<u64, String>,
    [what, advice]: [&str; 2],
    of: impl Fn(f64) -> T,
) -> std::result::Result<(Vec<u64>, Vec<T>), String> {
    let bytes_in_file = file.metadata().map_err(|e| e.to_string())?.len();
    let mut reader = BufReader::with_capacity(1 << 16, file);
    let (header, header_bytes) = read_header(&mut reader)?;
    let count = count(&header)?;
    check_length(&header, count, bytes_in_file, header_bytes)?;
    let memory = size_of::<T>() as u64 * count;
    limits.check_memory(memory, format_args!("{what} of {count} numbers"), advice).map_err(|e| e.to_string())?;
    let number = |bytes: &[u8]| of(header.number.read(bytes, header.big_endian));
    let numbers = read_numbers(&mut reader, header.number.size(), count as usize, number)?;
    Ok((header.shape, numbers))
}

/// A file that holds so many numbers is long enough.
fn check_length(header: &Header, count: u64, in_file: u64, in_header: u64) -> std::result::Result<(), String> {
    let bytes = count * header.number.size() as u64;
    match in_file < in_header + bytes {
        true => Err(format!("the file ends early: {bytes} bytes of numbers are promised; write it again")),
        false => Ok(()),
    }
}

/// Reads `count` numbers of `size` bytes; that many are known to be in the file.
fn read_numbers<T>(
    reader: &mut impl Read,
    size: usize,
    count: usize,
    number: impl Fn(&[u8]) -> T,
) -> std::result::Result<Vec<T>, String> {
    let mut numbers = Vec::with_capacity(count);
    let mut bytes = vec![0; size * 3 * 1024];
    while numbers.len() < count {
        let part = (size * (count - numbers.len())).min(bytes.len());
        reader.read_exact(&mut bytes[..part]).map_err(|e| e.to_string())?;
        numbers.extend(bytes[..part].chunks_exact(size).map(&number));
    }
    Ok(numbers)
}

/// NumPy's own limit on the header's text, bytes.
const MAX_HEADER: usize = 10_000;

/// Reads the magic number, the version and the header's text; also returns how many bytes these took.
fn read_header(reader: &mut impl Read) -> std::result::Result<(Header, u64), String> {
    let damaged = |_: io::Error| "the .npy header is damaged or cut short; write the file again".to_string();
    let mut start = [0; 8];
    reader.read_exact(&mut start).map_err(damaged)?;
    if &start[..6] != b"\x93NUMPY" {
        return Err("this is not a .npy file; write it with numpy.save".into());
    }
    let mut length = [0; 4];
    let length_bytes = match start[6] {
        1 => 2,
        2 | 3 => 4,
        version => return Err(format!("version {version} of .npy is not known; write version 1, 2 or 3")),
    };
    reader.read_exact(&mut length[..length_bytes]).map_err(damaged)?;
    let length = u32::from_le_bytes(length) as usize;
    if length > MAX_HEADER {
        return Err(format!("the .npy header of {length} bytes is over the limit of {MAX_HEADER}"));
    }
    let mut text = vec![0; length];
    reader.read_exact(&mut text).map_err(damaged)?;
    let header = parse_header(&String::from_utf8_lossy(&text))?;
    Ok((header, (start.len() + length_bytes + length) as u64))
}

/// Reads the header's text, a Python dictionary of exactly three known keys, for plain arrays.
/// (A general parser of Python literals would recurse as deep as a hostile header asks.)
fn parse_header(text: &str) -> std::result::Result<Header, String> {
    let value = |key: &str| {
        let after = |quote: char| text.split_once(&format!("{quote}{key}{quote}")).map(|(_, after)| after);
        let after = after('\'').or_else(|| after('"')).and_then(|after| after.trim_start().strip_prefix(':'));
        after.map(str::trim_start).ok_or(format!("the .npy header has no {key}; write the file with numpy.save"))
    };
    let descr = value("descr")?;
    let dtype = descr.trim_start_matches(['\'', '"']).split(['\'', '"', ',', ']']).next().unwrap_or_default();
    let native_big = cfg!(target_endian = "big");
    let (order, kind) = dtype.split_at_checked(1).unwrap_or_default();
    let other = || format!("the numbers are of type {dtype:?}; {WHOLE}");
    let number = NumberType::named(kind, Format::Npy).ok_or_else(other)?;
    let big_endian = match order {
        "<" => false,
        ">" => true,
        "=" => native_big,
        "|" if number.size() == 1 => false,
        _ => return Err(other()),
    };
    if !value("fortran_order")?.starts_with("False") {
        return Err("the array is in Fortran order; save numpy.ascontiguousarray of it".into());
    }
    let shape = value("shape")?;
    let inside = shape.strip_prefix('(').and_then(|s| s.split_once(')')).map(|(inside, _)| inside);
    let sides = inside.unwrap_or("?").split(',').map(str::trim).filter(|side| !side.is_empty());
    let shape: std::result::Result<_, _> = sides.map(|side| side.trim_end_matches('L').parse()).collect();
    let shape = shape.map_err(|_| "the .npy header's shape cannot be read; write the file again".to_string())?;
    Ok(Header { shape, number, big_endian })
}

#[cfg(test)]
mod tests {
    use super::*;
    use npyz::WriterBuilder;

    fn parse(descr: &str, order: &str, shape: &str) -> std::result::Result<Header, String> {
        parse_header(&format!("{{'descr': {descr}, 'fortran_order': {order}, 'shape': {shape}, }}   \n"))
    }

    #[test]
    fn headers_of_plain_float_arrays_are_read() {
        let header = |shape: &[u64], number, big_endian| Ok(Header { shape: shape.into(), number, big_endian });
        assert_eq!(parse("'<f8'", "False", "(2, 3, 3)"), header(&[2, 3, 3], NumberType::F64, false));
        assert_eq!(parse("'>f4'", "False", "(5,)"), header(&[5], NumberType::F32, true));
        assert_eq!(parse("'<f4'", "False", "()"), header(&[], NumberType::F32, false));
        assert_eq!(parse("'<f4'", "False", "(2L, 3L)"), header(&[2, 3], NumberType::F32, false));
    }

    #[test]
    fn other_headers_say_what_is_wrong() {
        for (descr, order, shape, why) in [
            ("'<i8'", "False", "(1, 1, 3)", "type \"<i8\""),
            ("'|f4'", "False", "(1, 1, 3)", "type \"|f4\""),
            ("'<f2'", "False", "(1, 1, 3)", "type \"<f2\""),
            ("[('x', '<f4')]", "False", "(1, 1, 3)", "must be f4 or f8"),
            ("'<f4'", "True", "(1, 1, 3)", "Fortran order"),
            ("'<f4'", "False", "(1, -1, 3)", "shape cannot be read"),
            ("'<f4'", "False", "(1, 1, 3", "shape cannot be read"),
            ("'<f4'", "False", "(99999999999999999999, 1, 3)", "shape cannot be read"),
        ] {
            let got = parse(descr, order, shape).unwrap_err();
            assert!(got.contains(why), "{got}");
        }
        assert!(parse_header("{}").unwrap_err().contains("has no descr"));
    }

    #[test]
    fn whole_numbers_are_read_too() {
        let read = |descr: &str| parse(descr, "False", "(2, 2, 2)").map(|h| (h.number, h.big_endian));
        assert_eq!(read("'|u1'"), Ok((NumberType::U8, false)));
        assert_eq!(read("'|i1'"), Ok((NumberType::I8, false)));
        assert_eq!(["'<u2'", "'>u2'"].map(read), [false, true].map(|big| Ok((NumberType::U16, big))));
        assert_eq!(["'<i2'", "'>i4'"].map(read), [Ok((NumberType::I16, false)), Ok((NumberType::I32, true))]);
    }

    #[test]
    fn written_arrays_are_what_npyz_reads() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.npy");
        let data: Vec<f64> = vec![0.0, -0.0, f64::INFINITY, f64::NAN, 1e-310, 1.0 / 3.0];
        write_npy(&path, &[2, 1, 3], &data).unwrap();
        let array = npyz::NpyFile::new(File::open(&path).unwrap()).unwrap();
        assert_eq!((array.shape(), array.order()), (&[2, 1, 3][..], npyz::Order::C));
        let back = array.into_vec::<f64>().unwrap();
        assert!(back.iter().zip(&data).all(|(a, b)| a.to_bits() == b.to_bits()));
        assert!(matches!(write_npy(&path, &[2, 3], &data[1..]), Err(Error::Work(_))));
    }

    #[test]
    fn bytes_are_those_that_npyz_writes() {
        fn check<T: NpyNumber + npyz::AutoSerialize>(shape: &[u64], data: &[T]) {
            let (mut ours, mut theirs) = (Vec::new(), Vec::new());
            put_npy(&mut ours, shape, data).unwrap();
            let mut array =
                npyz::WriteOptions::new().default_dtype().shape(shape).writer(&mut theirs).begin_nd().unwrap();
            array.extend(data).unwrap();
            array.finish().unwrap();
            assert_eq!(ours, theirs, "{shape:?}");
        }
        // headers of all lengths modulo 64
        for sides in 0..40 {
            check::<f64>(&[&vec![1; sides][..], &[0]].concat(), &[]);
        }
        check(&[2, 1, 2], &[0.1f64, -0.0, 1e-310, f64::INFINITY]);
        check(&[3], &[0.1f32, -0.0, 3e38]);
        check(&[1, 2], &[7u32, u32::MAX]);
    }
}

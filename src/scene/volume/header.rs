//! Volumes whose files say themselves how many numbers they hold, of which type, and where they lie: NRRD (.nrrd, .nhdr;
//! teem.sourceforge.net/nrrd/format.html) and MetaImage (.mhd, .mha; of ITK).

use super::SIDE_MAX;
use super::load::{Numbers, RawGrid, check_length, read_numbers};
use super::spec::Placement;
use crate::image::{NumberFormat, NumberType};
use crate::input::{Error, Limits, Loading, Result, files};
use flate2::read::{GzDecoder, ZlibDecoder};
use glam::DVec3;
use std::fs::File;
use std::io::{BufRead, BufReader, Read, Seek, SeekFrom};
use std::path::Path;

/// Most bytes of a header, far more than any has.
const HEADER_MAX: u64 = 1 << 16;

/// What a header says.
#[derive(Debug)]
struct Header {
    grid: RawGrid,
    /// If its axes are those of the world.
    placement: Option<Placement>,
    packing: Packing,
    /// The file of the numbers, relative to the header's folder; `None`: they follow the header.
    file: Option<String>,
    /// Bytes before the numbers; `None`: they are the last ones of their file.
    skip: Option<u64>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Packing {
    None,
    Gzip,
    Zlib,
}

/// The lines of a header: what is set, and to what.
type Entries = Vec<(String, String)>;

/// The value of the first entry that has one of these names.
fn value<'a>(entries: &'a Entries, names: &[&str]) -> Option<&'a str> {
    entries.iter().find(|(key, _)| names.contains(&key.as_str())).map(|(_, value)| value.as_str())
}

type Parsed<T> = std::result::Result<T, String>;

/// The numbers of such a file, and where they lie if the header says so of the world's axes.
///
/// # Errors
/// [`Error::Missing`] or [`Error::Read`] if a file cannot be read; [`Error::Input`] naming the header.
pub fn read_headed(path: &Path, loading: &Loading) -> Result<Numbers> {
    let wrong = |why: String| Error::input(format!("{}: {why}", path.display()));
    let unreadable = |path: &Path, e: std::io::Error| Error::unreadable(path, format_args!("{e}; check the path"));
    let mut reader = BufReader::new(loading.open(path).map_err(|e| unreadable(path, e))?);
    let is_nrrd = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("nrrd") || e.eq_ignore_ascii_case("nhdr"));
    let header = if is_nrrd { nrrd(&mut reader) } else { meta(&mut reader) }.map_err(wrong)?;
    let mut data = match &header.file {
        None => reader,
        Some(name) => {
            let folder = path.parent().unwrap_or(Path::new(""));
            if !files::is_below(name, folder) {
                return Err(wrong(format!("{name:?} is outside of the header's folder; move it there")));
            }
            let file = folder.join(name);
            BufReader::new(loading.open(&file).map_err(|e| unreadable(&file, e))?)
        }
    };
    match header.skip {
        Some(bytes) => data.seek_relative(bytes as i64),
        None => data.seek(SeekFrom::End(-(header.grid.bytes() as i64))).map(drop),
    }
    .map_err(|e| wrong(format!("the numbers are not where the header says: {e}")))?;
    let (grid, limits) = (&header.grid, loading.limits());
    let values = match header.packing {
        Packing::None => bytes_left(&mut data)
            .map_err(|e| wrong(e.to_string()))
            .and_then(|left| check_length(left, grid))
            .and_then(|()| read_numbers(&mut data, grid, limits)),
        Packing::Gzip => read_packed(&mut GzDecoder::new(data), grid, limits),
        Packing::Zlib => read_packed(&mut ZlibDecoder::new(data), grid, limits),
    };
    let values = values.map_err(|e| e.at(path.display()))?;
    Ok(Numbers { shape: header.grid.shape, values, placement: header.placement })
}

/// The bytes of a file from where it is read on.
fn bytes_left(data: &mut BufReader<File>) -> std::io::Result<u64> {
    Ok(data.get_ref().metadata()?.len().saturating_sub(data.stream_position()?))
}

/// Reads numbers from a decoder, and on to where it compares its checksum, which lies behind them.
fn read_packed(decoder: &mut impl Read, grid: &RawGrid, limits: Limits) -> Result<Vec<f32>> {
    let values = read_numbers(decoder, grid, limits)?;
    match std::io::copy(&mut decoder.take(1), &mut std::io::sink()) {
        Err(e) => Err(Error::input(format!("the end of the numbers: {e}; is the file cut short or damaged?"))),
        Ok(_) => Ok(values),
    }
}

/// The next line without its end; `None` after the last one, or where a header is over its limit.
fn line(reader: &mut impl BufRead, left: &mut u64) -> Parsed<Option<String>> {
    let mut bytes = Vec::new();
    let read = reader.by_ref().take(*left).read_until(b'\n', &mut bytes).map_err(|e| e.to_string())? as u64;
    *left -= read;
    if *left == 0 {
        return Err(format!("the header is over {HEADER_MAX} bytes; is the file damaged?"));
    }
    let text = String::from_utf8_lossy(&bytes);
    Ok((read > 0).then(|| text.trim_end_matches(['\n', '\r']).to_owned()))
}

fn nrrd(reader: &mut impl BufRead) -> Parsed<Header> {
    let mut left = HEADER_MAX;
    if !line(reader, &mut left)?.is_some_and(|magic| magic.starts_with("NRRD000")) {
        return Err("the file does not begin with NRRD000 and a digit; is it a NRRD?".into());
    }
    let mut entries = Entries::new();
    // an empty line ends the header
    while let Some(line) = line(reader, &mut left)?.filter(|line| !line.is_empty()) {
        // KEY:=VALUE is for programs
        if let Some((key, value)) = line.split_once(": ").filter(|_| !line.starts_with('#')) {
            entries.push((key.to_lowercase(), value.trim().to_owned()));
        }
    }
    let value = |names: &[&str]| value(&entries, names);
    three(value(&["dimension"]), "dimension")?;
    let kind = value(&["type"]).ok_or("the header has no type")?;
    let number = NumberType::named(kind, NumberFormat::Nrrd)
        .ok_or_else(|| format!("numbers of type {kind:?} are not read; save them as float, short or uchar"))?;
    let packing = match value(&["encoding"]).ok_or("the header has no encoding")? {
        "raw" => Packing::None,
        "gzip" | "gz" => Packing::Gzip,
        other => return Err(format!("the encoding {other:?} is not read; save it as raw or gzip")),
    };
    let big_endian = match value(&["endian"]) {
        Some("big") => true,
        Some("little") => false,
        None if number.size() == 1 => false,
        _ => return Err("the header does not say whether endian is little or big".into()),
    };
    if value(&["line skip", "lineskip"]).is_some_and(|lines| lines != "0") {
        return Err("line skip is not supported; save the numbers without a text before them".into());
    }
    let skip = match value(&["byte skip", "byteskip"]).unwrap_or("0") {
        "-1" if packing == Packing::None => None,
        bytes => {
            let bytes: u32 =
                bytes.parse().map_err(|_| format!("byte skip is {bytes:?}, which is no number of bytes"))?;
            Some(bytes.into())
        }
    };
    let file = value(&["data file", "datafile"]);
    if file.is_some_and(|name| name.starts_with("LIST") || name.contains('%')) {
        return Err("the numbers lie in several files; save them in one".into());
    }
    let spacing = match (value(&["space directions"]), value(&["spacings"])) {
        (Some(axes), _) => diagonal(&numbers(&axes.replace(['(', ')', ','], " "))),
        (None, Some(steps)) => <[f64; 3]>::try_from(numbers(steps)).ok(),
        (None, None) => None,
    };
    let origin = value(&["space origin"]).map_or(vec![0.0; 3], |text| numbers(&text.replace(['(', ')', ','], " ")));
    Ok(Header {
        grid: RawGrid { shape: shape(value(&["sizes"]), "sizes")?, number, big_endian },
        placement: placement(origin, spacing),
        packing,
        file: file.map(str::to_owned),
        skip,
    })
}

fn meta(reader: &mut impl BufRead) -> Parsed<Header> {
    let mut left = HEADER_MAX;
    let mut entries = Entries::new();
    // ElementDataFile is the last key
    while entries.last().is_none_or(|(key, _)| key != "ElementDataFile") {
        let line = line(reader, &mut left)?.ok_or("the header has no ElementDataFile; is it a MetaImage?")?;
        if let Some((key, value)) = line.split_once('=') {
            entries.push((key.trim().to_owned(), value.trim().to_owned()));
        }
    }
    let value = |names: &[&str]| value(&entries, names);
    let is = |names: &[&str]| value(names).is_some_and(|text| text.eq_ignore_ascii_case("true"));
    three(value(&["NDims"]), "NDims")?;
    if value(&["ElementNumberOfChannels"]).is_some_and(|n| n != "1") {
        return Err("there are several numbers at each node; save one".into());
    }
    if value(&["HeaderSize"]).is_some_and(|n| n != "0") {
        return Err("HeaderSize is not supported; save the numbers without a header of their own".into());
    }
    let kind = value(&["ElementType"]).ok_or("the header has no ElementType")?;
    let number = NumberType::named(kind, NumberFormat::MetaImage)
        .ok_or_else(|| format!("numbers of type {kind:?} are not read; save them as MET_FLOAT or MET_SHORT"))?;
    let matrix = value(&["TransformMatrix", "Rotation", "Orientation"]).map(numbers);
    let is_turned = matrix.is_some_and(|m| m != [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]);
    let steps = value(&["ElementSpacing", "ElementSize"]).filter(|_| !is_turned).map(numbers);
    let origin = value(&["Offset", "Origin", "Position"]).map_or(vec![0.0; 3], numbers);
    Ok(Header {
        grid: RawGrid {
            shape: shape(value(&["DimSize"]), "DimSize")?,
            number,
            big_endian: is(&["BinaryDataByteOrderMSB", "ElementByteOrderMSB"]),
        },
        placement: placement(origin, steps.and_then(|steps| steps.try_into().ok())),
        packing: if is(&["CompressedData"]) { Packing::Zlib } else { Packing::None },
        file: value(&["ElementDataFile"]).filter(|name| *name != "LOCAL").map(str::to_owned),
        skip: Some(0),
    })
}

fn three(dimension: Option<&str>, key: &str) -> Parsed<()> {
    match dimension {
        Some("3") => Ok(()),
        Some(other) => Err(format!("{key} is {other}; a volume has 3, with one number at each node")),
        None => Err(format!("the header has no {key}")),
    }
}

/// As many as along z, y and x, of a list along x, y and z.
fn shape(sizes: Option<&str>, key: &str) -> Parsed<[u64; 3]> {
    let sizes = sizes.ok_or(format!("the header has no {key}"))?;
    let read: Option<Vec<u64>> = sizes.split_whitespace().map(|size| size.parse().ok()).collect();
    match read.as_deref() {
        Some(&[x, y, z]) if [x, y, z].iter().all(|side| (2..=SIDE_MAX).contains(side)) => Ok([z, y, x]),
        _ => Err(format!("{key} is {sizes:?}; it must be three numbers of 2 to {SIDE_MAX}")),
    }
}

/// What is no number is NaN.
fn numbers(text: &str) -> Vec<f64> {
    text.split_whitespace().map(|word| word.parse().unwrap_or(f64::NAN)).collect()
}

/// The steps along three axes, if these are the world's.
fn diagonal(axes: &[f64]) -> Option<[f64; 3]> {
    let is_straight = axes.iter().enumerate().all(|(k, &x)| k % 4 == 0 || x == 0.0);
    match *axes {
        [x, _, _, _, y, _, _, _, z] if is_straight => Some([x, y, z]),
        _ => None,
    }
}

fn placement(origin: Vec<f64>, spacing: Option<[f64; 3]>) -> Option<Placement> {
    let origin = DVec3::from(<[f64; 3]>::try_from(origin).ok()?);
    let spacing = DVec3::from(spacing?);
    (origin.is_finite() && spacing.cmpgt(DVec3::ZERO).all() && spacing.is_finite())
        .then_some(Placement::Nodes { origin, spacing })
}

#[cfg(test)]
mod tests {
    use super::*;
    use flate2::Compression;
    use flate2::read::{GzEncoder, ZlibEncoder};

    /// Of 4 x 3 x 2 nodes.
    const NUMBERS: [i16; 24] =
        [-1024, -3, 0, 5, 60, 700, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 20, 21, 22, 23, 24, 3071];

    fn bytes(big_endian: bool) -> Vec<u8> {
        NUMBERS.iter().flat_map(|n| if big_endian { n.to_be_bytes() } else { n.to_le_bytes() }).collect()
    }

    fn packed(mut encoder: impl Read) -> Vec<u8> {
        let mut packed = Vec::new();
        encoder.read_to_end(&mut packed).unwrap();
        packed
    }

    /// Reads a header with these bytes behind it, in a folder with a file of the numbers.
    fn read(name: &str, header: &str, behind: &[u8]) -> Result<Numbers> {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("numbers.bin"), bytes(true)).unwrap();
        std::fs::write(folder.path().join("late.bin"), [&[7; 5], &bytes(true)[..]].concat()).unwrap();
        let path = folder.path().join(name);
        std::fs::write(&path, [header.as_bytes(), behind].concat()).unwrap();
        read_headed(&path, &Loading::default())
    }

    const NRRD: &str =
        "NRRD0004\n# a comment: of nobody\ntype: short\ndimension: 3\nsizes: 4 3 2\nnote:=of: a program\n";
    const META: &str = "ObjectType = Image\nNDims = 3\nDimSize = 4 3 2\nElementType = MET_SHORT\n";

    #[test]
    fn numbers_are_those_that_were_written() {
        let gzip = packed(GzEncoder::new(&bytes(false)[..], Compression::default()));
        let zlib = packed(ZlibEncoder::new(&bytes(true)[..], Compression::default()));
        let local = "ElementDataFile = LOCAL\n";
        for (name, header, behind) in [
            ("a.nrrd", format!("{NRRD}encoding: raw\nendian: little\n\n"), bytes(false)),
            ("b.nrrd", format!("{NRRD}encoding: raw\nendian: big\n\n"), bytes(true)),
            ("c.NRRD", format!("{NRRD}encoding: gzip\nendian: little\n\n"), gzip),
            ("d.nhdr", format!("{NRRD}encoding: raw\nendian: big\ndata file: numbers.bin\n"), Vec::new()),
            ("e.nhdr", format!("{NRRD}encoding: raw\nendian: big\nbyte skip: 5\ndata file: ./late.bin\n"), Vec::new()),
            ("f.nhdr", format!("{NRRD}encoding: raw\nendian: big\nbyteskip: -1\ndatafile: late.bin\n"), Vec::new()),
            ("g.mhd", format!("{META}BinaryDataByteOrderMSB = True\nElementDataFile = numbers.bin\n"), Vec::new()),
            ("h.mha", format!("{META}{local}"), bytes(false)),
            ("i.mha", format!("{META}ElementByteOrderMSB = true\nCompressedData = True\n{local}"), zlib),
        ] {
            let Numbers { shape, values, .. } = read(name, &header, &behind).unwrap();
            assert_eq!((shape, values), ([2, 3, 4], NUMBERS.map(f32::from).to_vec()), "{name}");
        }
    }

    #[test]
    fn a_checksum_that_is_cut_or_wrong_is_noticed() {
        let gzip = packed(GzEncoder::new(&bytes(false)[..], Compression::default()));
        let zlib = packed(ZlibEncoder::new(&bytes(false)[..], Compression::default()));
        let nrrd = format!("{NRRD}encoding: gzip\nendian: little\n\n");
        let meta = format!("{META}CompressedData = True\nElementDataFile = LOCAL\n");
        // a trailer is a checksum of four bytes, and of gzip the length in four more
        for (name, header, packed, trailer) in [("a.nrrd", nrrd, gzip, 8), ("a.mha", meta, zlib, 4)] {
            read(name, &header, &packed).unwrap();
            for cut in 1..=trailer {
                let error = read(name, &header, &packed[..packed.len() - cut]).err().unwrap().to_string();
                assert!(error.contains("cut short or damaged") && !error.contains('\n'), "{name}, {cut}: {error}");
            }
            let mut wrong = packed.clone();
            wrong[packed.len() - trailer] ^= 1;
            assert!(read(name, &header, &wrong).is_err(), "{name}");
        }
    }

    #[test]
    fn places_are_read_where_axes_are_the_worlds() {
        let at = |origin: [f64; 3], spacing: [f64; 3]| {
            Some(Placement::Nodes { origin: origin.into(), spacing: spacing.into() })
        };
        let raw = "encoding: raw\nendian: little\n";
        let local = "ElementDataFile = LOCAL\n";
        for (name, header, expected) in [
            ("a.nrrd", format!("{NRRD}{raw}spacings: 0.5 1 2\n\n"), at([0.0; 3], [0.5, 1.0, 2.0])),
            (
                "b.nrrd",
                format!("{NRRD}{raw}space directions: (0.5,0,0) (0,1,0) (0,0,2)\nspace origin: (-1, 2,3)\n\n"),
                at([-1.0, 2.0, 3.0], [0.5, 1.0, 2.0]),
            ),
            ("c.nrrd", format!("{NRRD}{raw}space directions: (0,1,0) (1,0,0) (0,0,2)\n\n"), None),
            ("d.nrrd", format!("{NRRD}{raw}spacings: 0.5 nan 2\n\n"), None),
            ("e.nrrd", format!("{NRRD}{raw}\n"), None),
            (
                "f.mha",
                format!("{META}ElementSpacing = 0.5 1 2\nOffset = 4 5 6\n{local}"),
                at([4.0, 5.0, 6.0], [0.5, 1.0, 2.0]),
            ),
            ("g.mha", format!("{META}ElementSpacing = 1 1 1\nTransformMatrix = 0 1 0 1 0 0 0 0 1\n{local}"), None),
        ] {
            assert_eq!(read(name, &header, &bytes(false)).unwrap().placement, expected, "{name}");
        }
    }

    #[test]
    fn what_is_wrong_is_said_in_one_line() {
        let raw = "encoding: raw\nendian: little\n";
        for (name, header, why) in [
            ("a.nrrd", "JRRD0004\n\n".into(), "does not begin with NRRD000"),
            ("a.nrrd", NRRD.replace("short", "block") + raw + "\n", "type \"block\""),
            ("a.nrrd", NRRD.replace("dimension: 3", "dimension: 4") + raw + "\n", "dimension is 4"),
            ("a.nrrd", NRRD.replace("4 3 2", "4 3 99999999999") + raw + "\n", "three numbers of 2 to 4096"),
            ("a.nrrd", NRRD.replace("4 3 2", "4 3 1") + raw + "\n", "three numbers of 2 to 4096"),
            ("a.nrrd", NRRD.replace("4 3 2", "4 3 3") + raw + "\n", "ends early: 48 bytes of numbers, 72"),
            ("a.nrrd", format!("{NRRD}encoding: bzip2\n\n"), "encoding \"bzip2\""),
            ("a.nrrd", format!("{NRRD}encoding: raw\n\n"), "little or big"),
            ("a.nrrd", format!("{NRRD}{raw}byte skip: 99\n\n"), "ends early"),
            ("a.nrrd", format!("{NRRD}{raw}byte skip: 99999999999999999999\n\n"), "no number of bytes"),
            ("a.nhdr", format!("{NRRD}{raw}data file: ../numbers.bin\n"), "outside of the header's folder"),
            ("a.nhdr", format!("{NRRD}{raw}data file: none.bin\n"), "none.bin"),
            ("a.nhdr", format!("{NRRD}{raw}data file: LIST\n"), "several files"),
            ("a.mhd", META.into(), "no ElementDataFile"),
            ("a.mha", META.replace("MET_SHORT", "MET_LONG") + "ElementDataFile = LOCAL\n", "\"MET_LONG\""),
            ("a.mha", format!("{META}CompressedData = True\nElementDataFile = LOCAL\n"), "the numbers: "),
            ("a.mha", "x".repeat(1 << 17), "over 65536 bytes"),
        ] {
            let got = read(name, &header, &bytes(false)).err().unwrap().to_string();
            assert!(got.contains(why) && got.lines().count() == 1, "{name}: {got}");
        }
    }
}

//! ESRI ASCII grids: <https://desktop.arcgis.com/en/arcmap/latest/manage-data/raster-and-images/esri-ascii-raster-format.htm>.

use super::{Georeference, Grid, check_sides};
use glam::DVec2;
use std::iter::Peekable;

/// The values in the header.
#[derive(Default)]
struct Header {
    columns: Option<u64>,
    rows: Option<u64>,
    /// Easting and northing of the lower left cell; `true`: of its centre, `false`: of its corner.
    lower_left: [Option<(f64, bool)>; 2],
    /// Size to the east and to the south.
    cell: [Option<f64>; 2],
    no_data: Option<f64>,
}

/// The value for no data if the header has none.
const NO_DATA: f64 = -9999.0;

/// Reads a header of lines `KEY VALUE`, then the heights, row by row from the north.
///
/// # Errors
/// What is wrong, without the name of the file.
pub fn read(bytes: &[u8]) -> Result<Grid, String> {
    let text = std::str::from_utf8(bytes).map_err(|_| "is no ASCII grid: it is not text".to_string())?;
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut lines = text.lines().enumerate().peekable();
    let header = Header::read(&mut lines)?;
    let [columns, rows] = header.sides(bytes.len() as u64)?;
    let expected = columns * rows;
    let no_data = header.no_data.unwrap_or(NO_DATA);
    let mut samples = Vec::with_capacity(expected as usize);
    for (k, line) in lines {
        for word in line.split_ascii_whitespace() {
            let height = number(word).map_err(|why| format!("line {}: {why}", k + 1))?;
            samples.push(if height == no_data || !height.is_finite() { f64::NAN } else { height });
        }
        if samples.len() as u64 > expected {
            return Err(format!("line {}: more than the {columns} x {rows} heights of the header", k + 1));
        }
    }
    if (samples.len() as u64) < expected {
        return Err(format!("ends early: the header says {columns} x {rows} heights, found {}", samples.len()));
    }
    let (columns, rows) = (columns as usize, rows as usize);
    Ok(Grid { columns, rows, samples, georeference: header.georeference(columns, rows)? })
}

/// Refuses a file by its first bytes and its length: a header that promises more heights than are there.
///
/// # Errors
/// Those of [`read`].
pub fn check_start(bytes: &[u8], length: u64) -> Result<(), String> {
    let text = String::from_utf8_lossy(bytes);
    let mut lines = text.strip_prefix('\u{feff}').unwrap_or(&text).lines().enumerate().peekable();
    let header = Header::read(&mut lines)?;
    // the header is whole where heights follow it
    if lines.peek().is_some() { header.sides(length).map(drop) } else { Ok(()) }
}

/// Lines of heights do, also with NaN; lines of the header start with a key.
fn starts_with_number(line: &str) -> bool {
    line.split_ascii_whitespace().next().is_some_and(|word| word.parse::<f64>().is_ok())
}

fn number(word: &str) -> Result<f64, String> {
    word.parse().map_err(|_| format!("expected a number, found {:?}", shortened(word)))
}

fn shortened(text: &str) -> String {
    text.chars().take(40).collect()
}

impl Header {
    fn read<'a>(lines: &mut Peekable<impl Iterator<Item = (usize, &'a str)>>) -> Result<Header, String> {
        let mut header = Header::default();
        while let Some((k, line)) = lines.next_if(|(_, line)| !starts_with_number(line)) {
            header.read_line(line).map_err(|why| format!("line {}: {why}", k + 1))?;
        }
        Ok(header)
    }

    /// Columns and rows, whose heights a file of `length` bytes may hold.
    fn sides(&self, length: u64) -> Result<[u64; 2], String> {
        let missing = |key: &str| format!("is no ASCII grid: {key} is missing at its beginning");
        let columns = self.columns.ok_or_else(|| missing("ncols"))?;
        let rows = self.rows.ok_or_else(|| missing("nrows"))?;
        check_sides(columns, rows)?;
        // a height and the space after it take at least two bytes
        if (columns * rows).saturating_sub(1) > length / 2 {
            return Err(format!("ends early: the header says {columns} x {rows} heights"));
        }
        Ok([columns, rows])
    }

    fn read_line(&mut self, line: &str) -> Result<(), String> {
        let mut words = line.split_ascii_whitespace();
        let Some(key) = words.next() else { return Ok(()) };
        let (Some(word), None) = (words.next(), words.next()) else {
            return Err(format!("expected a key and its number, as in \"ncols 240\", found {:?}", shortened(line)));
        };
        let whole = || word.parse().map_err(|_| format!("{key}: expected a whole number, found {word:?}"));
        let length = || match number(word)? {
            length if length > 0.0 && length.is_finite() => Ok(length),
            length => Err(format!("{key}: {length} is not a size; it must be above 0")),
        };
        match key.to_ascii_lowercase().as_str() {
            "ncols" => self.columns = Some(whole()?),
            "nrows" => self.rows = Some(whole()?),
            "xllcorner" => self.lower_left[0] = Some((number(word)?, false)),
            "yllcorner" => self.lower_left[1] = Some((number(word)?, false)),
            "xllcenter" => self.lower_left[0] = Some((number(word)?, true)),
            "yllcenter" => self.lower_left[1] = Some((number(word)?, true)),
            "cellsize" => self.cell = [Some(length()?); 2],
            // GDAL writes these for cells that are not square
            "dx" => self.cell[0] = Some(length()?),
            "dy" => self.cell[1] = Some(length()?),
            "nodata_value" => self.no_data = Some(number(word)?),
            _ => return Err(format!("unknown key {:?}", shortened(key))),
        }
        Ok(())
    }

    fn georeference(&self, columns: usize, rows: usize) -> Result<Option<Georeference>, String> {
        let [Some(x), Some(y)] = self.cell else { return Ok(None) };
        let middle = |k: usize, cell: f64, n: usize| {
            let (place, is_centre) = self.lower_left[k].unwrap_or((0.0, false));
            place + cell * (n as f64 - if is_centre { 1.0 } else { 0.0 }) / 2.0
        };
        let middle = DVec2::new(middle(0, x, columns), middle(1, y, rows));
        if !middle.is_finite() {
            return Err("the position of its lower left cell is not finite".into());
        }
        // the format has no unit
        Ok(Some(Georeference { cell: DVec2::new(x, y), middle, in_degrees: false }))
    }
}

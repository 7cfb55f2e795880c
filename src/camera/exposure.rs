//! When each pixel of an image is exposed: all at once, line by line, or by a table; and the time that the shutter is open.

use crate::arrays::MapEach;
use crate::image::{Grid, read_npy_grid};
use crate::input::reader::{Field, Table};
use crate::input::{Error, Result};
use std::sync::Arc;

/// When pixels are exposed. All times are in frames after the frame that is rendered.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Exposure {
    pub readout: Readout,
    /// For how long the shutter is open at a pixel, about the pixel's own time.
    pub shutter: f64,
    /// All pixels have their samples at the same places of their exposures; otherwise these differ from pixel to pixel.
    pub is_even: bool,
}

/// In what order pixels are read.
#[derive(Debug, Clone, Default, PartialEq)]
pub enum Readout {
    #[default]
    AtOnce,
    Lines(Lines),
    Table(Arc<TimeTable>),
}

/// Line by line. Times are in frames, or in seconds where that is said.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lines {
    /// The time of the first line.
    pub first: f64,
    /// From one line to the next.
    pub line_time: f64,
    pub order: LineOrder,
    /// Lines of the sensor, which an image of another size is a picture of; 0: those of the image.
    pub count: u32,
}

/// From the first line to the last.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LineOrder {
    /// Rows, from the top.
    Down,
    /// Rows, from the bottom.
    Up,
    /// Columns, from the left.
    Right,
    /// Columns, from the right.
    Left,
}

/// A time for each pixel.
#[derive(Debug, Clone, PartialEq)]
pub struct TimeTable {
    /// Width and height of the table; `None`: it lists the pixels of any image, row by row, the last for all that follow.
    pub size: Option<(u32, u32)>,
    /// Row by row, frames.
    pub times: Vec<f64>,
}

/// One of several samples of each pixel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sample {
    pub number: u32,
    pub count: u32,
}

/// The keys of `[camera]`.
pub const KEYS: [&str; 3] = ["line_time", "line_order", "times"];

impl LineOrder {
    const ALL: [(LineOrder, &'static str); 4] =
        [(LineOrder::Down, "down"), (LineOrder::Up, "up"), (LineOrder::Right, "right"), (LineOrder::Left, "left")];

    /// That of a name: "down", "up", "right" or "left".
    pub fn named(name: &str) -> Option<LineOrder> {
        LineOrder::ALL.into_iter().find(|(_, own)| *own == name).map(|(order, _)| order)
    }

    /// Lines are rows, not columns.
    pub fn is_of_rows(self) -> bool {
        matches!(self, LineOrder::Down | LineOrder::Up)
    }
}

impl Exposure {
    /// All pixels are exposed at time 0, for no time.
    pub fn is_instant(&self) -> bool {
        self.readout == Readout::AtOnce && self.shutter == 0.0
    }

    /// The first and last time at which a pixel is exposed.
    pub fn range(&self) -> [f64; 2] {
        let [first, last] = match &self.readout {
            Readout::AtOnce => [0.0, 0.0],
            // half a line more on both sides: images of another size have lines there
            Readout::Lines(Lines { first, line_time, count, .. }) => {
                let ends = [first - 0.5 * line_time, first + (f64::from(*count) - 0.5) * line_time];
                [ends[0].min(ends[1]), ends[0].max(ends[1])]
            }
            Readout::Table(table) => {
                let ends = |[lo, hi]: [f64; 2], t: &f64| [lo.min(*t), hi.max(*t)];
                table.times.iter().fold([f64::INFINITY, f64::NEG_INFINITY], ends)
            }
        };
        [first - self.shutter / 2.0, last + self.shutter / 2.0]
    }

    /// The time of pixel (i, j) of an image of this size: the middle of its exposure, or that of one of its samples. Samples lie in equal
    /// parts of the exposure; unless [`Exposure::is_even`] which sample lies in which part, and where in it, differs from pixel to pixel.
    pub fn time(&self, (i, j): (u32, u32), size: (u32, u32), sample: Option<Sample>) -> f64 {
        let middle = match &self.readout {
            Readout::AtOnce => 0.0,
            Readout::Lines(lines) => lines.time((i, j), size),
            Readout::Table(table) => table.time((i, j), size),
        };
        let Some(Sample { number, count }) = sample.filter(|_| self.shutter != 0.0) else { return middle };
        let (part, within) = if self.is_even { (number, 0.5) } else { shuffled((i, j), number, count) };
        middle + self.shutter * ((f64::from(part) + within) / f64::from(count) - 0.5)
    }
}

impl Lines {
    fn time(&self, (i, j): (u32, u32), (width, height): (u32, u32)) -> f64 {
        let own = if self.order.is_of_rows() { height } else { width };
        let sensor = if self.count == 0 { own } else { self.count };
        let count = f64::from(sensor);
        // in lines of the sensor, from the middle of the first one
        let along =
            |k: u32, n: u32| if n == sensor { k.into() } else { (f64::from(k) + 0.5) / f64::from(n) * count - 0.5 };
        let line = match self.order {
            LineOrder::Down => along(j, height),
            LineOrder::Up => count - 1.0 - along(j, height),
            LineOrder::Right => along(i, width),
            LineOrder::Left => count - 1.0 - along(i, width),
        };
        self.first + line * self.line_time
    }
}

impl TimeTable {
    /// That of the table's pixel in which the pixel's centre lies.
    fn time(&self, (i, j): (u32, u32), (width, height): (u32, u32)) -> f64 {
        let at = |k: u32, n: u32, own: u32| ((2 * u64::from(k) + 1) * u64::from(own) / (2 * u64::from(n))) as usize;
        match self.size {
            Some((w, h)) => self.times[at(j, height, h) * w as usize + at(i, width, w)],
            None => self.times[(j as usize * width as usize + i as usize).min(self.times.len() - 1)],
        }
    }
}

/// The part of a pixel's exposure that one of its samples lies in, and where in it.
fn shuffled((i, j): (u32, u32), number: u32, count: u32) -> (u32, f64) {
    let random = hash(i, j);
    let part = (u64::from(number) + u64::from(random >> 16)) % u64::from(count);
    (part as u32, f64::from(random & 0xffff) / 65536.0)
}

/// A number without a pattern for each pixel (the 32-bit finaliser of MurmurHash3).
fn hash(i: u32, j: u32) -> u32 {
    let mut h = i.wrapping_mul(0x9e37_79b9).wrapping_add(j.wrapping_mul(0x85eb_ca77)).wrapping_add(1);
    for factor in [0x85eb_ca6b, 0xc2b2_ae35] {
        h = (h ^ h >> 16).wrapping_mul(factor);
    }
    h ^ h >> 16
}

/// When the pixels of a camera are read, in an image of this size and with so many frames a second. `own` is what keys of its kind say.
pub fn read_readout(
    table: &Table,
    own: Option<Lines>,
    size: (Option<u32>, Option<u32>),
    frame_rate: f64,
) -> Result<Readout> {
    if let Some(lines) = own {
        if let Some(field) = ["line_order", "times"].into_iter().find_map(|key| table.get(key)) {
            return Err(field.error("other keys of this camera say when its lines are read; leave it out"));
        }
        return Ok(Readout::Lines(Lines {
            first: lines.first * frame_rate,
            line_time: lines.line_time * frame_rate,
            ..lines
        }));
    }
    let (line_time, times) = (table.get("line_time"), table.get("times"));
    if let (Some(order), None) = (table.get("line_order"), &line_time) {
        return Err(order.error("lines have an order only with a line_time; add line_time = 3e-5"));
    }
    match (line_time, times) {
        (None, None) => Ok(Readout::AtOnce),
        (Some(_), Some(times)) => Err(times.error("line_time says it already; remove one of the two")),
        (None, Some(times)) => Ok(Readout::Table(Arc::new(read_times(&times, frame_rate)?))),
        (Some(line_time), None) => {
            let order = table.or("line_order", LineOrder::Down, read_order)?;
            let (side, name) = if order.is_of_rows() { (size.1, "height") } else { (size.0, "width") };
            let Some(count) = side else {
                return Err(line_time.error(format_args!("needs the number of lines; add {name} to [image]")));
            };
            Ok(Readout::Lines(Lines { first: 0.0, line_time: line_time.number()? * frame_rate, order, count }))
        }
    }
}

fn read_order(field: &Field) -> Result<LineOrder> {
    let text = field.text()?;
    let known = || LineOrder::ALL.map_each(|(_, name)| format!("{name:?}")).join(", ");
    LineOrder::named(text).ok_or_else(|| field.error(format_args!("{text:?} is no order of lines; known: {}", known())))
}

/// Seconds, from a file of N or height x width numbers (.npy).
fn read_times(field: &Field, frame_rate: f64) -> Result<TimeTable> {
    let path = field.path()?;
    let Grid { size, numbers: times } = read_npy_grid(&path, field.loading())?;
    if let Some(k) = times.iter().position(|t| !t.is_finite()) {
        return Err(Error::input(format!("{}: number {k} is {}; use finite numbers", path.display(), times[k])));
    }
    Ok(TimeTable { size, times: times.into_iter().map(|t| t * frame_rate).collect() })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(order: LineOrder) -> Exposure {
        Exposure {
            readout: Readout::Lines(Lines { first: 0.0, line_time: 0.5, order, count: 4 }),
            shutter: 0.0,
            is_even: false,
        }
    }

    #[test]
    fn lines_are_read_in_their_order() {
        for (order, pixel, time) in [
            (LineOrder::Down, (9, 3), 1.5),
            (LineOrder::Up, (9, 3), 0.0),
            (LineOrder::Right, (3, 9), 1.5),
            (LineOrder::Left, (0, 9), 1.5),
        ] {
            let size = if order.is_of_rows() { (10, 4) } else { (4, 10) };
            assert_eq!(lines(order).time(pixel, size, None), time, "{order:?}");
        }
        let of_image = Lines { first: 0.0, line_time: 0.5, order: LineOrder::Up, count: 0 };
        assert_eq!(of_image.time((0, 2), (5, 9)), 3.0);
        // of an image of half the size a row lies between two lines
        assert_eq!(lines(LineOrder::Down).time((0, 1), (5, 2), None), 1.25);
        assert_eq!(lines(LineOrder::Down).range(), [-0.25, 1.75]);
    }

    #[test]
    fn the_samples_of_a_pixel_lie_in_equal_parts_of_its_exposure() {
        let exposure = Exposure { shutter: 0.4, ..lines(LineOrder::Down) };
        let count = 7;
        for pixel in [(0, 0), (1, 0), (3, 2), (1000, 3)] {
            let own = exposure.time(pixel, (2000, 4), None);
            let place = |number| (exposure.time(pixel, (2000, 4), Some(Sample { number, count })) - own) / 0.4 + 0.5;
            let mut parts: Vec<u32> = (0..count).map(|k| (place(k) * f64::from(count)).floor() as u32).collect();
            parts.sort_unstable();
            assert!(parts.into_iter().eq(0..count), "{pixel:?}");
        }
        let first: Vec<f64> =
            (0..64).map(|i| exposure.time((i, 0), (64, 4), Some(Sample { number: 0, count }))).collect();
        // the first samples of 64 pixels lie all over the exposure
        assert!(first.iter().any(|t| *t < -0.15) && first.iter().any(|t| *t > 0.15));
    }

    #[test]
    fn a_table_of_one_row_is_that_of_all() {
        let table = TimeTable { size: Some((3, 1)), times: vec![1.0, 2.0, 4.0] };
        let exposure = Exposure { readout: Readout::Table(Arc::new(table)), shutter: 0.0, is_even: false };
        assert_eq!([0, 1, 2].map(|i| exposure.time((i, 7), (3, 9), None)), [1.0, 2.0, 4.0]);
        assert_eq!([0, 2, 3, 5].map(|i| exposure.time((i, 7), (6, 9), None)), [1.0, 2.0, 2.0, 4.0]);
        assert_eq!(exposure.range(), [1.0, 4.0]);
        let list = TimeTable { size: None, times: vec![1.0, 2.0, 4.0] };
        let exposure = Exposure { readout: Readout::Table(Arc::new(list)), shutter: 0.0, is_even: false };
        assert_eq!(
            [(0, 0), (1, 0), (0, 1), (1, 1)].map(|pixel| exposure.time(pixel, (2, 2), None)),
            [1.0, 2.0, 4.0, 4.0]
        );
    }
}

//! The data of a PLY file after its header, read block by block and decoded on all cores.

use super::Wrong;
use super::read::{Element, Place, Row, Rows, cut_short};
use crate::input::Window;
use crate::parallel;

/// Bytes of a part, which one thread decodes: small enough to balance cores.
const PART_BYTES: usize = 1 << 16;

/// The data of a file from its next row on.
pub(super) struct Body {
    window: Window,
    place: Place,
}

/// Consecutive rows of an element.
pub(super) struct Part<'a> {
    rows: Rows<'a>,
    element: &'a Element,
    /// Number of the first row.
    pub first: usize,
    pub count: usize,
}

impl Part<'_> {
    /// Calls `each` with the rows one by one.
    ///
    /// # Errors
    /// A line of a text has other numbers, or an error of `each`.
    pub fn read(&self, each: impl FnMut(&Row) -> Result<(), Wrong>) -> Result<(), Wrong> {
        self.rows.clone().read(self.element, self.count, each)
    }
}

impl Body {
    /// The data behind a header, by the file's bytes from its start on.
    pub fn new(mut window: Window, header_end: Place) -> Body {
        window.advance(header_end.offset);
        Body { window, place: header_end }
    }

    /// Reads all rows of an element. `decode` makes something of each part of them, on all cores; `take` gets the results in order.
    ///
    /// # Errors
    /// The file cannot be read or ends, or the error of the first part that has one.
    pub fn read<T: Send>(
        &mut self,
        element: &Element,
        decode: impl Fn(&Part) -> Result<T, Wrong> + Sync,
        mut take: impl FnMut(T),
    ) -> Result<(), Wrong> {
        if element.properties.is_empty() {
            return Ok(());
        }
        let mut first = 0;
        while first < element.count {
            let is_end = self.window.is_at_end();
            let (parts, next) = self.parts(element, first, is_end);
            let Some(last) = parts.last() else {
                if is_end {
                    return Err(cut_short(element));
                }
                self.window.read_on().map_err(Wrong::Unreadable)?;
                continue;
            };
            first = last.first + last.count;
            parallel::try_map(&parts, &decode)?.into_iter().for_each(&mut take);
            drop(parts);
            self.window.advance(next.offset);
            self.place = next;
        }
        Ok(())
    }

    /// Skips all rows of an element.
    ///
    /// # Errors
    /// The file cannot be read or ends, or a line of a text has other numbers.
    pub fn skip(&mut self, element: &Element) -> Result<(), Wrong> {
        self.read(element, |part| part.read(|_| Ok(())), |()| ())
    }

    /// The rows that are in the window, from number `first` on, and the place behind them.
    fn parts<'a>(&'a self, element: &'a Element, mut first: usize, is_end: bool) -> (Vec<Part<'a>>, Place) {
        let mut next = Rows::new(self.window.bytes(), self.place);
        let mut parts = Vec::new();
        loop {
            let (rows, mut count) = (next.clone(), 0);
            let enough = rows.bytes_left().saturating_sub(PART_BYTES);
            while first + count < element.count && next.bytes_left() >= enough && next.skip(element, is_end) {
                count += 1;
            }
            if count == 0 {
                return (parts, next.place);
            }
            parts.push(Part { rows, element, first, count });
            first += count;
        }
    }
}

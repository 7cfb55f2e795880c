//! The header of a PLY file, and the rows of numbers that its elements are.

use super::Wrong;
use crate::geometry::lex::parse_f64;
use crate::image::{NumberFormat, NumberType};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    Ascii,
    Little,
    Big,
}

#[derive(Debug)]
pub(super) struct Property {
    pub name: String,
    pub kind: NumberType,
    /// The type of its length, if it is a list.
    length: Option<NumberType>,
}

#[derive(Debug)]
pub(super) struct Element {
    pub name: String,
    pub count: usize,
    pub properties: Vec<Property>,
}

#[derive(Debug)]
pub(super) struct Header {
    pub encoding: Encoding,
    pub elements: Vec<Element>,
    pub comments: Vec<String>,
}

/// Rows of elements, or lines of a header, in bytes of a file.
#[derive(Debug, Clone)]
pub(super) struct Rows<'a> {
    bytes: &'a [u8],
    /// In these bytes.
    pub place: Place,
}

/// The place where the next row begins.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    /// Number of bytes before it.
    pub offset: usize,
    encoding: Encoding,
    /// The byte that ends a line of a text.
    line_end: u8,
    /// Number of lines read so far.
    line: usize,
}

/// The values of one element, by the numbers of its properties.
#[derive(Debug, Default)]
pub(super) struct Row {
    values: Vec<f64>,
    /// Where each property's values end.
    ends: Vec<usize>,
}

/// The type of a number, by its name in a header.
fn kind_of(name: &[u8]) -> Option<NumberType> {
    NumberType::named(std::str::from_utf8(name).ok()?, NumberFormat::Ply)
}

/// The value of a token, rounded as its type is; `None` if it is none of this type.
fn parse_number(token: &[u8], kind: NumberType) -> Option<f64> {
    let value = parse_f64(token)?;
    let (least, most) = match kind {
        NumberType::F32 => return Some(f64::from(value as f32)),
        NumberType::F64 => return Some(value),
        NumberType::I8 => (i8::MIN.into(), i8::MAX.into()),
        NumberType::U8 => (0.0, u8::MAX.into()),
        NumberType::I16 => (i16::MIN.into(), i16::MAX.into()),
        NumberType::U16 => (0.0, u16::MAX.into()),
        NumberType::I32 => (i32::MIN.into(), i32::MAX.into()),
        NumberType::U32 => (0.0, u32::MAX.into()),
    };
    (value.fract() == 0.0 && (least..=most).contains(&value)).then_some(value)
}

impl Element {
    /// The fewest bytes that one of these elements takes: a text's is a line.
    pub fn least_bytes(&self, encoding: Encoding) -> u64 {
        let least = |p: &Property| p.length.unwrap_or(p.kind).size() as u64;
        if encoding == Encoding::Ascii { 1 } else { self.properties.iter().map(least).sum() }
    }

    /// The bytes that each of these elements takes in a binary file; `None` if one has a list.
    fn row_bytes(&self) -> Option<usize> {
        self.properties.iter().map(|p| p.length.is_none().then(|| p.kind.size())).sum()
    }

    /// The number of a property that is a number.
    pub fn number(&self, name: &str) -> Option<usize> {
        self.properties.iter().position(|p| p.name == name && p.length.is_none())
    }

    /// The number of a property that is a list.
    pub fn list(&self, name: &str) -> Option<usize> {
        self.properties.iter().position(|p| p.name == name && p.length.is_some())
    }

    /// The numbers of properties by the first set of names that are all there.
    pub fn numbers<const N: usize>(&self, names: &[[&str; N]]) -> Option<[usize; N]> {
        names.iter().find_map(|names| {
            let all: Vec<usize> = names.iter().map_while(|name| self.number(name)).collect();
            all.try_into().ok()
        })
    }
}

impl Header {
    /// Whether the end of a header, with its line's end, is among a file's first bytes.
    pub fn is_whole(bytes: &[u8]) -> bool {
        const END: &[u8] = b"end_header";
        // a line ends in one or two bytes
        let before = bytes.len().saturating_sub(2);
        bytes[..before].windows(END.len()).any(|word| word == END)
    }

    /// Reads the header; returns the place of its first row too. Lines of no known keyword are skipped: old versions of Blender write some.
    ///
    /// # Errors
    /// The line that is wrong, or the part that the header lacks.
    pub fn parse(bytes: &[u8]) -> Result<(Header, Place), Wrong> {
        if !bytes.starts_with(b"ply") {
            return Err(Wrong::File("is no PLY file: it does not begin with the line ply".into()));
        }
        let end = bytes.iter().position(|b| matches!(b, b'\r' | b'\n')).unwrap_or(0);
        // lines that end in a carriage return alone
        let is_cr = bytes[end] == b'\r' && bytes.get(end + 1) != Some(&b'\n');
        let line_end = if is_cr { b'\r' } else { b'\n' };
        let place = Place { offset: 0, encoding: Encoding::Ascii, line_end, line: 0 };
        let mut lines = Rows { bytes, place };
        let mut encoding = None;
        let (mut elements, mut comments): (Vec<Element>, Vec<String>) = (Vec::new(), Vec::new());
        loop {
            let Some(line) = lines.next_line() else {
                return Err(Wrong::File("its header has no end, or is no text; write the file again".into()));
            };
            let wrong =
                || Wrong::Line(lines.place.line, "this is no line of a PLY header; write the file again".into());
            if lines.place.line == 1 && line.trim_ascii() != b"ply" {
                return Err(wrong());
            }
            let words: Vec<&[u8]> = words(line).collect();
            match words[..] {
                [b"end_header"] => break,
                [b"format", name, ..] => {
                    encoding = Some(match name {
                        b"ascii" => Encoding::Ascii,
                        b"binary_little_endian" => Encoding::Little,
                        b"binary_big_endian" => Encoding::Big,
                        _ => return Err(wrong()),
                    });
                }
                [b"element", name, count] => {
                    let count = std::str::from_utf8(count).ok().and_then(|c| c.parse().ok()).ok_or_else(wrong)?;
                    elements.push(Element { name: text(name), count, properties: Vec::new() });
                }
                [b"property", b"list", length, kind, name] => {
                    let length = Some(kind_of(length).ok_or_else(wrong)?);
                    let kind = kind_of(kind).ok_or_else(wrong)?;
                    elements.last_mut().ok_or_else(wrong)?.properties.push(Property { name: text(name), kind, length });
                }
                [b"property", kind, name] => {
                    let kind = kind_of(kind).ok_or_else(wrong)?;
                    let property = Property { name: text(name), kind, length: None };
                    elements.last_mut().ok_or_else(wrong)?.properties.push(property);
                }
                [b"format" | b"element" | b"property", ..] => return Err(wrong()),
                [b"comment", ..] => comments.push(text(&line.trim_ascii()[b"comment".len()..])),
                _ => {}
            }
        }
        let encoding =
            encoding.ok_or_else(|| Wrong::File("its header has no line format; write the file again".into()))?;
        Ok((Header { encoding, elements, comments }, Place { encoding, ..lines.place }))
    }

    /// Number of elements of a name.
    pub fn count(&self, name: &str) -> usize {
        self.elements.iter().filter(|e| e.name == name).map(|e| e.count).fold(0, usize::saturating_add)
    }
}

impl<'a> Rows<'a> {
    /// Rows from a place on, in these bytes of a file that begin there.
    pub fn new(bytes: &'a [u8], place: Place) -> Rows<'a> {
        Rows { bytes, place: Place { offset: 0, ..place } }
    }

    fn rest(&self) -> &'a [u8] {
        &self.bytes[self.place.offset..]
    }

    /// Number of bytes from the next row on.
    pub fn bytes_left(&self) -> usize {
        self.bytes.len() - self.place.offset
    }

    /// Skips the next row of an element. Returns false, and skips nothing, if the bytes end before the row does; `is_end`: the file ends with them.
    pub fn skip(&mut self, element: &Element, is_end: bool) -> bool {
        let mut next = self.clone();
        let is_there = match self.place.encoding {
            Encoding::Ascii => next.next_row().is_some() && (is_end || next.ends_in_line_end(self)),
            _ => next.skip_binary(element).is_some(),
        };
        if is_there {
            *self = next;
        }
        is_there
    }

    /// Whether the last line between `before` and this place is whole.
    fn ends_in_line_end(&self, before: &Rows) -> bool {
        self.bytes[before.place.offset..self.place.offset].last() == Some(&self.place.line_end)
    }

    /// `None`: the bytes end before the row does.
    fn skip_binary(&mut self, element: &Element) -> Option<()> {
        let bytes = match element.row_bytes() {
            Some(bytes) => bytes,
            None => {
                let mut bytes = 0usize;
                for property in &element.properties {
                    let mut count = 1;
                    if let Some(length) = property.length {
                        let number = self.rest().get(bytes..bytes.checked_add(length.size())?)?;
                        (count, bytes) = (length.read(number, self.is_big_endian()) as usize, bytes + length.size());
                    }
                    bytes = bytes.checked_add(count.checked_mul(property.kind.size())?)?;
                }
                bytes
            }
        };
        let after = self.place.offset.checked_add(bytes)?;
        self.place.offset = Some(after).filter(|after| *after <= self.bytes.len())?;
        Some(())
    }

    fn next_line(&mut self) -> Option<&'a [u8]> {
        let rest = self.rest();
        if rest.is_empty() {
            return None;
        }
        self.place.line += 1;
        let end = rest.iter().position(|b| *b == self.place.line_end);
        self.place.offset += end.map_or(rest.len(), |end| end + 1);
        Some(&rest[..end.unwrap_or(rest.len())])
    }

    /// The next line of a text that is not empty.
    fn next_row(&mut self) -> Option<&'a [u8]> {
        loop {
            let line = self.next_line()?.trim_ascii();
            if !line.is_empty() {
                return Some(line);
            }
        }
    }

    /// Reads `count` rows of an element; `each` takes them one by one.
    ///
    /// # Errors
    /// The bytes end, a line of a text has other numbers, or an error of `each`.
    pub fn read(
        &mut self,
        element: &Element,
        count: usize,
        mut each: impl FnMut(&Row) -> Result<(), Wrong>,
    ) -> Result<(), Wrong> {
        let mut row = Row::default();
        for _ in 0..count {
            row.values.clear();
            row.ends.clear();
            match self.place.encoding {
                Encoding::Ascii => self.read_line(element, &mut row)?,
                _ => self.read_binary(element, &mut row)?,
            }
            each(&row)?;
        }
        Ok(())
    }

    fn read_line(&mut self, element: &Element, row: &mut Row) -> Result<(), Wrong> {
        let line = self.next_row().ok_or_else(|| cut_short(element))?;
        let wrong = || {
            let name = &element.name;
            let what = format!("this is no line of the numbers that its header says; it is one of its {name} elements");
            Wrong::Line(self.place.line, what)
        };
        let mut tokens = words(line);
        for property in &element.properties {
            let length = match property.length {
                // a negative number becomes 0; tokens are left over then
                Some(kind) => tokens.next().and_then(|token| parse_number(token, kind)).ok_or_else(wrong)? as usize,
                None => 1,
            };
            for _ in 0..length {
                row.values.push(tokens.next().and_then(|token| parse_number(token, property.kind)).ok_or_else(wrong)?);
            }
            row.ends.push(row.values.len());
        }
        if tokens.next().is_some() { Err(wrong()) } else { Ok(()) }
    }

    fn is_big_endian(&self) -> bool {
        self.place.encoding == Encoding::Big
    }

    fn read_binary(&mut self, element: &Element, row: &mut Row) -> Result<(), Wrong> {
        let big_endian = self.is_big_endian();
        for property in &element.properties {
            let length = match property.length {
                Some(kind) => kind.read(self.take(kind.size(), element)?, big_endian) as usize,
                None => 1,
            };
            let size = property.kind.size();
            let bytes = self.take(length.saturating_mul(size), element)?;
            row.values.extend(bytes.chunks_exact(size).map(|b| property.kind.read(b, big_endian)));
            row.ends.push(row.values.len());
        }
        Ok(())
    }

    fn take(&mut self, count: usize, element: &Element) -> Result<&'a [u8], Wrong> {
        let bytes = self.rest().get(..count).ok_or_else(|| cut_short(element))?;
        self.place.offset += count;
        Ok(bytes)
    }
}

impl Row {
    /// The values of a list.
    pub fn list(&self, property: usize) -> &[f64] {
        let start = property.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.values[start..self.ends[property]]
    }

    /// The value of a property that is a number.
    pub fn number(&self, property: usize) -> f64 {
        // a property that is no list has one value
        self.values[self.ends[property] - 1]
    }

    pub fn numbers<const N: usize>(&self, properties: [usize; N]) -> [f64; N] {
        std::array::from_fn(|k| self.number(properties[k]))
    }
}

pub(super) fn cut_short(element: &Element) -> Wrong {
    Wrong::File(format!("ends within its {} elements; is it cut short?", element.name))
}

fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty())
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes.trim_ascii()).into_owned()
}

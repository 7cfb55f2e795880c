//! The first bytes of an input file. With its length they often decide that the file cannot be used, before the rest is read.

use super::{Limits, Window};
use std::fs::File;
use std::io::{self, Read};

/// Bytes that are read first. Headers are shorter.
const PREFIX_BYTES: u64 = 1 << 16;

/// An open file whose first bytes are read.
#[derive(Debug)]
pub struct Prefix {
    file: File,
    bytes: Vec<u8>,
    length: u64,
    limits: Limits,
}

impl Prefix {
    /// Reads the first bytes of a regular file.
    ///
    /// # Errors
    /// The errors of the file.
    pub(super) fn read(file: File, limits: Limits) -> io::Result<Prefix> {
        let length = file.metadata()?.len();
        let mut bytes = Vec::new();
        (&file).take(PREFIX_BYTES).read_to_end(&mut bytes)?;
        Ok(Prefix { file, bytes, length, limits })
    }

    /// The first bytes, at most [`PREFIX_BYTES`].
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// The length of the whole file, bytes.
    pub fn length(&self) -> u64 {
        self.length
    }

    /// Whether there are no more bytes than the first.
    pub fn is_whole(&self) -> bool {
        self.length <= self.bytes.len() as u64
    }

    /// Whether one of the first bytes is zero, as in no text.
    pub fn has_zero(&self) -> bool {
        self.bytes.contains(&0)
    }

    /// Whether the file goes on after the first bytes though one of these is zero. A whole text may be padded by zeros.
    pub fn goes_on_after_zero(&self) -> bool {
        !self.is_whole() && self.has_zero()
    }

    /// Refuses a file that is no text.
    ///
    /// # Errors
    /// [`io::ErrorKind::InvalidData`] for a zero among the first bytes.
    pub fn check_text(&self) -> io::Result<()> {
        match self.has_zero() {
            true => Err(io::Error::new(io::ErrorKind::InvalidData, "it has a zero byte, so it is no UTF-8 text")),
            false => Ok(()),
        }
    }

    /// Reads the rest and returns all bytes of the file.
    ///
    /// # Errors
    /// The errors of the file, and too little memory for it.
    pub fn read_all(mut self) -> io::Result<Vec<u8>> {
        if !self.is_whole() {
            let what = format_args!("a file of {} bytes", self.length);
            self.limits.check_memory(self.length, what, "use a smaller one").map_err(io::Error::other)?;
        }
        self.file.read_to_end(&mut self.bytes)?;
        Ok(self.bytes)
    }

    /// Reads the rest by blocks, for a reader that uses it from its start to its end.
    ///
    /// # Errors
    /// The system starts no thread.
    pub fn into_window(self) -> io::Result<Window> {
        if self.is_whole() { Ok(Window::whole(self.bytes)) } else { Window::of(self.bytes, self.file) }
    }

    /// Reads the rest if it is needed; else returns the first bytes, which a decoder refuses as it would refuse the whole file.
    ///
    /// # Errors
    /// The errors of [`Prefix::read_all`].
    pub fn read_if(self, is_needed: bool) -> io::Result<Vec<u8>> {
        if is_needed { self.read_all() } else { Ok(self.bytes) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::Error;
    use std::path::Path;

    fn prefix(dir: &tempfile::TempDir, bytes: &[u8], limits: Limits) -> Prefix {
        let path = dir.path().join("a");
        std::fs::write(&path, bytes).unwrap();
        Prefix::read(File::open(path).unwrap(), limits).unwrap()
    }

    #[test]
    fn the_rest_is_read_where_it_is_needed() {
        let dir = tempfile::tempdir().unwrap();
        let bytes: Vec<u8> = (0..PREFIX_BYTES + 9).map(|k| 1 + (k % 251) as u8).collect();
        let read = |length: usize| prefix(&dir, &bytes[..length], Limits::default());
        let most = PREFIX_BYTES as usize;
        for length in [0, 5, most - 1, most, most + 1, most + 9] {
            let start = read(length);
            assert_eq!((start.length(), start.is_whole()), (length as u64, length <= most));
            assert_eq!(start.bytes(), &bytes[..length.min(most)]);
            assert!(start.read_all().unwrap() == bytes[..length]);
            assert!(read(length).read_if(false).unwrap() == bytes[..length.min(most)]);
        }
        assert!(prefix(&dir, b"a\0b", Limits::default()).check_text().is_err() && read(9).check_text().is_ok());
    }

    #[test]
    fn a_file_larger_than_memory_is_refused() {
        let dir = tempfile::tempdir().unwrap();
        let none = Limits::default().memory(0);
        let bytes = vec![b'a'; PREFIX_BYTES as usize + 1];
        let error = prefix(&dir, &bytes, none).read_all().unwrap_err();
        // too little memory is no fault of the file
        let error = Error::unreadable(Path::new("a"), format_args!("{error}; check the path"));
        let text = error.to_string();
        assert!(text.starts_with("a: a file of 65537 bytes takes about") && text.ends_with("--no-limits"), "{text}");
        assert_eq!(error.exit_code(), 1);
        // the first bytes are in memory already
        assert_eq!(prefix(&dir, &bytes[1..], none).read_all().unwrap().len(), bytes.len() - 1);
    }
}

//! A file that is read block by block, so that the whole of it is never in memory beside what is made of it.

use std::fs::File;
use std::io::{self, Read};
use std::sync::mpsc::{Receiver, sync_channel};
use std::thread;

/// Bytes of a block. Larger blocks are not read faster.
const BLOCK_BYTES: u64 = 1 << 23;

/// The bytes of a file that are read and not used yet. A thread reads the next block meanwhile.
#[derive(Debug)]
pub struct Window {
    bytes: Vec<u8>,
    /// How many of them are used.
    used: usize,
    /// The blocks behind `bytes`; `None` at the end of the file.
    blocks: Option<Receiver<io::Result<Vec<u8>>>>,
}

impl Window {
    /// A window on all bytes of a file.
    pub fn whole(bytes: Vec<u8>) -> Window {
        Window { bytes, used: 0, blocks: None }
    }

    /// A window on the first bytes of a file, which goes on in `rest`.
    ///
    /// # Errors
    /// The system starts no thread.
    pub fn of(bytes: Vec<u8>, rest: File) -> io::Result<Window> {
        // one block waits while the next one is read
        let (send, blocks) = sync_channel(1);
        let read = move || {
            loop {
                let mut block = Vec::with_capacity(BLOCK_BYTES as usize);
                let read = (&rest).take(BLOCK_BYTES).read_to_end(&mut block);
                let goes_on = matches!(read, Ok(1..));
                // nobody takes blocks behind the bytes that were needed
                if matches!(read, Ok(0)) || send.send(read.map(|_| block)).is_err() || !goes_on {
                    return;
                }
            }
        };
        thread::Builder::new().name("read".into()).spawn(read)?;
        Ok(Window { bytes, used: 0, blocks: Some(blocks) })
    }

    /// The bytes that are read and not used yet.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes[self.used..]
    }

    /// Whether the file has no bytes behind these.
    pub fn is_at_end(&self) -> bool {
        self.blocks.is_none()
    }

    /// Takes `count` bytes as used. There are as many.
    pub fn advance(&mut self, count: usize) {
        self.used += count;
    }

    /// Appends at least as many bytes as there are, unless the file ends before. Rows of any length are thus read in linear time.
    ///
    /// # Errors
    /// The errors of the file.
    pub fn read_on(&mut self) -> io::Result<()> {
        self.bytes.drain(..self.used);
        self.used = 0;
        let enough = 2 * self.bytes.len() + 1;
        while let Some(blocks) = &self.blocks
            && self.bytes.len() < enough
        {
            match blocks.recv() {
                Ok(block) => self.bytes.extend_from_slice(&block?),
                Err(_) => self.blocks = None,
            }
        }
        Ok(())
    }

    /// Appends the rest of the file.
    ///
    /// # Errors
    /// The errors of the file.
    pub fn read_all(&mut self) -> io::Result<()> {
        while !self.is_at_end() {
            self.read_on()?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn all_bytes_pass_once_and_in_order() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a");
        let bytes: Vec<u8> = (0..3 * BLOCK_BYTES + 9).map(|k| (k % 251) as u8).collect();
        fs::write(&path, &bytes).unwrap();
        let mut window = Window::of(b"first".to_vec(), fs::File::open(&path).unwrap()).unwrap();
        let mut passed = Vec::new();
        while !window.is_at_end() {
            // all but a few bytes are used
            let used = window.bytes().len().saturating_sub(7);
            passed.extend_from_slice(&window.bytes()[..used]);
            window.advance(used);
            window.read_on().unwrap();
        }
        passed.extend_from_slice(window.bytes());
        assert!(passed == [&b"first"[..], &bytes].concat());
    }

    #[test]
    fn bytes_that_are_not_used_stay() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a");
        fs::write(&path, b"rest").unwrap();
        let mut window = Window::of(b"first".to_vec(), fs::File::open(&path).unwrap()).unwrap();
        window.read_all().unwrap();
        assert_eq!(window.bytes(), b"firstrest");
        assert!(Window::whole(Vec::new()).is_at_end());
    }
}

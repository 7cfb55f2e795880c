//! The files that work is done from. All are read here, and noted for whoever asks which they were.

use std::cell::RefCell;
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

thread_local! {
    /// What was read on this thread within each [`noted`], the innermost last.
    static NOTED: RefCell<Vec<Inputs>> = const { RefCell::new(Vec::new()) };
}

/// Files as they were found, each once.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Inputs {
    files: Vec<(PathBuf, Stamp)>,
}

/// When a file was last written, and its bytes; `None` of one that is not there.
pub type Stamp = Option<(SystemTime, u64)>;

/// The bytes of a file.
pub fn read(path: &Path) -> io::Result<Vec<u8>> {
    note(path);
    fs::read(path)
}

/// The text of a file.
pub fn read_to_string(path: &Path) -> io::Result<String> {
    note(path);
    fs::read_to_string(path)
}

/// A file, open to be read.
pub fn open(path: &Path) -> io::Result<File> {
    note(path);
    File::open(path)
}

/// Notes a file that was looked for.
pub fn note(path: &Path) {
    note_all(&Inputs { files: vec![(path.to_owned(), stamp(path))] });
}

/// Notes what something that is kept was made from.
pub fn note_all(inputs: &Inputs) {
    NOTED.with_borrow_mut(|noted| {
        if let Some(noted) = noted.last_mut() {
            noted.add(inputs);
        }
    });
}

/// Works, and says what files were looked for meanwhile on this thread.
pub fn noted<T>(work: impl FnOnce() -> T) -> (T, Inputs) {
    NOTED.with_borrow_mut(|noted| noted.push(Inputs::default()));
    let done = work();
    let own = NOTED.with_borrow_mut(Vec::pop).unwrap_or_default();
    note_all(&own);
    (done, own)
}

impl Inputs {
    /// Each as it was found.
    pub fn files(&self) -> impl Iterator<Item = (&Path, &Stamp)> {
        self.files.iter().map(|(path, found)| (path.as_path(), found))
    }

    /// All files are as they were found.
    pub fn are_current(&self) -> bool {
        self.files.iter().all(|(path, found)| stamp(path) == *found)
    }

    fn add(&mut self, more: &Inputs) {
        for own in &more.files {
            if !self.files.contains(own) {
                self.files.push(own.clone());
            }
        }
    }
}

/// How a file is found now.
pub fn stamp(path: &Path) -> Stamp {
    let found = fs::metadata(path).ok()?;
    Some((found.modified().ok()?, found.len()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_read_is_noted_once_by_all_around_it() {
        let dir = tempfile::tempdir().unwrap();
        let path = |name: &str| dir.path().join(name);
        fs::write(path("a"), "1").unwrap();
        let (inner, outer) = noted(|| {
            read(&path("a")).unwrap();
            let (_, inner) = noted(|| (open(&path("a")).unwrap(), read(&path("missing")).unwrap_err()));
            inner
        });
        assert_eq!(outer.files().map(|f| f.0).collect::<Vec<_>>(), [path("a"), path("missing")]);
        assert_eq!(inner, outer);
        assert!(outer.are_current());
        fs::write(path("missing"), "").unwrap();
        assert!(!outer.are_current());
        // nobody asks
        read(&path("a")).unwrap();
        assert_eq!(noted(|| ()).1, Inputs::default());
    }

    #[test]
    fn a_file_of_another_size_is_another() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a");
        fs::write(&path, "1").unwrap();
        let (_, found) = noted(|| read(&path).unwrap());
        fs::write(&path, "22").unwrap();
        assert!(!found.are_current());
    }
}

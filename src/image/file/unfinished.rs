//! Temporary files of unfinished outputs. They are removed when dropped, and by [`remove_unfinished`] when a signal ends the program.

use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use tempfile::{Builder, NamedTempFile};

/// The paths of all of them in this process.
static PATHS: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn paths() -> MutexGuard<'static, Vec<PathBuf>> {
    PATHS.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A temporary file whose path is in [`PATHS`].
pub(super) struct Unfinished {
    // dropped in this order: the file is removed before its path is
    file: NamedTempFile,
    _entry: Entry,
}

/// An entry of [`PATHS`], removed when dropped.
struct Entry(PathBuf);

impl Drop for Entry {
    fn drop(&mut self) {
        paths().retain(|path| *path != self.0);
    }
}

impl Unfinished {
    pub fn new(builder: &Builder, folder: &Path) -> io::Result<Unfinished> {
        // locked while the file is created, so that `remove_unfinished` misses none
        let mut paths = paths();
        let file = builder.tempfile_in(folder)?;
        paths.push(file.path().to_owned());
        Ok(Unfinished { _entry: Entry(file.path().to_owned()), file })
    }

    pub fn path(&self) -> &Path {
        self.file.path()
    }

    pub fn file(&mut self) -> &mut File {
        self.file.as_file_mut()
    }

    /// Renames it to `path`, and replaces a file there.
    pub fn persist(self, path: &Path) -> io::Result<()> {
        self.file.persist(path).map(drop).map_err(|e| e.error)
    }
}

/// Removes all temporary files before the process ends. No more are created while the returned guard is held.
#[cfg(feature = "cli")]
pub fn remove_unfinished() -> impl Sized {
    let paths = paths();
    for path in paths.iter() {
        // the process ends: nothing can be done about an error
        let _ = std::fs::remove_file(path);
    }
    paths
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_listed_until_files_are_dropped_or_renamed() {
        let dir = tempfile::tempdir().unwrap();
        let [kept, dropped] = [0, 1].map(|_| Unfinished::new(&Builder::new(), dir.path()).unwrap());
        let own = [kept.path().to_owned(), dropped.path().to_owned()];
        assert!(own.iter().all(|path| path.exists() && paths().contains(path)));
        kept.persist(&dir.path().join("kept")).unwrap();
        drop(dropped);
        assert!(!own.iter().any(|path| path.exists() || paths().contains(path)));
        assert!(dir.path().join("kept").exists());
    }
}

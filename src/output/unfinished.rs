//! Temporary files that are being filled, which are removed when they are dropped, and when the program is ended from outside.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use tempfile::{Builder, NamedTempFile};

/// All of this program.
static PATHS: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn paths() -> MutexGuard<'static, Vec<PathBuf>> {
    PATHS.lock().unwrap_or_else(PoisonError::into_inner)
}

/// One of them.
pub(super) struct Unfinished {
    // dropped in this order: none is there that is not known
    file: NamedTempFile,
    _known: Known,
}

/// An entry of [`PATHS`].
struct Known(PathBuf);

impl Drop for Known {
    fn drop(&mut self) {
        paths().retain(|path| *path != self.0);
    }
}

impl Unfinished {
    pub fn new(builder: &Builder, folder: &Path) -> io::Result<Unfinished> {
        // held meanwhile: none is made that is not known
        let mut paths = paths();
        let file = builder.tempfile_in(folder)?;
        paths.push(file.path().to_owned());
        Ok(Unfinished { _known: Known(file.path().to_owned()), file })
    }

    pub fn path(&self) -> &Path {
        self.file.path()
    }

    pub fn file(&mut self) -> &mut File {
        self.file.as_file_mut()
    }

    /// Gives it its name.
    pub fn persist(self, path: &Path) -> io::Result<()> {
        self.file.persist(path).map(drop).map_err(|e| e.error)
    }
}

/// Removes all of them, as the program ends. None is made any more as long as the answer is held.
pub fn remove_unfinished() -> impl Sized {
    let paths = paths();
    for path in paths.iter() {
        // there is nobody left to tell
        let _ = fs::remove_file(path);
    }
    paths
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_known_until_they_are_dropped_or_have_their_names() {
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

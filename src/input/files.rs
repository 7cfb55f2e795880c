//! Input files as a load found them, and whether they are still the same.

use indexmap::IndexSet;
use std::fs;
use std::path::{Component, Path, PathBuf};
use std::time::SystemTime;

/// Recorded files and their states, each once: [`Loading`](super::Loading) records them.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Inputs {
    files: IndexSet<(PathBuf, Stamp)>,
}

/// Modification time and size of a file; `None` if it does not exist.
pub type Stamp = Option<(SystemTime, u64)>;

impl Inputs {
    /// The files, each with its state when it was read.
    pub fn files(&self) -> impl Iterator<Item = (&Path, &Stamp)> {
        self.files.iter().map(|(path, found)| (path.as_path(), found))
    }

    /// Whether all files are unchanged.
    pub fn are_current(&self) -> bool {
        self.files.iter().all(|(path, found)| stamp(path) == *found)
    }

    pub(super) fn insert(&mut self, path: &Path, found: Stamp) {
        self.files.insert((path.to_owned(), found));
    }

    pub(super) fn add(&mut self, more: &Inputs) {
        self.files.extend(more.files.iter().cloned());
    }
}

/// The present state of a file.
pub fn stamp(path: &Path) -> Stamp {
    let found = fs::metadata(path).ok()?;
    Some((found.modified().ok()?, found.len()))
}

/// The file is in the folder or below, by its name and, if it exists, also by its real path.
pub fn is_below(name: &str, folder: &Path) -> bool {
    let mut depth = 0i32;
    for component in Path::new(name).components() {
        match component {
            Component::Normal(_) => depth += 1,
            Component::ParentDir if depth > 0 => depth -= 1,
            Component::CurDir => {}
            _ => return false,
        }
    }
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    match (folder.join(name).canonicalize(), folder.canonicalize()) {
        (Ok(file), Ok(folder)) => file.starts_with(folder),
        _ => true,
    }
}

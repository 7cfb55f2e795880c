//! Input files. All are read here and recorded, so that callers can ask which files some work depended on.

use indexmap::IndexSet;
use std::cell::RefCell;
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Component, Path, PathBuf};
use std::time::SystemTime;

thread_local! {
    /// What was read on this thread within each [`noted`], the innermost last.
    static NOTED: RefCell<Vec<Inputs>> = const { RefCell::new(Vec::new()) };
}

/// Recorded files and their states, each once.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Inputs {
    files: IndexSet<(PathBuf, Stamp)>,
}

/// Modification time and size of a file; `None` if it does not exist.
pub type Stamp = Option<(SystemTime, u64)>;

/// Most bytes read from a pipe: far more than any scene has.
const PIPE_MAX: u64 = 1 << 30;

/// The bytes of a file.
///
/// # Errors
/// If it cannot be read, or is not a regular file: a device may have no end, and a pipe no writer.
pub fn read(path: &Path) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    open(path)?.read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// The bytes of a file, or of a pipe that the program was started with: `/dev/stdin`, or `/dev/fd/N`, as a shell passes for
/// `<(command)`.
///
/// # Errors
/// Those of [`read`], and 1 GiB or more from a pipe.
pub fn read_or_pipe(path: &Path) -> io::Result<Vec<u8>> {
    if !is_own_pipe(path) {
        return read(path);
    }
    note(path);
    let mut bytes = Vec::new();
    File::open(path)?.take(PIPE_MAX).read_to_end(&mut bytes)?;
    match bytes.len() as u64 {
        PIPE_MAX => Err(io::Error::other("the pipe holds 1 GiB or more, which is too much for a pipe; use a file")),
        _ => Ok(bytes),
    }
}

/// The text of a file.
pub fn read_to_string(path: &Path) -> io::Result<String> {
    let mut text = String::new();
    open(path)?.read_to_string(&mut text)?;
    Ok(text)
}

/// A file, open to be read.
///
/// # Errors
/// Those of [`read`].
pub fn open(path: &Path) -> io::Result<File> {
    note(path);
    let kind = fs::metadata(path)?.file_type();
    if kind.is_file() {
        return File::open(path);
    }
    let what = if kind.is_dir() { "it is a folder" } else { "it is a pipe or a device, not a regular file" };
    Err(io::Error::other(what))
}

/// A pipe that the program was started with. Unlike a named pipe it has a writer, so reading it ends.
fn is_own_pipe(path: &Path) -> bool {
    #[cfg(unix)]
    let is_pipe = |found: fs::Metadata| std::os::unix::fs::FileTypeExt::is_fifo(&found.file_type());
    #[cfg(not(unix))]
    let is_pipe = |_: fs::Metadata| false;
    let is_own = path == Path::new("/dev/stdin") || path.starts_with("/dev/fd") || path.starts_with("/proc/self/fd");
    is_own && fs::metadata(path).is_ok_and(is_pipe)
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

/// Records a file, existing or not.
pub fn note(path: &Path) {
    note_all(&Inputs { files: IndexSet::from([(path.to_owned(), stamp(path))]) });
}

/// Records the input files of a cached result.
pub fn note_all(inputs: &Inputs) {
    NOTED.with_borrow_mut(|noted| {
        if let Some(noted) = noted.last_mut() {
            noted.add(inputs);
        }
    });
}

/// Calls `work`, and returns its result with the files recorded meanwhile on this thread.
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

    /// Whether all files are unchanged.
    pub fn are_current(&self) -> bool {
        self.files.iter().all(|(path, found)| stamp(path) == *found)
    }

    fn add(&mut self, more: &Inputs) {
        self.files.extend(more.files.iter().cloned());
    }
}

/// The present state of a file.
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

    /// In quadratic time this would take minutes.
    #[test]
    fn many_files_are_noted_in_linear_time() {
        let ((), found) = noted(|| (0..200_000).for_each(|k| note(&PathBuf::from(format!("no/such/{}", k % 100_000)))));
        assert_eq!(found.files().count(), 100_000);
    }

    /// None of these is opened: opening a pipe without a writer would hang.
    #[cfg(unix)]
    #[test]
    fn only_regular_files_are_read() {
        let dir = tempfile::tempdir().unwrap();
        let pipe = dir.path().join("pipe");
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        let link = dir.path().join("link");
        std::os::unix::fs::symlink("/dev/zero", &link).unwrap();
        for (path, says) in [
            (pipe.as_path(), "it is a pipe or a device, not a regular file"),
            (&link, "it is a pipe or a device, not a regular file"),
            (Path::new("/dev/zero"), "it is a pipe or a device, not a regular file"),
            (dir.path(), "it is a folder"),
        ] {
            assert_eq!(open(path).unwrap_err().to_string(), says);
            assert_eq!(read(path).unwrap_err().to_string(), says);
            assert_eq!(read_or_pipe(path).unwrap_err().to_string(), says);
            assert_eq!(read_to_string(path).unwrap_err().to_string(), says);
        }
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

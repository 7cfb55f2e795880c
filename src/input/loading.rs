//! A load of input files: its limits, and a record of the files that it has read.

use super::Prefix;
use super::files::{Inputs, stamp};
use super::limits::Limits;
use std::cell::{Ref, RefCell};
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::Path;

/// One load of a scene or of another input: its limits, and a record of its files, so that callers can ask which ones it depended on. All input
/// files are read through it. Threads cannot share it (it is not [`Sync`]): a thread that reads files has a
/// load of its own ([`Loading::beside`]), whose files are then added to this one.
#[derive(Debug, Default)]
pub struct Loading {
    limits: Limits,
    inputs: RefCell<Inputs>,
}

/// A pipe must hold fewer bytes. No scene has nearly so many.
const PIPE_MAX: u64 = 1 << 30;

impl Loading {
    pub fn new(limits: Limits) -> Loading {
        Loading { limits, inputs: RefCell::default() }
    }

    /// Another load within the same limits, whose files are recorded separately; [`Loading::note_all`] adds them to this one.
    pub fn beside(&self) -> Loading {
        Loading::new(self.limits)
    }

    pub fn limits(&self) -> Limits {
        self.limits
    }

    /// The files recorded so far.
    pub fn inputs(&self) -> Ref<'_, Inputs> {
        self.inputs.borrow()
    }

    /// Ends the load and returns the recorded files.
    pub fn into_inputs(self) -> Inputs {
        self.inputs.into_inner()
    }

    /// The bytes of a file.
    ///
    /// # Errors
    /// If it cannot be read, does not fit the free memory, or is not a regular file: a device may never end, and a pipe may have no writer.
    pub fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        self.prefix(path)?.read_all()
    }

    /// A file whose first bytes are read, for readers that may refuse it by these and its length.
    ///
    /// # Errors
    /// The errors of [`Loading::open`].
    pub fn prefix(&self, path: &Path) -> io::Result<Prefix> {
        Prefix::read(self.open(path)?, self.limits)
    }

    /// The bytes of a text file, or of a pipe that the program was started with: `/dev/stdin`, or `/dev/fd/N`, as a shell passes for
    /// `<(command)`.
    ///
    /// # Errors
    /// The errors of [`Loading::read`], a file that is no text, and 1 GiB or more from a pipe.
    pub fn read_or_pipe(&self, path: &Path) -> io::Result<Vec<u8>> {
        if !is_own_pipe(path) {
            let start = self.prefix(path)?;
            start.check_text()?;
            return start.read_all();
        }
        self.note(path);
        let mut bytes = Vec::new();
        File::open(path)?.take(PIPE_MAX).read_to_end(&mut bytes)?;
        match bytes.len() as u64 {
            PIPE_MAX => Err(io::Error::other("the pipe holds 1 GiB or more, which is too much for a pipe; use a file")),
            _ => Ok(bytes),
        }
    }

    /// The text of a file.
    ///
    /// # Errors
    /// The errors of [`Loading::read`], and bytes that are not UTF-8.
    pub fn read_to_string(&self, path: &Path) -> io::Result<String> {
        let start = self.prefix(path)?;
        start.check_text()?;
        let no_text = |_| io::Error::new(io::ErrorKind::InvalidData, "it is no UTF-8 text");
        String::from_utf8(start.read_all()?).map_err(no_text)
    }

    /// A file, open to be read.
    ///
    /// # Errors
    /// The errors of [`Loading::read`].
    pub fn open(&self, path: &Path) -> io::Result<File> {
        self.note(path);
        let kind = fs::metadata(path)?.file_type();
        if kind.is_file() {
            return File::open(path);
        }
        let what = if kind.is_dir() { "it is a folder" } else { "it is a pipe or a device, not a regular file" };
        Err(io::Error::other(what))
    }

    /// Records a file and its present state, whether or not it exists.
    pub fn note(&self, path: &Path) {
        self.inputs.borrow_mut().insert(path, stamp(path));
    }

    /// Records the input files of a cached result, or of another load.
    pub fn note_all(&self, inputs: &Inputs) {
        self.inputs.borrow_mut().add(inputs);
    }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::limits::CELLS;
    use std::path::PathBuf;

    #[test]
    fn what_is_read_is_noted_once_by_all_around_it() {
        let dir = tempfile::tempdir().unwrap();
        let path = |name: &str| dir.path().join(name);
        fs::write(path("a"), "1").unwrap();
        let outer = Loading::default();
        outer.read(&path("a")).unwrap();
        let inner = outer.beside();
        inner.open(&path("a")).unwrap();
        inner.read(&path("missing")).unwrap_err();
        outer.note_all(&inner.inputs());
        let (inner, outer) = (inner.into_inputs(), outer.into_inputs());
        assert_eq!(outer.files().map(|f| f.0).collect::<Vec<_>>(), [path("a"), path("missing")]);
        assert_eq!(inner, outer);
        assert!(outer.are_current());
        fs::write(path("missing"), "").unwrap();
        assert!(!outer.are_current());
        assert_eq!(Loading::default().into_inputs(), Inputs::default());
    }

    /// In quadratic time this would take minutes.
    #[test]
    fn many_files_are_noted_in_linear_time() {
        let loading = Loading::default();
        (0..200_000).for_each(|k| loading.note(&PathBuf::from(format!("no/such/{}", k % 100_000))));
        assert_eq!(loading.into_inputs().files().count(), 100_000);
    }

    #[test]
    fn loads_at_once_do_not_change_each_other() {
        let dir = tempfile::tempdir().unwrap();
        let both_began = std::sync::Barrier::new(2);
        let load = |name: &str, limits: Limits| {
            let path = dir.path().join(name);
            fs::write(&path, name).unwrap();
            let loading = Loading::new(limits);
            both_began.wait();
            loading.read(&path).unwrap();
            both_began.wait();
            let many = loading.limits().check(CELLS, CELLS.most + 1);
            let large = loading.limits().check_memory(1 << 50, "much work", "do less");
            let names: Vec<_> = loading.into_inputs().files().map(|(path, _)| path.to_owned()).collect();
            assert_eq!(names, [path]);
            (many.is_ok(), large.is_ok())
        };
        std::thread::scope(|scope| {
            let free = scope.spawn(|| load("a", Limits::none()));
            assert_eq!(load("b", Limits::default().memory(1 << 40)), (false, false));
            assert_eq!(free.join().unwrap(), (true, true));
        });
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
        let loading = Loading::default();
        for (path, says) in [
            (pipe.as_path(), "it is a pipe or a device, not a regular file"),
            (&link, "it is a pipe or a device, not a regular file"),
            (Path::new("/dev/zero"), "it is a pipe or a device, not a regular file"),
            (dir.path(), "it is a folder"),
        ] {
            assert_eq!(loading.open(path).unwrap_err().to_string(), says);
            assert_eq!(loading.read(path).unwrap_err().to_string(), says);
            assert_eq!(loading.read_or_pipe(path).unwrap_err().to_string(), says);
            assert_eq!(loading.read_to_string(path).unwrap_err().to_string(), says);
        }
    }

    #[test]
    fn a_file_of_another_size_is_another() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a");
        fs::write(&path, "1").unwrap();
        let loading = Loading::default();
        loading.read(&path).unwrap();
        let found = loading.into_inputs();
        fs::write(&path, "22").unwrap();
        assert!(!found.are_current());
    }
}

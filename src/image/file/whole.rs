//! Output files that are whole or not there: a temporary file beside the target, then a rename.

use std::fs::{self, File, TryLockError};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use super::place::{folder_of, real_path};
use super::stream::{self, PIPE_WAIT};
use super::unfinished::Unfinished;
use crate::input::{Error, Result};

/// Fills a temporary file with `fill` and renames it to `path`, replacing what was there. Where `path`
/// is a pipe or a device, the finished bytes are copied to it instead. The new file's permissions are
/// those that creating it would have given.
///
/// # Errors
/// [`Error::Write`] naming `path`; the target is then untouched and nothing is left beside it.
pub(crate) fn write_whole(path: &Path, fill: impl FnOnce(&mut Filled) -> io::Result<()>) -> Result<()> {
    let target = Target::of(path)?;
    target.write(fill).map_err(|e| {
        // A full disk has no path of its own in the error, a missing one has the temporary file's.
        let why = e.raw_os_error().map_or(e.to_string(), |code| io::Error::from_raw_os_error(code).to_string());
        let advice = match e.kind() {
            io::ErrorKind::FileTooLarge => "raise the limit on the size of files (ulimit -f), or choose another path",
            _ if is_full(&e) => "free the space or choose another path",
            _ => "choose another path",
        };
        let text = format!("{}: cannot be written: {why}; {advice}", path.display());
        if is_full(&e) { Error::Full(text) } else { Error::Write(text) }
    })
}

/// The disk is full, or the user's quota.
pub fn is_full(e: &io::Error) -> bool {
    matches!(e.kind(), io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded)
}

/// Finds, before any work is done, that `path` cannot be written: its folder is missing or refuses
/// new files, or it is a folder itself. Creates nothing that stays.
///
/// # Errors
/// [`Error::Write`] naming `path`.
pub fn check_writable(path: &Path) -> Result<()> {
    match Target::of(path)? {
        Target::Renamed { folder, .. } => {
            // what a killed run left there is of no use to anybody
            let _ = clear_up(&folder);
            let created = new_file_in(&folder).map(drop);
            created.map_err(|e| {
                let place = format!("the folder {} refuses new files", folder.display());
                let text = format!("{}: cannot be written: {place}; choose another path", path.display());
                if is_full(&e) { Error::Full(text) } else { Error::Write(text) }
            })
        }
        Target::Stream(_) => Ok(()),
    }
}

/// Writes `text` to `path`, whole or not at all.
///
/// # Errors
/// [`Error::Write`] naming `path`.
pub fn write_text(path: &Path, text: &str) -> Result<()> {
    write_whole(path, |file| file.write_all(text.as_bytes()))
}

/// Writes what `fill` writes to `path`, whole or not at all.
///
/// # Errors
/// [`Error::Write`] naming `path`.
#[cfg(feature = "cli")]
pub fn write_lines(path: &Path, fill: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<()> {
    write_whole(path, |file| {
        let mut writer = io::BufWriter::new(file);
        fill(&mut writer)?;
        writer.flush()
    })
}

/// A file that is being written. It records the first write error, because encoders wrap it in their own errors, where "disk full"
/// is lost, and buffered writers ignore it when dropped.
pub(crate) struct Filled<'f> {
    file: &'f mut File,
    refused: Option<io::Error>,
}

impl Filled<'_> {
    fn fill(file: &mut File, fill: impl FnOnce(&mut Filled) -> io::Result<()>) -> io::Result<()> {
        let mut filled = Filled { file, refused: None };
        let done = fill(&mut filled);
        filled.refused.map_or(done, Err)
    }

    fn keep<T>(&mut self, done: io::Result<T>) -> io::Result<T> {
        if let Err(e) = &done
            && e.kind() != io::ErrorKind::Interrupted
            && self.refused.is_none()
        {
            self.refused = Some(e.raw_os_error().map_or(e.kind().into(), io::Error::from_raw_os_error));
        }
        done
    }
}

impl Write for Filled<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let done = self.file.write(bytes);
        self.keep(done)
    }

    fn flush(&mut self) -> io::Result<()> {
        let done = self.file.flush();
        self.keep(done)
    }
}

impl Read for Filled<'_> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        self.file.read(bytes)
    }
}

impl Seek for Filled<'_> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.file.seek(to)
    }
}

/// How bytes reach a path.
enum Target {
    /// By a rename in `folder` to `file`, links resolved.
    Renamed { folder: PathBuf, file: PathBuf },
    /// A pipe or a device: a rename would replace it.
    Stream(PathBuf),
}

impl Target {
    fn of(path: &Path) -> Result<Target> {
        let wrong = |why: String| Error::Write(format!("{}: cannot be written: {why}", path.display()));
        match fs::metadata(path) {
            Ok(there) if there.is_dir() => return Err(wrong("it is a folder; name a file in it".into())),
            Ok(there) if !there.is_file() => return Ok(Target::Stream(path.into())),
            _ => {}
        }
        let file = real_path(path);
        if file.file_name().is_none() {
            return Err(wrong("it names no file; give a file name".into()));
        }
        let folder = folder_of(&file).to_owned();
        match fs::metadata(&folder) {
            Ok(there) if there.is_dir() => Ok(Target::Renamed { folder, file }),
            Ok(_) => Err(wrong(format!("{} is not a folder; choose another path", folder.display()))),
            Err(e) if e.kind() == io::ErrorKind::NotFound => {
                Err(wrong(format!("the folder {} does not exist; create it first", folder.display())))
            }
            Err(e) => Err(wrong(format!("the folder {} cannot be used: {e}", folder.display()))),
        }
    }

    fn write(&self, fill: impl FnOnce(&mut Filled) -> io::Result<()>) -> io::Result<()> {
        match self {
            Target::Renamed { folder, file } => {
                let mut temporary = new_file_in(folder)?;
                Filled::fill(temporary.file(), fill)?;
                // otherwise a crash of the machine may keep the rename and lose the bytes
                temporary.file().sync_data()?;
                temporary.persist(file)
            }
            Target::Stream(path) => {
                let mut temporary = tempfile::tempfile()?;
                Filled::fill(&mut temporary, fill)?;
                temporary.rewind()?;
                io::copy(&mut temporary, &mut stream::open(path, PIPE_WAIT)?).map(drop)
            }
        }
    }
}

/// Opens a file for appending, and creates it if it does not exist.
///
/// # Errors
/// Those of the system, and a timeout if `path` is a pipe without a reader.
#[cfg(feature = "cli")]
pub fn open_to_append(path: &Path) -> io::Result<File> {
    match fs::metadata(path) {
        Ok(there) if !there.is_file() && !there.is_dir() => stream::open(path, PIPE_WAIT),
        _ => File::options().create(true).append(true).open(path),
    }
}

/// What the names of temporary files begin and end with.
const NAME: [&str; 2] = [".anamorph-", ".tmp"];

/// Locked as long as it is open, where the file system can.
fn new_file_in(folder: &Path) -> io::Result<Unfinished> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(NAME[0]).suffix(NAME[1]);
    ordinary_permissions(&mut builder);
    loop {
        let mut file = Unfinished::new(&builder, folder)?;
        // whoever clears up may have taken it before it was locked
        match file.file().try_lock() {
            Err(TryLockError::WouldBlock) => {}
            _ if file.path().exists() => return Ok(file),
            _ => {}
        }
    }
}

/// Removes temporary files that nobody writes any more from a folder: those of programs that were killed.
///
/// # Errors
/// [`Error::Work`] if the folder cannot be read or changed.
pub fn clear_up(folder: &Path) -> Result<()> {
    let failed = |e: io::Error| Error::work(format!("{}: cannot be cleared up: {e}", folder.display()));
    for entry in fs::read_dir(folder).map_err(failed)? {
        let entry = entry.map_err(failed)?;
        let name = entry.file_name();
        let is_named = name.to_str().is_some_and(|n| n.starts_with(NAME[0]) && n.ends_with(NAME[1]));
        let is_ours = is_named && entry.file_type().is_ok_and(|kind| kind.is_file());
        let locked = || File::open(entry.path()).ok().filter(|file| file.try_lock().is_ok());
        // held until it is gone, so that nobody takes it for its own
        if let Some(_locked) = is_ours.then(locked).flatten() {
            match fs::remove_file(entry.path()) {
                Err(e) if e.kind() != io::ErrorKind::NotFound => return Err(failed(e)),
                _ => {}
            }
        }
    }
    Ok(())
}

/// Read and write for all, from which the system takes the umask away as for any new file.
#[cfg(unix)]
fn ordinary_permissions(builder: &mut tempfile::Builder) {
    use std::os::unix::fs::PermissionsExt;
    builder.permissions(fs::Permissions::from_mode(0o666));
}

#[cfg(not(unix))]
fn ordinary_permissions(_: &mut tempfile::Builder) {}

#[cfg(test)]
mod tests {
    use super::*;

    fn names_in(folder: &Path) -> Vec<String> {
        fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().to_string_lossy().into_owned()).collect()
    }

    #[test]
    fn a_failed_write_leaves_the_old_file_and_nothing_else() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.txt");
        write_text(&path, "old").unwrap();
        let failed = write_whole(&path, |file| {
            file.write_all(b"half")?;
            Err(io::Error::from(io::ErrorKind::StorageFull))
        });
        let message = failed.clone().unwrap_err().to_string();
        assert!(matches!(failed, Err(Error::Full(_))) && message.contains("a.txt"), "{message}");
        assert_eq!(fs::read_to_string(&path).unwrap(), "old");
        assert_eq!(names_in(dir.path()), ["a.txt"]);
    }

    #[test]
    fn only_files_that_nobody_writes_are_cleared_up() {
        let dir = tempfile::tempdir().unwrap();
        for name in [".anamorph-old.tmp", "a.tmp", ".anamorph-b"] {
            fs::write(dir.path().join(name), "x").unwrap();
        }
        let open = new_file_in(dir.path()).unwrap();
        clear_up(dir.path()).unwrap();
        let name = open.path().file_name().unwrap().to_string_lossy().into_owned();
        let mut left = names_in(dir.path());
        left.sort();
        let mut expected = vec![name, "a.tmp".to_owned(), ".anamorph-b".to_owned()];
        expected.sort();
        assert_eq!(left, expected);
        drop(open);
        assert!(clear_up(&dir.path().join("no")).is_err());
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn the_error_of_the_file_is_kept_whatever_its_encoder_returns() {
        let mut full = File::options().write(true).open("/dev/full").unwrap();
        let wrapped = Filled::fill(&mut full, |file| {
            file.write_all(b"x").map_err(|e| io::Error::other(format!("an encoder failed: {e}")))
        });
        let swallowed = Filled::fill(&mut full, |file| {
            let _ = io::BufWriter::new(file).write_all(b"x");
            Ok(())
        });
        assert!(is_full(&wrapped.unwrap_err()) && is_full(&swallowed.unwrap_err()));
        let own = Filled::fill(&mut full, |_| Err(io::Error::other("its own"))).unwrap_err();
        assert_eq!(own.to_string(), "its own");
    }

    #[cfg(unix)]
    #[test]
    fn permissions_are_those_of_any_new_file() {
        use std::os::unix::fs::PermissionsExt;
        let dir = tempfile::tempdir().unwrap();
        let (ours, plain) = (dir.path().join("ours"), dir.path().join("plain"));
        write_text(&ours, "x").unwrap();
        fs::write(&plain, "x").unwrap();
        let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode();
        assert_eq!(mode(&ours), mode(&plain));
    }

    #[cfg(unix)]
    #[test]
    fn links_and_devices_stay_what_they_are() {
        let dir = tempfile::tempdir().unwrap();
        let (real, link) = (dir.path().join("real"), dir.path().join("link"));
        fs::write(&real, "old").unwrap();
        std::os::unix::fs::symlink(&real, &link).unwrap();
        write_text(&link, "new").unwrap();
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(fs::read_to_string(&real).unwrap(), "new");
        // even if they lead to a file that does not exist yet
        let (new, to_new) = (dir.path().join("new"), dir.path().join("to-new"));
        std::os::unix::fs::symlink("new", &to_new).unwrap();
        write_text(&to_new, "new").unwrap();
        assert!(fs::symlink_metadata(&to_new).unwrap().is_symlink() && new.is_file());
        let sink = Path::new("/dev/null");
        check_writable(sink).unwrap();
        write_text(sink, "gone").unwrap();
        assert!(!fs::metadata(sink).unwrap().is_file());
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_full_device_is_named() {
        let full = write_text(Path::new("/dev/full"), "x").unwrap_err();
        assert!(full.to_string().starts_with("/dev/full: cannot be written: No space left"), "{full}");
        assert_eq!(full.exit_code(), 1);
    }

    #[test]
    fn missing_folders_are_found_before_the_work() {
        let dir = tempfile::tempdir().unwrap();
        for (path, why) in [
            (dir.path().join("no/a.png"), "does not exist; create it first"),
            (dir.path().to_path_buf(), "it is a folder"),
            (PathBuf::new(), "it names no file"),
            (PathBuf::from("/"), "it is a folder"),
        ] {
            let error = check_writable(&path).unwrap_err();
            assert!(error.exit_code() == 1 && error.to_string().contains(why), "{error}");
            assert_eq!(write_text(&path, "x").unwrap_err(), error);
        }
        fs::write(dir.path().join("file"), "x").unwrap();
        assert!(check_writable(&dir.path().join("file/a.png")).is_err());
        check_writable(&dir.path().join("new.png")).unwrap();
        assert_eq!(names_in(dir.path()), ["file"]);
    }
}

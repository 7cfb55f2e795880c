//! Output files that are whole or not there: a temporary file beside the target, then a rename.

use std::fs::{self, File, TryLockError};
use std::io::{self, BufWriter, Seek, Write};
use std::path::{Path, PathBuf};

use crate::error::{Error, Result};

/// Fills a temporary file with `fill` and renames it to `path`, replacing what was there. Where `path`
/// is a pipe or a device, the finished bytes are copied to it instead. The new file's permissions are
/// those that creating it would have given.
///
/// # Errors
/// [`Error::Work`] naming `path`; the target is then untouched and nothing is left beside it.
pub(super) fn write_whole(path: &Path, fill: impl FnOnce(&mut File) -> io::Result<()>) -> Result<()> {
    let target = Target::of(path)?;
    target.write(fill).map_err(|e| {
        // A full disk has no path of its own in the error, a missing one has the temporary file's.
        let why = e.raw_os_error().map_or(e.to_string(), |code| io::Error::from_raw_os_error(code).to_string());
        let text = format!("{}: cannot be written: {why}; free the space or choose another path", path.display());
        if is_full(&e) { Error::Full(text) } else { Error::Work(text) }
    })
}

/// There is no room for more.
pub fn is_full(e: &io::Error) -> bool {
    matches!(e.kind(), io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded)
}

/// Finds, before any work is done, that `path` cannot be written: its folder is missing or refuses
/// new files, or it is a folder itself. Creates nothing that stays.
///
/// # Errors
/// [`Error::Work`] naming `path`.
pub fn check_writable(path: &Path) -> Result<()> {
    match Target::of(path)? {
        Target::Renamed { folder, .. } => {
            let created = new_file_in(&folder).map(drop);
            created.map_err(|e| {
                let place = format!("the folder {} refuses new files", folder.display());
                let text = format!("{}: cannot be written: {place}; choose another path", path.display());
                if is_full(&e) { Error::Full(text) } else { Error::Work(text) }
            })
        }
        Target::Stream(_) => Ok(()),
    }
}

/// Writes `text` to `path`, whole or not at all.
///
/// # Errors
/// [`Error::Work`] naming `path`.
pub fn write_text(path: &Path, text: &str) -> Result<()> {
    write_whole(path, |file| file.write_all(text.as_bytes()))
}

/// Writes what `fill` writes to `path`, whole or not at all.
///
/// # Errors
/// [`Error::Work`] naming `path`.
pub fn write_lines(path: &Path, fill: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<()> {
    write_whole(path, |file| {
        let mut writer = BufWriter::new(file);
        fill(&mut writer)?;
        writer.flush()
    })
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
        let wrong = |why: String| Error::work(format!("{}: cannot be written: {why}", path.display()));
        let resolved = match fs::metadata(path) {
            Ok(there) if there.is_dir() => return Err(wrong("it is a folder; name a file in it".into())),
            Ok(there) if !there.is_file() => return Ok(Target::Stream(path.into())),
            Ok(_) => fs::canonicalize(path).unwrap_or_else(|_| path.into()),
            Err(_) => path.into(),
        };
        let (Some(parent), Some(_)) = (resolved.parent(), resolved.file_name()) else {
            return Err(wrong("it names no file; give a file name".into()));
        };
        let folder = if parent.as_os_str().is_empty() { PathBuf::from(".") } else { parent.into() };
        match fs::metadata(&folder) {
            Ok(there) if there.is_dir() => Ok(Target::Renamed { folder, file: resolved }),
            Ok(_) => Err(wrong(format!("{} is not a folder; choose another path", folder.display()))),
            Err(e) if e.kind() == io::ErrorKind::NotFound => {
                Err(wrong(format!("the folder {} does not exist; create it first", folder.display())))
            }
            Err(e) => Err(wrong(format!("the folder {} cannot be used: {e}", folder.display()))),
        }
    }

    fn write(&self, fill: impl FnOnce(&mut File) -> io::Result<()>) -> io::Result<()> {
        match self {
            Target::Renamed { folder, file } => {
                let mut temporary = new_file_in(folder)?;
                fill(temporary.as_file_mut())?;
                temporary.persist(file).map_err(|e| e.error)?;
            }
            Target::Stream(path) => {
                let mut temporary = tempfile::tempfile()?;
                fill(&mut temporary)?;
                temporary.rewind()?;
                io::copy(&mut temporary, &mut File::options().write(true).open(path)?)?;
            }
        }
        Ok(())
    }
}

/// What the names of temporary files begin and end with.
const NAME: [&str; 2] = [".anamorph-", ".tmp"];

/// Locked as long as it is open, where the file system can.
fn new_file_in(folder: &Path) -> io::Result<tempfile::NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(NAME[0]).suffix(NAME[1]);
    ordinary_permissions(&mut builder);
    loop {
        let file = builder.tempfile_in(folder)?;
        // whoever clears up may have taken it before it was locked
        match file.as_file().try_lock() {
            Err(TryLockError::WouldBlock) => {}
            _ if file.path().exists() => return Ok(file),
            _ => {}
        }
    }
}

/// Removes temporary files that nobody writes any more from a folder: those of programs that were killed.
///
/// # Errors
/// [`Error::Work`] where the folder cannot be read or changed.
pub fn clear_up(folder: &Path) -> Result<()> {
    let failed = |e: io::Error| Error::work(format!("{}: cannot be cleared up: {e}", folder.display()));
    for entry in fs::read_dir(folder).map_err(failed)? {
        let entry = entry.map_err(failed)?;
        let name = entry.file_name();
        let is_ours = name.to_str().is_some_and(|n| n.starts_with(NAME[0]) && n.ends_with(NAME[1]));
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

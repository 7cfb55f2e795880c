//! Identity of files: whether two paths lead to the same file, even if it does not exist yet.

use std::collections::hash_map::DefaultHasher;
use std::fs::{self, Metadata};
use std::hash::{Hash, Hasher};
use std::path::{Path, PathBuf};

/// Symbolic links that are followed from a path to a file that does not exist: as many as Linux follows.
const LINKS_MAX: u32 = 40;

/// The absolute path with symbolic links and `..` resolved. If its folder does not exist, the path as it is.
pub fn real_path(path: &Path) -> PathBuf {
    let mut path = path.to_owned();
    for _ in 0..LINKS_MAX {
        match (fs::canonicalize(&path), fs::read_link(&path)) {
            (Ok(real), _) => return real,
            (_, Ok(to)) => path = folder_of(&path).join(to),
            _ => break,
        }
    }
    match (fs::canonicalize(folder_of(&path)), path.file_name()) {
        (Ok(folder), Some(name)) => folder.join(name),
        _ => path,
    }
}

/// The folder that a file lies in.
pub fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// A number that is the same for all paths to one file. `None` for folders, pipes and devices.
pub fn identity(path: &Path) -> Option<u64> {
    let mut hasher = DefaultHasher::new();
    match fs::metadata(path) {
        Ok(there) if !there.is_file() => return None,
        Ok(there) => hash_file(&there, path, &mut hasher),
        Err(_) => return Some(identity_of_new(&real_path(path))),
    }
    Some(hasher.finish())
}

/// The identity of a file that does not exist yet, by its [`real_path`].
pub fn identity_of_new(real_path: &Path) -> u64 {
    let mut hasher = DefaultHasher::new();
    real_path.hash(&mut hasher);
    hasher.finish()
}

/// Hard links to one file have the same device and inode.
#[cfg(unix)]
fn hash_file(there: &Metadata, _: &Path, hasher: &mut impl Hasher) {
    use std::os::unix::fs::MetadataExt;
    (there.dev(), there.ino()).hash(hasher);
}

#[cfg(not(unix))]
fn hash_file(_: &Metadata, path: &Path, hasher: &mut impl Hasher) {
    real_path(path).hash(hasher);
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::os::unix::fs::symlink;

    #[test]
    fn all_paths_to_a_file_have_one_identity() {
        let dir = tempfile::tempdir().unwrap();
        let path = |name: &str| dir.path().join(name);
        fs::create_dir(path("in")).unwrap();
        fs::write(path("a"), "a").unwrap();
        fs::write(path("other"), "a").unwrap();
        fs::hard_link(path("a"), path("hard")).unwrap();
        symlink("a", path("soft")).unwrap();
        symlink(".", path("here")).unwrap();
        symlink("in/new", path("to-new")).unwrap();
        symlink("to-new", path("to-to-new")).unwrap();
        for same in ["hard", "soft", "in/../a", "here/a", "here/here/soft"] {
            assert_eq!(identity(&path(same)), identity(&path("a")), "{same}");
        }
        for same in ["to-new", "to-to-new", "here/in/new", "in/../in/new"] {
            assert_eq!(real_path(&path(same)), real_path(&path("in/new")), "{same}");
            assert_eq!(identity(&path(same)), identity(&path("in/new")), "{same}");
        }
        for other in ["other", "new", "in/a"] {
            assert!(![identity(&path("a")), identity(&path("in/new"))].contains(&identity(&path(other))), "{other}");
        }
    }

    #[test]
    fn only_files_have_an_identity() {
        let dir = tempfile::tempdir().unwrap();
        assert_eq!((identity(dir.path()), identity(Path::new("/dev/null"))), (None, None));
        symlink("b", dir.path().join("a")).unwrap();
        symlink("a", dir.path().join("b")).unwrap();
        // a cycle of links
        assert!(identity(&dir.path().join("a")).is_some());
    }
}

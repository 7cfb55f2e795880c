//! Output files, looked at before any work is done: none may replace a file that is read, another output, or a file of another kind.

use crate::error::{Error, Result};
use crate::inputs::Inputs;
use crate::output::{check_writable, folder_of, identity, identity_of_new, real_path};
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

/// What is written to a file.
#[derive(Debug, Clone, Copy)]
pub struct Kind {
    /// As in "this is not".
    name: &'static str,
    /// A file with one of these endings may be replaced.
    endings: &'static [&'static str],
    /// So may one that begins as this program's own do.
    begins: fn(&[u8]) -> bool,
}

pub const PICTURE: Kind =
    Kind { name: "a PNG", endings: &["png"], begins: |head| head.starts_with(b"\x89PNG\r\n\x1a\n") };
pub const EXR: Kind = Kind { name: "an EXR", endings: &["exr"], begins: |head| head.starts_with(b"\x76\x2f\x31\x01") };
pub const POINTS: Kind = Kind {
    name: "a PLY or NumPy array",
    endings: &["ply", "npy"],
    begins: |head| head.starts_with(b"ply\n") || head.starts_with(NUMPY),
};
pub const RAYS: Kind = Kind { name: "a NumPy array", endings: &["npy"], begins: |head| head.starts_with(NUMPY) };
pub const REPORT: Kind =
    Kind { name: "a report", endings: &["json"], begins: |head| head.starts_with(b"{\n  \"version\": \"") };
pub const PIECES: Kind = Kind {
    name: "a camera's pieces",
    endings: &["json"],
    begins: |head| head.starts_with(b"{\n  \"vertices\": [") || head.starts_with(b"{\n  \"layers\": ["),
};
pub const POVRAY: Kind = Kind {
    name: "a scene of POV-Ray",
    endings: &["pov", "inc"],
    begins: |head| head.starts_with(b"// The rays of a "),
};
pub const DIAGRAM: Kind = Kind { name: "an SVG", endings: &["svg"], begins: |head| head.starts_with(b"<svg ") };
pub const IMAGES: Kind = Kind {
    name: "a list of images",
    endings: &["jsonl", "json", "ndjson"],
    begins: |head| head.starts_with(b"{\"point\":["),
};
pub const TABLE: Kind = Kind { name: "a table", endings: &["csv"], begins: |head| head.starts_with(b"job,frame,") };
pub const LOG: Kind = Kind {
    name: "a log",
    endings: &["log", "txt"],
    // after a time of 24 characters
    begins: |head| head.get(23..).is_some_and(|rest| rest.starts_with(b"Z start: ")),
};
pub const DRIVER: Kind = Kind {
    name: "a driver",
    endings: &["py"],
    begins: |head| head.starts_with(&super::batch::RAY_DRIVER.as_bytes()[..64]),
};
/// Its name is not asked for, so only one of ours is replaced; one that ends at once is of a program that was killed.
pub const MANIFEST: Kind = Kind {
    name: "a manifest",
    endings: &[],
    begins: |head| head.starts_with(b"{\"frame\":") || b"{\"frame\":".starts_with(head),
};
/// So it is with this one.
pub const PAGE: Kind = Kind {
    name: "a page of anamorph bench",
    endings: &[],
    begins: |head| {
        let title = b"<title>anamorph: ";
        head.windows(title.len()).any(|own| own == title)
    },
};

const NUMPY: &[u8] = b"\x93NUMPY";

/// As much of a file tells whose it is.
const HEAD: u64 = 512;

/// Files that are written, each by one output.
#[derive(Default)]
pub struct Outputs {
    /// Which output each file is, by what tells it from others: a list may be of millions.
    owners: HashMap<u64, usize>,
    /// Some of them are there already.
    are_there: bool,
    /// The real paths of the folders that new files go to.
    folders: HashMap<PathBuf, PathBuf>,
}

impl Outputs {
    /// Takes up a file as output number `owner`.
    pub fn take(&mut self, path: &Path, owner: usize) -> Taken {
        let is_there = path.symlink_metadata().is_ok();
        let own = if is_there { identity(path) } else { Some(self.identity_of_new(path)) };
        // pipes and devices may take more than one
        let Some(own) = own else { return Taken { first: None, is_there: false } };
        let is_there = is_there && path.is_file();
        self.are_there |= is_there;
        let first = match self.owners.entry(own) {
            Entry::Vacant(free) => {
                free.insert(owner);
                None
            }
            Entry::Occupied(taken) => Some(*taken.get()),
        };
        Taken { first, is_there }
    }

    fn identity_of_new(&mut self, path: &Path) -> u64 {
        let (folder, Some(name)) = (folder_of(path), path.file_name()) else {
            return identity_of_new(path);
        };
        if !self.folders.contains_key(folder) {
            self.folders.insert(folder.to_owned(), folder.canonicalize().unwrap_or_else(|_| folder.to_owned()));
        }
        identity_of_new(&self.folders[folder].join(name))
    }

    /// The number of the output that a file is.
    pub fn owner(&self, path: &Path) -> Option<usize> {
        identity(path).and_then(|own| self.owners.get(&own).copied())
    }

    /// The first of these files that is an output, and the number of that output.
    pub fn among<'a>(&self, inputs: &'a Inputs) -> Option<(&'a Path, usize)> {
        // a file that is there is none that is not
        let mut asked = inputs.files().filter(|(_, found)| self.are_there || found.is_none());
        asked.find_map(|(path, _)| Some((path, self.owner(path)?)))
    }
}

/// How a file stands that is taken up.
pub struct Taken {
    /// The number of an earlier output that is the same file.
    pub first: Option<usize>,
    pub is_there: bool,
}

/// Finds that one of `outputs` cannot be written, is another one of them too, is a file that is read, or would replace a file of
/// another kind.
///
/// # Errors
/// [`Error::Input`] for a file that must not be replaced, [`Error::Work`] for one that cannot be written.
pub fn check<'a>(inputs: &Inputs, outputs: impl Iterator<Item = (&'a Path, Kind)> + Clone) -> Result<()> {
    let mut taken = Outputs::default();
    for (k, (path, _)) in outputs.clone().enumerate() {
        if taken.take(path, k).first.is_some() {
            let name = path.display();
            return Err(Error::input(format!("{name}: named twice; give each output a name of its own")));
        }
    }
    if let Some((input, k)) = taken.among(inputs) {
        let output = outputs.clone().nth(k).map_or(input, |(path, _)| path);
        return Err(is_read(output, input));
    }
    for (path, kind) in outputs {
        kind.check(path)?;
        check_writable(path)?;
    }
    Ok(())
}

/// That an output is a file that is read.
pub fn is_read(output: &Path, input: &Path) -> Error {
    let name = if output == input { String::new() } else { format!(", as {}", input.display()) };
    Error::input(format!("{}: it is read too{name}; choose another name for the output", output.display()))
}

/// Refuses a file that a scene names outside of its own folder: whoever made the scene may have meant harm.
///
/// # Errors
/// [`Error::Input`] naming the file.
pub fn check_inside(scene: &Path, output: &Path) -> Result<()> {
    let own = real_path(scene);
    let folder = own.parent().unwrap_or(Path::new("/"));
    if real_path(output).starts_with(folder) {
        return Ok(());
    }
    let (scene, output) = (scene.display(), output.display());
    let advice = "name the output on the command line, or allow this by --outputs-anywhere";
    Err(Error::input(format!("{scene}: its [output] is not in the scene's folder: {output}; {advice}")))
}

impl Kind {
    /// Refuses to replace a file that is not empty, has none of the endings of this kind, and does not begin as one of this kind.
    ///
    /// # Errors
    /// [`Error::Input`] naming the file.
    pub fn check(&self, path: &Path) -> Result<()> {
        let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase());
        if ending.is_some_and(|own| self.endings.contains(&own.as_str())) || !path.is_file() || self.is_ours(path) {
            return Ok(());
        }
        let (path, kind) = (path.display(), self.name);
        let advice = match self.endings.first() {
            Some(ending) => format!("choose a name that ends with .{ending}, or remove it first"),
            None => "remove it or move it elsewhere".into(),
        };
        Err(Error::input(format!("{path}: is there already, and is not {kind}; {advice}")))
    }

    /// A file is empty or begins as this program's own.
    pub fn is_ours(&self, path: &Path) -> bool {
        let mut head = Vec::new();
        let read = File::open(path).and_then(|file| file.take(HEAD).read_to_end(&mut head));
        read.is_ok() && (head.is_empty() || (self.begins)(&head))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn only_files_of_their_kind_are_replaced() {
        let dir = tempfile::tempdir().unwrap();
        let path = |name: &str| dir.path().join(name);
        let files: [(&str, &[u8], Kind, bool); 12] = [
            ("a.png", b"no picture", PICTURE, true),
            ("b.PNG", b"no picture", PICTURE, true),
            ("bashrc", b"alias ls=ls", PICTURE, false),
            ("c.obj", b"v 0 0 0", EXR, false),
            ("d", b"\x89PNG\r\n\x1a\n....", PICTURE, true),
            ("e", b"\x89PNG\r\n\x1a\n....", EXR, false),
            ("f", b"", LOG, true),
            ("g", b"2026-11-24T09:18:32.123Z start: 3 frames\n", LOG, true),
            ("h", b"2026-11-24T09:18:32.123Z stop: 3 frames\n", LOG, false),
            ("i.jsonl", b"{\"frame\":\"job.0\"", MANIFEST, true),
            ("j.jsonl", b"{\"fra", MANIFEST, true),
            ("k.jsonl", b"{\"scene\":", MANIFEST, false),
        ];
        for (name, content, kind, fits) in files {
            fs::write(path(name), content).unwrap();
            assert_eq!(kind.check(&path(name)).is_ok(), fits, "{name}");
        }
        assert!(PICTURE.check(&path("new")).is_ok());
    }

    #[test]
    fn what_this_program_wrote_begins_as_it_says() {
        use crate::output::{write_exr, write_npy_f64, write_ply, write_png};
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("file");
        let frame = crate::frame::Frame {
            width: 1,
            height: 1,
            planes: vec![(crate::frame::Channel::Z, crate::frame::Plane::F32(vec![1.0]))],
        };
        write_png(&path, 1, 1, &[0; 3]).unwrap();
        assert!(PICTURE.is_ours(&path));
        write_exr(&path, &frame, &[]).unwrap();
        assert!(EXR.is_ours(&path));
        write_npy_f64(&path, &[1, 3], &[0.0; 3]).unwrap();
        assert!(POINTS.is_ours(&path) && RAYS.is_ours(&path));
        write_ply(&path, &[]).unwrap();
        assert!(POINTS.is_ours(&path) && !RAYS.is_ours(&path));
    }

    #[test]
    fn a_scene_names_files_of_its_folder() {
        let dir = tempfile::tempdir().unwrap();
        let path = |name: &str| dir.path().join(name);
        fs::create_dir_all(path("own/in")).unwrap();
        let scene = path("own/scene.toml");
        fs::write(&scene, "").unwrap();
        for (name, is_inside) in [
            ("own/a.png", true),
            ("own/in/a.png", true),
            ("own/../own/a.png", true),
            ("a.png", false),
            ("own/../a.png", false),
        ] {
            assert_eq!(check_inside(&scene, &path(name)).is_ok(), is_inside, "{name}");
        }
        assert!(check_inside(&scene, Path::new("/dev/null")).is_err());
    }
}

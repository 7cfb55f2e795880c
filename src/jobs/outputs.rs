//! Checks of output files, before any work is done: none may replace an input, another output, or a file of another kind.

use crate::image::{check_writable, folder_of, identity, identity_of_new, real_path};
use crate::input::files::Inputs;
use crate::input::{Error, Result};
use std::collections::HashMap;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

/// A kind of output. It may replace an existing file of the same kind.
#[derive(Debug, Clone, Copy)]
pub struct Kind {
    /// With an article, for messages.
    pub name: &'static str,
    /// Extensions of this kind. A file with one of them may be replaced.
    endings: &'static [&'static str],
    /// Whether a file that begins with these bytes is one that this program wrote. It may be replaced, whatever its name.
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
pub const GRADIENTS: Kind =
    Kind { name: "a list of gradients", endings: &[], begins: |head| head.starts_with(b"{\n  \"camera\": [") };
pub const REPORT: Kind =
    Kind { name: "a report", endings: &["json"], begins: |head| head.starts_with(b"{\n  \"version\": \"") };
#[cfg(feature = "cli")]
pub const PIECES: Kind = Kind {
    name: "a camera's pieces",
    endings: &["json"],
    begins: |head| head.starts_with(b"{\n  \"vertices\": [") || head.starts_with(b"{\n  \"layers\": ["),
};
#[cfg(feature = "cli")]
pub const POVRAY: Kind =
    Kind { name: "a POV-Ray scene", endings: &["pov", "inc"], begins: |head| head.starts_with(b"// The rays of a ") };
#[cfg(feature = "cli")]
pub const DIAGRAM: Kind = Kind { name: "an SVG", endings: &["svg"], begins: |head| head.starts_with(b"<svg ") };
#[cfg(feature = "cli")]
pub const IMAGES: Kind = Kind {
    name: "a list of images",
    endings: &["jsonl", "json", "ndjson"],
    begins: |head| head.starts_with(b"{\"point\":["),
};
#[cfg(feature = "cli")]
pub const TABLE: Kind = Kind { name: "a table", endings: &["csv"], begins: |head| head.starts_with(b"job,frame,") };
pub const LOG: Kind = Kind {
    name: "a log",
    endings: &["log", "txt"],
    // after the time, whose last character is the Z
    begins: |head| head.get(23..).is_some_and(|rest| rest.starts_with(b"Z start: ")),
};
#[cfg(feature = "cli")]
pub const DRIVER: Kind = Kind {
    name: "a driver",
    endings: &["py"],
    begins: |head| head.starts_with(&super::batch::RAY_DRIVER.as_bytes()[..64]),
};
/// The user does not choose its name, so only a manifest that this program wrote is replaced. One that ends within the first key was cut
/// off when the program was killed.
pub const MANIFEST: Kind = Kind {
    name: "a manifest",
    endings: &[],
    begins: |head| head.starts_with(b"{\"frame\":") || b"{\"frame\":".starts_with(head),
};
/// The user does not choose its name either.
#[cfg(feature = "internals")]
pub const PAGE: Kind = Kind {
    name: "a page of anamorph bench",
    endings: &[],
    begins: |head| {
        let title = b"<title>anamorph: ";
        head.windows(title.len()).any(|own| own == title)
    },
};

const NUMPY: &[u8] = b"\x93NUMPY";

/// Bytes of a file that [`Kind::begins`] is given: the title of a page ends before.
const HEAD: u64 = 512;

/// The files that a command writes, and which output each of them is.
#[derive(Default)]
pub struct Outputs {
    /// The number of the output, by the identity of its file: 16 bytes each, as a batch may have millions.
    owners: HashMap<u64, usize>,
    /// At least one of the files exists.
    any_exists: bool,
    /// The real paths of the folders that new files are written to.
    folders: HashMap<PathBuf, PathBuf>,
}

impl Outputs {
    /// Adds the file of output number `owner`.
    pub fn add(&mut self, path: &Path, owner: usize) -> Added {
        let exists = path.symlink_metadata().is_ok();
        let own = if exists { identity(path) } else { Some(self.identity_of_new(path)) };
        // several outputs may go to one pipe or device
        let Some(own) = own else { return Added { first: None, exists: false } };
        let exists = exists && path.is_file();
        self.any_exists |= exists;
        let first = self.owners.get(&own).copied();
        self.owners.entry(own).or_insert(owner);
        Added { first, exists }
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

    /// The number of the output that is written to this file.
    pub fn owner(&self, path: &Path) -> Option<usize> {
        identity(path).and_then(|own| self.owners.get(&own).copied())
    }

    /// The first input that is also an output, and the number of that output.
    pub fn first_input<'a>(&self, inputs: &'a Inputs) -> Option<(&'a Path, usize)> {
        // if no output exists, an input that exists cannot be one of them
        let mut candidates = inputs.files().filter(|(_, found)| self.any_exists || found.is_none());
        candidates.find_map(|(path, _)| Some((path, self.owner(path)?)))
    }
}

/// A file that was added to [`Outputs`].
pub struct Added {
    /// The number of an earlier output to the same file.
    pub first: Option<usize>,
    pub exists: bool,
}

/// Refuses an output that cannot be written, goes to the same file as another, is an input, or would replace a file of another kind.
///
/// # Errors
/// [`Error::Input`] for a file that must not be replaced, [`Error::Write`] for one that cannot be written.
pub fn check<'a>(inputs: &Inputs, outputs: impl Iterator<Item = (&'a Path, Kind)> + Clone) -> Result<()> {
    let mut all = Outputs::default();
    for (k, (path, _)) in outputs.clone().enumerate() {
        if all.add(path, k).first.is_some() {
            let name = path.display();
            return Err(Error::input(format!("{name}: named twice; give each output its own name")));
        }
    }
    if let Some((input, k)) = all.first_input(inputs) {
        let output = outputs.clone().nth(k).map_or(input, |(path, _)| path);
        let name = if output == input { String::new() } else { format!(", {}", input.display()) };
        let output = output.display();
        return Err(Error::input(format!("{output}: is also an input{name}; choose another name for the output")));
    }
    for (path, kind) in outputs {
        kind.check(path)?;
        check_writable(path)?;
    }
    Ok(())
}

/// Refuses an output that a scene names outside of its own folder: a scene from elsewhere must not replace files of the user.
///
/// # Errors
/// [`Error::Input`] naming the file.
pub fn check_inside(scene: &Path, output: &Path) -> Result<()> {
    let own = real_path(scene);
    let folder = own.parent().unwrap_or(Path::new("/"));
    let real = real_path(output);
    // in a folder that does not exist nothing can be replaced: `check` reports it
    if real.starts_with(folder) || !folder_of(&real).exists() {
        return Ok(());
    }
    let (scene, output) = (scene.display(), output.display());
    let advice = "name the output on the command line, or use --outputs-anywhere";
    Err(Error::input(format!("{scene}: [output] names a file outside of the scene's folder: {output}; {advice}")))
}

impl Kind {
    /// Refuses to replace a file that is not empty, has no extension of this kind, and does not begin like a file of this kind.
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
        Err(Error::input(format!("{path}: exists and is not {kind}; {advice}")))
    }

    /// The file is empty, or begins like one of this kind that this program wrote.
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
    fn files_that_this_program_wrote_are_recognised() {
        use crate::image::{write_exr, write_npy, write_ply, write_png};
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("file");
        let frame = crate::image::frame::Frame {
            width: 1,
            height: 1,
            planes: vec![(crate::image::frame::Channel::Z, crate::image::frame::Plane::F32(vec![1.0]))],
        };
        write_png(&path, 1, 1, &[0; 3]).unwrap();
        assert!(PICTURE.is_ours(&path));
        write_exr(&path, &frame, &[]).unwrap();
        assert!(EXR.is_ours(&path));
        write_npy(&path, &[1, 3], &[0.0; 3]).unwrap();
        assert!(POINTS.is_ours(&path) && RAYS.is_ours(&path));
        write_ply(&path, &[]).unwrap();
        assert!(POINTS.is_ours(&path) && !RAYS.is_ours(&path));
    }

    #[test]
    fn a_scene_names_outputs_in_its_folder() {
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
            // its folder does not exist, which is reported when it is checked for writing
            ("own/none/a.png", true),
        ] {
            assert_eq!(check_inside(&scene, &path(name)).is_ok(), is_inside, "{name}");
        }
        assert!(check_inside(&scene, Path::new("/dev/null")).is_err());
    }
}

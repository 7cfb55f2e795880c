//! Runs the built program in a folder of its own.

use crate::{PROGRAM, needs};
use std::path::Path;
use std::process::{Command, Output, Stdio};
use tempfile::TempDir;

/// A folder with files, in which the program runs.
pub struct Place {
    pub dir: TempDir,
}

/// What a run gave.
pub struct Ran {
    pub code: i32,
    pub out: String,
    /// Without progress lines, whose number depends on the machine.
    pub err: String,
}

impl Ran {
    pub fn of(output: Output) -> Ran {
        let Output { status, stdout, stderr } = output;
        let text = |bytes| String::from_utf8(bytes).unwrap();
        let is_kept = |line: &&str| !line.starts_with("progress: ");
        let err = text(stderr).split_inclusive('\n').filter(is_kept).collect();
        Ran { code: status.code().expect("no signal"), out: text(stdout), err }
    }
}

/// A small scene of a box, without outputs.
pub const SCENE: &str = r#"
[image]
width = 64
height = 48
background = [0.1, 0.2, 0.3]
[[mesh]]
builtin = "icosphere"
level = 2
[camera]
kind = "pinhole"
eye = [0, 0.5, 4]
target = [0, 0, 0]
vfov = 40
"#;

impl Place {
    /// A folder with `scene.toml`, which is [`SCENE`].
    pub fn new() -> Place {
        let place = Place { dir: tempfile::tempdir().unwrap() };
        place.write("scene.toml", SCENE);
        place
    }

    pub fn path(&self) -> &Path {
        self.dir.path()
    }

    pub fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        std::fs::write(self.path().join(name), content).unwrap();
    }

    pub fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.path()).unwrap();
        let mut names: Vec<_> = entries.map(|e| e.unwrap().file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }

    pub fn command(&self, args: &[&str]) -> Command {
        let mut command = Command::new(PROGRAM);
        command.args(args).current_dir(self.path()).stdin(Stdio::null());
        command
    }

    pub fn run(&self, args: &[&str]) -> Ran {
        Ran::of(self.command(args).output().unwrap())
    }

    /// Runs and expects success, with nothing on stderr.
    pub fn works(&self, args: &[&str]) -> String {
        let ran = self.run(args);
        assert_eq!((ran.code, ran.err.as_str()), (0, ""), "{args:?}: {}", ran.err);
        ran.out
    }

    /// Runs and expects exit code `code`, one line on stderr that holds `says`, nothing on stdout and no new file.
    pub fn refuses(&self, args: &[&str], code: i32, says: &str) {
        let before = self.names();
        let ran = self.run(args);
        assert_one_line(&ran, &format!("{args:?}"));
        assert!(ran.code == code, "{args:?}: exit code {}: {}", ran.code, ran.err);
        assert!(ran.err.contains(says), "{args:?}: {says:?} not in: {}", ran.err);
        assert_eq!(ran.out, "", "{args:?}");
        assert_eq!(self.names(), before, "{args:?}");
    }

    /// Whether there is an adapter to render on. If not, [`needs::no_adapter`] skips the test or fails it.
    pub fn has_adapter(&self) -> bool {
        let info: serde_json::Value = serde_json::from_str(&self.works(&["info", "--json"])).unwrap();
        let found = info["adapters"].as_array().is_some_and(|a| !a.is_empty());
        if !found {
            needs::no_adapter();
        }
        found
    }
}

pub fn assert_one_line(ran: &Ran, what: &str) {
    let line = ran.err.strip_suffix('\n').unwrap_or_else(|| panic!("{what}: no line: {:?}", ran.err));
    assert!(line.starts_with("error: ") && line.len() > "error: ".len() && !line.contains('\n'), "{what}: {line:?}");
    for word in ["panicked", "internal error", "backtrace", "Usage"] {
        assert!(!line.contains(word), "{what}: {line}");
    }
}

//! Command lines that the laboratory's program runs: here a script takes its place.

use super::program::Place;
use crate::PROGRAM;
use std::path::Path;
use std::process::{Command, Stdio};

/// Command lines that `anamorph` hands on.
const HANDED_ON: [&[&str]; 4] = [
    &["bench", "papers", "--quick", "--out", "a folder"],
    &["bench", "--help"],
    &["gpu-report", "--minutes", "-1"],
    &["render", "scene.toml", "-o", "out.png", "--engine", "raster-warp:2"],
];

/// Runs a shell command in a folder. Executables are written by other processes: while this one has a file open to write, the children of
/// other tests may hold it open too, and it cannot be run.
fn shell(folder: &Path, command: &str) {
    let status = Command::new("/bin/sh").args(["-c", command]).current_dir(folder).status().unwrap();
    assert!(status.success(), "{command}");
}

/// A copy of the program in a folder of its own: beside the built program may lie the real laboratory.
fn copied(place: &Place) -> Command {
    let copy = place.path().join("anamorph");
    if !copy.is_file() {
        shell(place.path(), &format!("cp '{PROGRAM}' anamorph"));
    }
    let mut command = Command::new(copy);
    command.current_dir(place.path()).stdin(Stdio::null());
    command
}

/// Writes a script in the laboratory's place: it prints its arguments and ends with exit code 7.
fn write_script(folder: &Path) {
    std::fs::write(folder.join("script"), "#!/bin/sh\nprintf '<%s>' \"$@\"\nexit 7\n").unwrap();
    shell(folder, "cp script anamorph-lab && chmod +x anamorph-lab");
}

#[test]
fn the_laboratorys_command_lines_go_to_its_program_with_all_arguments() {
    let (place, elsewhere) = (Place::new(), tempfile::tempdir().unwrap());
    // on the path, then beside the program
    for folder in [elsewhere.path(), place.path()] {
        write_script(folder);
        for arguments in HANDED_ON {
            let ran = copied(&place).args(arguments).env("PATH", elsewhere.path()).output().unwrap();
            let expected: String = arguments.iter().map(|argument| format!("<{argument}>")).collect();
            assert_eq!(ran.status.code(), Some(7), "{arguments:?}");
            assert_eq!(String::from_utf8(ran.stdout).unwrap(), expected);
            assert_eq!(ran.stderr, b"", "{arguments:?}");
        }
        std::fs::remove_file(folder.join("anamorph-lab")).unwrap();
    }
}

#[test]
fn commands_of_the_program_itself_stay_with_it() {
    let place = Place::new();
    write_script(place.path());
    let ran = copied(&place).args(["render", "scene.toml", "-o", "out.png", "--engine", "reference"]).output().unwrap();
    assert!(ran.status.success() && place.path().join("out.png").is_file());
}

#[test]
fn without_the_laboratory_one_line_says_how_to_install_it() {
    let place = Place::new();
    for arguments in HANDED_ON {
        let ran = copied(&place).args(arguments).env("PATH", "").output().unwrap();
        let said = String::from_utf8(ran.stderr).unwrap();
        assert_eq!(ran.status.code(), Some(2), "{arguments:?}: {said}");
        assert!(said.lines().count() == 1 && said.contains("cargo install --path lab"), "{said}");
        assert_eq!(ran.stdout, b"");
    }
}

//! Command lines that the laboratory's program runs: here a script takes its place.

use super::program::Place;
use std::ffi::OsString;
use std::os::unix::fs::PermissionsExt;

/// Command lines that `anamorph` hands on.
const HANDED_ON: [&[&str]; 4] = [
    &["bench", "papers", "--quick", "--out", "a folder"],
    &["bench", "--help"],
    &["gpu-report", "--minutes", "-1"],
    &["render", "scene.toml", "-o", "out.png", "--engine", "raster-warp:2"],
];

/// A path that starts with the place's folder.
fn path_with(place: &Place) -> OsString {
    let known = std::env::var_os("PATH").unwrap();
    std::env::join_paths([place.path().to_owned()].into_iter().chain(std::env::split_paths(&known))).unwrap()
}

#[test]
fn the_laboratorys_command_lines_go_to_its_program_with_all_arguments() {
    let place = Place::new();
    place.write("anamorph-lab", "#!/bin/sh\nprintf '<%s>' \"$@\"\nexit 7\n");
    let script = place.path().join("anamorph-lab");
    std::fs::set_permissions(&script, std::fs::Permissions::from_mode(0o755)).unwrap();
    for arguments in HANDED_ON {
        let ran = place.command(arguments).env("PATH", path_with(&place)).output().unwrap();
        let expected: String = arguments.iter().map(|argument| format!("<{argument}>")).collect();
        assert_eq!(ran.status.code(), Some(7), "{arguments:?}");
        assert_eq!(String::from_utf8(ran.stdout).unwrap(), expected);
        assert_eq!(ran.stderr, b"", "{arguments:?}");
    }
    let own = place.command(&["render", "scene.toml", "-o", "out.png", "--engine", "reference"]);
    let ran = { own }.env("PATH", path_with(&place)).output().unwrap();
    assert!(ran.status.success() && place.path().join("out.png").is_file());
}

#[test]
fn without_the_laboratory_one_line_says_how_to_install_it() {
    let place = Place::new();
    for arguments in HANDED_ON {
        let ran = place.command(arguments).env("PATH", "").output().unwrap();
        let said = String::from_utf8(ran.stderr).unwrap();
        assert_eq!(ran.status.code(), Some(2), "{arguments:?}: {said}");
        assert!(said.lines().count() == 1 && said.contains("cargo install --path lab"), "{said}");
        assert_eq!(ran.stdout, b"");
    }
}

//! The keys of every kind of camera, as `anamorph camera --help KIND` prints them.

use crate::camera::kinds::KINDS;
use crate::input::{Error, Result};

/// The keys that can replace eye, target and up, for the help of kinds that have these.
const POSE: &str = include_str!("../../camera/help/pose.txt");

pub fn names() -> Vec<&'static str> {
    KINDS.iter().map(|k| k.name).collect()
}

/// # Errors
/// [`Error::Input`] that lists the known kinds.
pub fn keys(kind: &str) -> Result<String> {
    let found = KINDS.iter().find(|k| k.name == kind).map(|k| k.help);
    found.map(with_pose).ok_or_else(|| {
        Error::input(format!("--help {kind}: no such kind of camera in this version; known: {}", names().join(", ")))
    })
}

/// The help of a kind has a title, keys and formulas, with an empty line between. [`POSE`] is put after the keys.
fn with_pose(help: &str) -> String {
    let mut parts: Vec<&str> = help.splitn(3, "\n\n").collect();
    let has = |key: &str| parts[1].split(|c: char| !c.is_alphanumeric()).any(|word| word == key);
    if has("eye") && has("target") {
        parts.insert(2, POSE.trim_end());
    }
    parts.join("\n\n")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::file;

    #[test]
    fn poses_are_in_the_help_of_the_kinds_that_read_them() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("scene.toml");
        // these have an eye and a target in tables of their own
        let nested = ["bottom_up", "graph_camera", "mcop"];
        for kind in names() {
            // the error for an unknown key lists the known ones
            std::fs::write(&path, format!("[camera]\nkind = {kind:?}\nunknown = 1\n")).unwrap();
            let refusal = file::load(&path, &[], 0.0).unwrap_err().to_string();
            assert!(refusal.contains("unknown key \"unknown\""), "{refusal}");
            let reads = refusal.contains("quaternion") || nested.contains(&kind);
            let help = keys(kind).unwrap();
            assert_eq!(help.matches(POSE.trim_end()).count(), usize::from(reads), "{help}");
            assert!(help.ends_with('\n'));
        }
    }
}

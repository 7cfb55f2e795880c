//! The keys of every kind of camera, as `anamorph camera --help KIND` prints them.

use crate::camera::kinds::KINDS;
use crate::camera::recipe::Kind;
use crate::input::tree::did_you_mean;
use crate::input::{Error, Result};

pub fn names() -> Vec<&'static str> {
    KINDS.iter().map(|k| k.name).collect()
}

/// # Errors
/// [`Error::Input`] that lists the known kinds.
pub fn keys(kind: &str) -> Result<String> {
    KINDS.iter().find(|k| k.name == kind).map(Kind::whole_help).ok_or_else(|| {
        let (known, hint) = (names().join(", "), did_you_mean(kind, &names()));
        Error::input(format!("--help {kind}: no such kind of camera in this version{hint}; known: {known}"))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::recipe::POSE;
    use crate::input::Loading;
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
            let refusal = file::load(&path, &[], 0.0, &Loading::default()).unwrap_err().to_string();
            assert!(refusal.contains("unknown key \"unknown\""), "{refusal}");
            let reads = refusal.contains("quaternion") || nested.contains(&kind);
            let help = keys(kind).unwrap();
            assert_eq!(help.matches(POSE.trim_end()).count(), usize::from(reads), "{help}");
            assert!(help.ends_with('\n'));
        }
    }
}

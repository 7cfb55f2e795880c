//! The keys of every kind of camera, as `anamorph camera --help KIND` prints them.

use crate::camera::kinds::{NAMED, PLAIN};
use crate::error::{Error, Result};

pub fn names() -> Vec<&'static str> {
    PLAIN.iter().map(|k| k.0).chain(NAMED.iter().map(|k| k.name)).collect()
}

/// # Errors
/// [`Error::Input`] that lists the known kinds.
pub fn keys(kind: &str) -> Result<&'static str> {
    let plain = PLAIN.iter().find(|k| k.0 == kind).map(|k| k.1);
    let found = plain.or_else(|| NAMED.iter().find(|k| k.name == kind).map(|k| k.help));
    found.ok_or_else(|| {
        Error::input(format!("--help {kind}: no such kind of camera in this version; known: {}", names().join(", ")))
    })
}

//! The table of cameras: every kind that a scene file may name.

use super::projector;
use super::recipe::Kind;

/// The kinds that the scene file reads itself, and their keys.
pub const PLAIN: &[(&str, &str)] = &[
    ("pinhole", include_str!("help/pinhole.txt")),
    ("orthographic", include_str!("help/orthographic.txt")),
    ("glc", include_str!("help/glc.txt")),
    ("mesh", include_str!("help/mesh.txt")),
    ("raymap", include_str!("help/raymap.txt")),
];

/// All others, each read and built in a file of its own.
pub const NAMED: &[Kind] = &[
    Kind { name: "projector", help: include_str!("help/projector.txt"), read: projector::read },
];

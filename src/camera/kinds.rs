//! The table of cameras: every kind that a scene file may name.

use super::named::{cylinder, fisheye, sphere};
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
    Kind { name: "fisheye", help: include_str!("help/fisheye.txt"), read: fisheye::read },
    Kind { name: "sphere", help: include_str!("help/sphere.txt"), read: sphere::read },
    Kind { name: "cylinder", help: include_str!("help/cylinder.txt"), read: cylinder::read },
];

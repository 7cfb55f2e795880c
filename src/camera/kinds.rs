//! The table of cameras: every kind that a scene file may name.

use super::named::{camera_texture, cylinder, display, fisheye, lidar, lightfield, ods, opencv, panini, sphere};
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
    Kind { name: "opencv", help: include_str!("help/opencv.txt"), read: opencv::read },
    Kind { name: "ods", help: include_str!("help/ods.txt"), read: ods::read },
    Kind { name: "camera_texture", help: include_str!("help/camera_texture.txt"), read: camera_texture::read },
    Kind { name: "panini", help: include_str!("help/panini.txt"), read: panini::read },
    Kind { name: "display", help: include_str!("help/display.txt"), read: display::read },
    Kind { name: "lightfield", help: include_str!("help/lightfield.txt"), read: lightfield::read },
    Kind { name: "lidar", help: include_str!("help/lidar.txt"), read: lidar::read },
];

//! The table of cameras: every kind that a scene file may name.

use super::recipe::Kind;
use super::{chain, graph};

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
    Kind { name: "chain", help: include_str!("help/chain.txt"), read: chain::read },
    Kind { name: "bottom_up", help: include_str!("help/bottom_up.txt"), read: graph::bottom_up::read },
    Kind { name: "graph_camera", help: include_str!("help/graph_camera.txt"), read: graph::bottom_up::read_torn },
    Kind { name: "top_down", help: include_str!("help/top_down.txt"), read: graph::top_down::read },
    Kind { name: "track", help: include_str!("help/track.txt"), read: graph::track::read },
];

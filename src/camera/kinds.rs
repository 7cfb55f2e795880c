//! The kinds of cameras in scene files, one file per family. [`pinhole`] is the simplest; read it to learn how a kind is written: its keys,
//! how they are read, and its rays.

pub mod calibrated;
pub mod camera_texture;
pub mod composite;
pub mod cross_slit;
pub mod cylinder;
pub mod display;
pub mod fisheye;
pub mod glc;
pub mod hinge;
pub mod irregular_perspective;
pub mod lidar;
pub mod lightfield;
pub mod mcop;
pub mod mesh;
pub mod occlusion;
pub mod ods;
pub mod ortho_to_perspective;
pub mod orthographic;
pub mod panini;
pub mod panorama;
pub mod pencil;
pub mod pinhole;
pub mod pushbroom;
pub mod raymap;
pub mod reflection;
pub mod sphere;
pub mod street;
mod strips;
pub mod surround;
pub mod twist;
mod viewer;

use super::exposure::{self, Readout};
use super::lens::{Lens, Posed};
use super::pose::{KEYS as POSE, Pose};
use super::recipe::Kind;
use super::spec::{CameraKind, CameraSpec};
use super::{chain, graph, projector};
use crate::input::reader::{Field, Table};
use crate::input::tree::{nearest, quote};
use crate::input::{Error, Result};

/// The table of kinds.
pub const KINDS: &[Kind] = &[
    Kind { name: "pinhole", help: include_str!("help/pinhole.txt"), read: pinhole::read },
    Kind { name: "orthographic", help: include_str!("help/orthographic.txt"), read: orthographic::read },
    Kind { name: "glc", help: include_str!("help/glc.txt"), read: glc::read },
    Kind { name: "mesh", help: include_str!("help/mesh.txt"), read: mesh::read },
    Kind { name: "raymap", help: include_str!("help/raymap.txt"), read: raymap::read },
    Kind { name: "cross_slit", help: include_str!("help/cross_slit.txt"), read: cross_slit::read },
    Kind { name: "pushbroom", help: include_str!("help/pushbroom.txt"), read: pushbroom::read },
    Kind { name: "pencil", help: include_str!("help/pencil.txt"), read: pencil::read },
    Kind { name: "twisted", help: include_str!("help/twisted.txt"), read: pencil::read_twisted },
    Kind { name: "panorama", help: include_str!("help/panorama.txt"), read: panorama::read },
    Kind { name: "hinge", help: include_str!("help/hinge.txt"), read: hinge::read },
    Kind { name: "surround", help: include_str!("help/surround.txt"), read: surround::read },
    Kind { name: "mcop", help: include_str!("help/mcop.txt"), read: mcop::read },
    Kind { name: "projector", help: include_str!("help/projector.txt"), read: projector::read },
    Kind {
        name: "irregular_perspective",
        help: include_str!("help/irregular_perspective.txt"),
        read: irregular_perspective::read,
    },
    Kind { name: "twist", help: include_str!("help/twist.txt"), read: twist::read },
    Kind {
        name: "curved_convergence",
        help: include_str!("help/curved_convergence.txt"),
        read: twist::read_curved_convergence,
    },
    Kind {
        name: "ortho_to_perspective",
        help: include_str!("help/ortho_to_perspective.txt"),
        read: ortho_to_perspective::read,
    },
    Kind { name: "occlusion", help: include_str!("help/occlusion.txt"), read: occlusion::read },
    Kind { name: "street", help: include_str!("help/street.txt"), read: street::read },
    Kind { name: "fisheye", help: include_str!("help/fisheye.txt"), read: fisheye::read },
    Kind { name: "sphere", help: include_str!("help/sphere.txt"), read: sphere::read },
    Kind { name: "cylinder", help: include_str!("help/cylinder.txt"), read: cylinder::read },
    Kind { name: "chain", help: include_str!("help/chain.txt"), read: chain::read },
    Kind { name: "bottom_up", help: include_str!("help/bottom_up.txt"), read: graph::bottom_up::read },
    Kind {
        name: "graph_camera",
        help: include_str!("help/graph_camera.txt"),
        read: graph::bottom_up::read_discontinuous,
    },
    Kind { name: "top_down", help: include_str!("help/top_down.txt"), read: graph::top_down::read },
    Kind { name: "track", help: include_str!("help/track.txt"), read: graph::track::read },
    Kind { name: "opencv", help: include_str!("help/opencv.txt"), read: calibrated::read_opencv },
    Kind { name: "calibrated", help: include_str!("help/calibrated.txt"), read: calibrated::read },
    Kind { name: "ods", help: include_str!("help/ods.txt"), read: ods::read },
    Kind { name: "camera_texture", help: include_str!("help/camera_texture.txt"), read: camera_texture::read },
    Kind { name: "panini", help: include_str!("help/panini.txt"), read: panini::read },
    Kind { name: "display", help: include_str!("help/display.txt"), read: display::read },
    Kind { name: "lightfield", help: include_str!("help/lightfield.txt"), read: lightfield::read },
    Kind { name: "reflection", help: include_str!("help/reflection.txt"), read: reflection::read },
    Kind { name: "refraction", help: include_str!("help/refraction.txt"), read: reflection::read_refraction },
    Kind { name: "lidar", help: include_str!("help/lidar.txt"), read: lidar::read },
    Kind { name: "composite", help: include_str!("help/composite.txt"), read: composite::read },
];

pub(crate) fn read_camera(field: &Field) -> Result<CameraSpec> {
    read_kind(&field.table()?)
}

/// A camera that is part of another, whose pixels have no times of their own.
pub(crate) fn read_part(field: &Field) -> Result<CameraSpec> {
    let table = field.table()?;
    let spec = read_kind(&table)?;
    match ["line_time", "period"]
        .into_iter()
        .find_map(|key| table.get(key))
        .filter(|_| spec.kind.recipe.lines().is_some())
    {
        Some(key) => Err(key
            .error("a camera in another one has no times of its own; leave it out, or give the outer one a line_time")),
        None => Ok(spec),
    }
}

/// The camera of a scene: its kind, and when its pixels are read in an image of this size, with so many frames a second.
pub(crate) fn read_camera_and_readout(
    field: &Field,
    size: (Option<u32>, Option<u32>),
    frame_rate: f64,
) -> Result<(CameraSpec, Readout)> {
    let table = field.table()?.with_keys_read_elsewhere(&exposure::KEYS);
    let spec = read_kind(&table)?;
    let readout = exposure::read_readout(&table, spec.kind.recipe.lines(), size, frame_rate)?;
    Ok((spec, readout))
}

/// The camera alone of a scene, whatever is said about when its pixels are read.
pub(crate) fn read_camera_of_scene(field: &Field) -> Result<CameraSpec> {
    read_kind(&field.table()?.with_keys_read_elsewhere(&exposure::KEYS))
}

fn read_kind(table: &Table) -> Result<CameraSpec> {
    let names = || KINDS.iter().map(|k| k.name).collect::<Vec<_>>();
    let Some(key) = table.get("kind") else {
        return Err(table.error(format_args!("kind is missing; add kind = one of {}", names().join(", "))));
    };
    let name = key.text()?;
    let kind = KINDS.iter().find(|k| k.name == name).ok_or_else(|| unknown_kind(&key, name, &names()))?;
    let kind = CameraKind { name: kind.name, recipe: (kind.read)(table)? };
    Ok(CameraSpec { kind, t_range: table.or("t_range", [0.0, f64::INFINITY], read_t_range)? })
}

fn unknown_kind(field: &Field, kind: &str, names: &[&str]) -> Error {
    let near = nearest(kind, names).unwrap_or_default();
    let known = names.join(", ");
    field.error(format_args!("unknown camera kind {}; nearest known: {near:?} (known: {known})", quote(kind)))
}

fn read_t_range(field: &Field) -> Result<[f64; 2]> {
    let expected = "a number, inf or -inf";
    let [first, last] = field.array::<2>("the two ends of t, as [0, inf]")?;
    let (first, last) = (first.number_or_inf(expected)?, last.number_or_inf(expected)?);
    if first > last {
        return Err(field.error(format_args!("the first end {first} is above the second {last}; swap them")));
    }
    if first == f64::INFINITY || last == f64::NEG_INFINITY {
        return Err(field.error("the range holds no finite t; use e.g. [0, inf]"));
    }
    Ok([first, last])
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn help_describes_each_key_once() {
        for Kind { name: kind, help, .. } in KINDS {
            // a key's line has two leading spaces, its continuation lines more
            let keys = help.lines().filter_map(|line| line.strip_prefix("  ")).filter(|line| !line.starts_with(' '));
            let keys: Vec<&str> = keys.filter_map(|line| line.split("  ").next()).collect();
            let mut known = HashSet::new();
            let twice: Vec<&&str> = keys.iter().filter(|key| !known.insert(**key)).collect();
            assert!(!keys.is_empty() && twice.is_empty(), "{kind}: {twice:?}");
        }
    }
}

//! What is fuzzed: functions of any bytes, which must neither panic nor hang. What is refused is refused in one line, with exit code 2.

#![allow(dead_code)]

#[path = "../tests/common/mod.rs"]
mod common;

use anamorph::internals::camera::Camera;
use anamorph::internals::camera::kinds::glc::Glc;
use anamorph::internals::camera::spec::{CameraKind, CameraSpec};
use anamorph::internals::engine::RunOptions;
use anamorph::internals::engine::plan::Wanted;
use anamorph::internals::geometry::heights::HeightSpec;
use anamorph::internals::geometry::texture::Images;
use anamorph::internals::geometry::{dae, gltf, heights, obj, off, ply, stl};
use anamorph::internals::image::frame::Channel;
use anamorph::internals::image::{read_npy_rows, read_pairs, read_points, read_text_points, read_vectors};
use anamorph::internals::input::{Error, Limits, Loading};
use anamorph::internals::reference::image::judge;
use anamorph::internals::scene::file;
use anamorph::internals::scene::volume::load::load_grid;
use anamorph::internals::scene::volume::spec::{GridSource, GridSpec, Placement};
use common::gpu::Without;
use glam::DVec3;

/// Of `frame`'s pictures.
const SIZE: (u32, u32) = (16, 16);

/// Memory limit: enough for a mesh of some million triangles.
const BYTES: u64 = 1 << 30;

/// A load with this memory limit, so that the outcome does not depend on the free memory.
fn loading() -> Loading {
    Loading::new(Limits::default().memory(BYTES))
}

fn check_refused(error: &Error) {
    let text = error.to_string();
    assert!(!text.is_empty() && !text.contains('\n'), "{text:?}");
    // too little memory is not an error of the input
    let code = if text.contains("--memory") { 1 } else { 2 };
    assert_eq!(error.exit_code(), code, "{text}");
}

/// Writes the bytes as a file and reads them.
fn read<T>(name: &str, data: &[u8], read: impl FnOnce(&std::path::Path) -> Result<T, Error>) -> Option<T> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join(name);
    std::fs::write(&path, data).expect("a temporary file");
    read(&path).map_err(|e| check_refused(&e)).ok()
}

/// A scene file: TOML, or JSON where it begins with a brace.
pub fn scene(data: &[u8]) {
    let name = if data.trim_ascii_start().first() == Some(&b'{') { "scene.json" } else { "scene.toml" };
    read(name, data, |path| file::load(path, &[], 0.0, &loading()));
}

pub fn obj(data: &[u8]) {
    read("mesh.obj", data, |path| obj::load(path, &mut Images::default(), &loading()));
}

pub fn ply(data: &[u8]) {
    read("mesh.ply", data, |path| ply::load(path, &mut Images::default(), &loading()));
}

pub fn stl(data: &[u8]) {
    read("mesh.stl", data, |path| stl::load(path, &loading()));
}

pub fn off(data: &[u8]) {
    read("mesh.off", data, |path| off::load(path, &loading()));
}

pub fn dae(data: &[u8]) {
    read("mesh.dae", data, |path| dae::load(path, &loading()));
}

/// Points as text.
pub fn xyz(data: &[u8]) {
    read("points.xyz", data, |path| read_text_points(path, &loading()));
}

/// An image on a mesh; a TGA where it begins with two zero bytes.
pub fn texture(data: &[u8]) {
    let name = if data.starts_with(&[0, 0]) { "image.tga" } else { "image.png" };
    read(name, data, |path| Images::default().load(path, &loading()));
}

/// Text, or binary where it begins as that does.
pub fn gltf(data: &[u8]) {
    let name = if data.starts_with(b"glTF") { "mesh.glb" } else { "mesh.gltf" };
    read(name, data, |path| gltf::load(path, gltf::Files::Below, &Images::default(), None, &loading()));
}

/// A height image: a TIFF or a PNG if it begins like one, or else an ASCII grid.
pub fn heights(data: &[u8]) {
    let name = match data {
        [b'I', b'I', ..] | [b'M', b'M', ..] => "dem.tif",
        [0x89, ..] => "dem.png",
        _ => "dem.asc",
    };
    read(name, data, |path| {
        heights::load(&HeightSpec { file: path.into(), height_scale: 1.0, cell: None }, &loading())
    });
}

/// A material library, read through an OBJ that names it.
pub fn mtl(data: &[u8]) {
    let obj = b"mtllib m.mtl\nusemtl red\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n";
    read("m.mtl", data, |path| {
        let mesh = path.with_file_name("mesh.obj");
        std::fs::write(&mesh, obj).expect("a temporary file");
        obj::load(&mesh, &mut Images::default(), &loading())
    });
}

/// An array, read by all readers of arrays.
pub fn npy(data: &[u8]) {
    read("a.npy", data, |path| read_vectors(path, &loading()));
    read("a.npy", data, |path| read_pairs(path, &loading()));
    read("a.npy", data, |path| read_points(path, &loading()));
    read("a.npy", data, |path| read_npy_rows::<3>(path, &loading()));
}

/// A volume: a NRRD or an array if it begins like one, or else a MetaImage.
pub fn volume(data: &[u8]) {
    let name = match data {
        [b'N', ..] => "a.nrrd",
        [0x93, ..] => "a.npy",
        _ => "a.mha",
    };
    read(name, data, |path| {
        let cube = Placement::Box { min: DVec3::ZERO, max: DVec3::ONE };
        let source = GridSource::Described(path.into());
        let placement = (name == "a.npy").then_some(cube);
        load_grid(&GridSpec { source, placement, rotate: DVec3::ZERO }, None, &loading())
    });
}

/// A calibration, and the camera made from it; or, after a line with its name, a file of a COLMAP model whose others are right.
pub fn calibration(data: &[u8]) {
    const NAMES: [&str; 4] = ["cameras.txt", "cameras.bin", "images.txt", "images.bin"];
    let named =
        NAMES.into_iter().find_map(|name| Some((name, data.strip_prefix(name.as_bytes())?.strip_prefix(b"\n")?)));
    let (name, data) = named.unwrap_or(("lens.yml", data));
    read(name, data, |path| {
        let (scene, cameras) = (path.with_file_name("scene.toml"), path.with_file_name("cameras.txt"));
        if name.starts_with("images") {
            std::fs::write(cameras, "1 PINHOLE 24 16 20 20 12 8\n").expect("a temporary file");
        }
        let keys = match named {
            None => "file = \"lens.yml\"\neye = [0, 0, 3]\ntarget = [0, 0, 0]",
            Some((name, _)) if name.starts_with("cameras") => "file = \".\"\neye = [0, 0, 3]\ntarget = [0, 0, 0]",
            Some(_) => "file = \".\"\nimage = \"a.jpg\"",
        };
        let size = "image = { width = 24, height = 16 }";
        std::fs::write(&scene, format!("{size}\n[camera]\nkind = \"calibrated\"\n{keys}\n")).expect("a temporary file");
        anamorph::internals::scene::Scene::load(&scene, &[], 0.0, &loading())?.camera()
    });
}

/// A file of poses, and the camera at the first and the second of them.
pub fn poses(data: &[u8]) {
    read("poses.txt", data, |path| {
        let scene = path.with_file_name("scene.toml");
        let keys = "kind = \"pinhole\"\nvfov = 40\nposes = \"poses.txt\"";
        std::fs::write(&scene, format!("image = {{ width = 4, height = 4 }}\n[camera]\n{keys}\n"))
            .expect("a temporary file");
        let load = |frame| anamorph::internals::scene::Scene::load(&scene, &[], frame, &loading())?.camera();
        load(0.0).and_then(|_| load(1.0))
    });
}

/// The keys of a camera, built for a small image.
pub fn camera(data: &[u8]) {
    let text = [b"image = { width = 24, height = 16 }\n[camera]\n", data].concat();
    let scene = read("scene.toml", &text, |path| {
        file::load(path, &["image.width=24".into(), "image.height=16".into()], 0.0, &loading())
    });
    let Some(scene) = scene else { return };
    match anamorph::internals::scene::Scene::from_file(scene, &loading()).and_then(|scene| scene.camera()) {
        Ok(camera) => assert!(camera.width <= 4096 && camera.height <= 4096),
        Err(e) => check_refused(&e),
    }
}

/// Numbers of three bytes each: sixteen bits in [-2, 2), and a power of ten for one in four.
fn numbers(data: &[u8]) -> impl Iterator<Item = f64> + '_ {
    data.chunks_exact(3).map(|b| {
        let number = f64::from(i16::from_le_bytes([b[0], b[1]])) / 16384.0;
        if b[2] < 64 { number * 10f64.powi(i32::from(b[2] % 16) - 12) } else { number }
    })
}

/// A small frame by the engine, compared with the reference: a GLC of the first eighteen numbers, and a triangle of every nine more.
pub fn frame(data: &[u8]) {
    let points: Vec<DVec3> =
        numbers(data).collect::<Vec<_>>().chunks_exact(3).map(|v| DVec3::new(v[0], v[1], v[2])).collect();
    if points.len() < 9 {
        return;
    }
    let corner = |k: usize, z: f64| points[k] + DVec3::new(0.0, 0.0, z);
    let kind = CameraKind::new(
        "glc",
        Glc { near: [0, 1, 2].map(|k| corner(k, 2.0)), far: [3, 4, 5].map(|k| corner(k, -2.0)) },
    );
    let spec = CameraSpec { kind, t_range: [f64::NEG_INFINITY, f64::INFINITY] };
    let Ok(camera) = Camera::new(&spec, Some(SIZE)) else { return };
    let corners = points[6..].len() / 3 * 3;
    let faces = (0..corners as u32 / 3).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
    let scene = common::scene(common::mesh(points[6..6 + corners].to_vec(), faces));
    let wanted = Wanted::of(vec![Channel::TriangleId, Channel::Certified]);
    let Some(mut engine) = common::gpu::engine(&camera, Without::Nothing) else { return };
    let frame = engine.render(&scene, &camera, &wanted, &RunOptions::default()).expect("a frame").frame;
    let judged = judge(&scene, &camera, &frame);
    let ids =
        |f: &anamorph::internals::image::frame::Frame| f.u32(Channel::TriangleId).map(<[u32]>::to_vec).expect("ids");
    let (seen, truth) = (ids(&frame), ids(&judged.truth));
    let proven = frame.u32(Channel::Certified).expect("what is proven");
    let wrong = (0..seen.len()).filter(|&k| seen[k] != truth[k] && (judged.safe[k] || proven[k] > 0));
    assert_eq!((wrong.count(), judged.not_near), (0, 0), "{points:?}");
}

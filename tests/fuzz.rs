//! The targets of `cargo fuzz` without a nightly toolchain, on a corpus and random mutations of it: nothing panics or takes long, and every
//! refusal is one line.

#[path = "../fuzz/mutations.rs"]
mod mutations;
#[path = "../fuzz/targets.rs"]
mod targets;

use mutations::{Names, Rng, changed, corpus};
use std::time::{Duration, Instant};

/// Most processor time of a case.
const MOST: Duration = Duration::from_secs(20);

/// Wall time is measured, and the tests of this file and other programs share the processors: a case may take so many times [`MOST`].
const SHARED: u32 = 6;

/// Changed texts a target; as many as `ANAMORPH_FUZZ` says.
fn rounds() -> usize {
    std::env::var("ANAMORPH_FUZZ").ok().and_then(|n| n.parse().ok()).unwrap_or(500)
}

fn run(target: &str, function: fn(&[u8]), rounds: usize) {
    let all = corpus(target);
    let mut rng = Rng(target.len() as u64);
    let changed = (0..rounds).map(|_| changed(&all, Names::Kept, &mut rng));
    for text in all.iter().cloned().chain(changed) {
        let started = Instant::now();
        let outcome = std::panic::catch_unwind(|| function(&text));
        assert!(outcome.is_ok(), "{target}: this panics:\n{}", String::from_utf8_lossy(&text));
        let took = started.elapsed();
        assert!(took < SHARED * MOST, "{target}: this takes {took:?}:\n{}", String::from_utf8_lossy(&text));
    }
}

#[test]
fn scene_files() {
    run("scene", targets::scene, rounds());
}

#[test]
fn obj_files() {
    run("obj", targets::obj, rounds());
}

#[test]
fn ply_files() {
    run("ply", targets::ply, rounds());
}

#[test]
fn stl_files() {
    run("stl", targets::stl, rounds());
}

#[test]
fn off_files() {
    run("off", targets::off, rounds());
}

#[test]
fn collada_files() {
    run("dae", targets::dae, rounds());
}

#[test]
fn points_as_text() {
    run("xyz", targets::xyz, rounds());
}

#[test]
fn textures() {
    run("texture", targets::texture, rounds());
}

#[test]
fn mtl_files() {
    run("mtl", targets::mtl, rounds());
}

#[test]
fn gltf_files() {
    run("gltf", targets::gltf, rounds());
}

#[test]
fn height_images() {
    run("heights", targets::heights, rounds());
}

#[test]
fn arrays() {
    run("npy", targets::npy, rounds());
}

#[test]
fn volumes() {
    run("volume", targets::volume, rounds());
}

#[test]
fn calibrations() {
    run("calibration", targets::calibration, rounds());
}

#[test]
fn poses() {
    run("poses", targets::poses, rounds());
}

/// Fewer rounds, because some cameras have up to a million pieces.
#[test]
fn cameras() {
    run("camera", targets::camera, rounds() / 3);
}

/// Random bytes are numbers too.
#[test]
fn small_frames() {
    run("frame", targets::frame, rounds() / 15);
}

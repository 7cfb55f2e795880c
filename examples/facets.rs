//! `make facets`: how far facets, atlases and environment maps are from the mirror ball itself, against the time they take.
//!
//! Writes mirror_facets.csv: for every way of showing the mirror the pixels that show another triangle than the ball itself,
//! of those that see it, the signal-to-noise ratio of the colours, and the median frame.

use anamorph::camera::Camera;
use anamorph::compare::compare;
use anamorph::engine::{Engine, RunOptions};
use anamorph::error::{Error, Result};
use anamorph::example::EXAMPLES;
use anamorph::frame::{Channel, Frame, NO_ID};
use anamorph::gpu::Gpu;
use anamorph::gpu::device::NO_ADAPTER;
use anamorph::plan::Wanted;
use anamorph::scene::Scene;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Facets: those of Yu et al., figure 10, then four times as many each.
const COUNTS: [u32; 8] = [126, 360, 640, 960, 3840, 15_360, 61_440, 100_000];
/// Texels a side: those of Hou et al., table 1, and of Yu et al., figure 10.
const TEXELS: [u32; 4] = [32, 64, 128, 256];
/// Texels of an atlas at most: beyond it takes more memory than it tells.
const TEXELS_MAX: u64 = 1 << 25;
/// Timed frames.
const RUNS: u32 = 3;

fn main() -> Result<()> {
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or_else(|| "out".into()));
    std::fs::create_dir_all(&folder).map_err(|e| Error::work(format!("{}: {e}", folder.display())))?;
    let Some(example) = EXAMPLES.iter().find(|e| e.name == "mirror-ball") else { return Ok(()) };
    let path = example.write(&folder)?;
    let mut engine = Engine::new(Gpu::open(&Default::default())?.ok_or_else(|| Error::work(NO_ADAPTER))?);
    let (truth, ms) = shown(&mut engine, &path, &["camera.facets=\"exact\"".into()])?;
    let mut csv = String::from("way,facets,texels,wrong,mirror_pixels,psnr_db,frame_ms\n");
    let mut add = |name: &str, facets: u32, texels: u32, frame: &Frame, ms: f64| {
        let (wrong, pixels, psnr) = difference(frame, &truth);
        // writing to a String cannot fail
        let _ = writeln!(csv, "{name},{facets},{texels},{wrong},{pixels},{psnr:.2},{ms:.1}");
        println!(
            "{name:<12} {facets:>7} facets {texels:>4} texels: {wrong:>6} of {pixels} wrong, {psnr:6.2} dB, {ms:8.1} ms"
        );
    };
    add("exact", 0, 0, &truth, ms);
    let set = |keys: &[(&str, String)]| keys.iter().map(|(k, v)| format!("camera.{k}={v}")).collect::<Vec<_>>();
    for law in ["normals", "flat"] {
        for count in COUNTS {
            let keys = [("facets", format!("{law:?}")), ("mirror.count", count.to_string())];
            let (frame, ms) = shown(&mut engine, &path, &set(&keys))?;
            add(law, count, 0, &frame, ms);
        }
    }
    for texels in TEXELS {
        for count in [126, 480, 960] {
            if u64::from(count) * u64::from(texels).pow(2) / 2 > TEXELS_MAX {
                continue;
            }
            let keys = [("mirror.count", count.to_string()), ("atlas", texels.to_string())];
            let (frame, ms) = shown(&mut engine, &path, &set(&keys))?;
            add("flat atlas", count, texels, &frame, ms);
        }
    }
    let keys = [("facets", "\"exact\"".to_owned()), ("environment", "[0, 0, 0]".to_owned())];
    let (frame, ms) = shown(&mut engine, &path, &set(&keys))?;
    add("environment", 0, 0, &frame, ms);
    let file = folder.join("mirror_facets.csv");
    std::fs::write(&file, csv).map_err(|e| Error::work(format!("{}: {e}", file.display())))
}

/// The picture with some keys set, and its median time, ms.
fn shown(engine: &mut Engine, path: &Path, keys: &[String]) -> Result<(Frame, f64)> {
    let scene = Scene::load(path, keys, 0.0)?;
    let camera: Camera = scene.camera()?;
    let wanted = Wanted { channels: Channel::of(&camera), srgb8: false, counting: false };
    let run = RunOptions { repeat: RUNS, ..Default::default() };
    let mut rendered = engine.render(&scene, &camera, &wanted, &run)?;
    rendered.frame_ms.sort_by(f64::total_cmp);
    Ok((rendered.frame, rendered.frame_ms[rendered.frame_ms.len() / 2]))
}

/// Pixels that show another triangle, of those that see the mirror in the truth; and the ratio of the colours.
fn difference(frame: &Frame, truth: &Frame) -> (usize, usize, f64) {
    let ids = |f: &Frame, c: Channel| f.u32(c).map(<[u32]>::to_vec).unwrap_or_default();
    let (mirror, seen, known) =
        (ids(truth, Channel::MirrorId), ids(frame, Channel::TriangleId), ids(truth, Channel::TriangleId));
    let pixels: Vec<usize> = (0..mirror.len()).filter(|&k| mirror[k] != NO_ID).collect();
    let wrong = pixels.iter().filter(|&&k| seen[k] != known[k]).count();
    let psnr = compare(frame, truth, None, None).ok().and_then(|c| c.psnr).unwrap_or(f64::NAN);
    (wrong, pixels.len(), psnr)
}

//! Times paths of poses by raster, by trace and by `auto`, including uploads and hierarchy builds but not kernel compilation. It prints for each
//! case the three times, and the ratio of `auto` to the faster of the other two. Arguments: the number of poses (100), and a part of the names of cases.

use anamorph::internals::camera::Camera;
use anamorph::internals::engine::plan::Wanted;
use anamorph::internals::engine::sequence::Sequence;
use anamorph::internals::engine::{Engine, Method, RunOptions};
use anamorph::internals::gpu::device::GpuOptions;
use anamorph::internals::image::frame::Channel;
use anamorph::internals::input::{Error, Loading, Result};
use anamorph::internals::scene::Scene;
use anamorph_lab::bench::calls::{Lens, Pose};
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

const TRIANGLES: [u32; 4] = [15_000, 100_000, 1_000_000, 10_000_000];
const SIZES: [(u32, u32); 3] = [(160, 120), (640, 480), (1920, 1080)];
const LENSES: [Lens; 3] = [Lens::Pinhole, Lens::Fisheye, Lens::Pieces];
const METHODS: [Method; 3] = [Method::Raster, Method::Trace, Method::Auto];

/// A path ends after this many seconds by one method; its later poses are then not counted for any method.
const SECONDS_MAX: f64 = 20.0;

fn main() -> Result<()> {
    let mut arguments = std::env::args().skip(1);
    let poses = arguments.next().map_or(Ok(100), |count| count.parse());
    let poses: u32 = poses.map_err(|_| Error::input("use: methods [POSES [PART OF A NAME]]"))?;
    let part = arguments.next().unwrap_or_default();
    let folder = tempfile::tempdir().map_err(|e| Error::work(e.to_string()))?;
    println!("| case | poses | raster, s | trace, s | chosen, s | over the better |\n|---|---|---|---|---|---|");
    for count in TRIANGLES {
        let blocks = (f64::from(count) / 160.0).sqrt().floor().clamp(1.0, 12.0);
        let city = format!("builtin = \"city\"\nblocks = {blocks}\ntriangles = {count}");
        let scene = load(folder.path(), &city, &Lens::Pinhole.keys(&Pose::of(0, poses)))?;
        for (size, lens) in SIZES.into_iter().flat_map(|size| LENSES.map(|lens| (size, lens))) {
            let name = format!("{}, {count}, {} x {}", lens.name(), size.0, size.1);
            if !name.contains(&part) {
                continue;
            }
            let mut all_ms = Vec::new();
            for method in METHODS {
                all_ms.push(path(folder.path(), &scene, size, lens, method, poses)?);
            }
            let taken = all_ms.iter().map(Vec::len).min().unwrap_or(0);
            let seconds = |k: usize| all_ms[k][..taken].iter().sum::<f64>() / 1e3;
            let [raster, trace, chosen] = [0, 1, 2].map(seconds);
            let ratio = chosen / raster.min(trace);
            println!("| {name} | {taken} | {raster:.2} | {trace:.2} | {chosen:.2} | {ratio:.2} |");
        }
    }
    Ok(())
}

/// Loads a mesh of these keys, seen by a camera of these.
fn load(folder: &Path, mesh: &str, camera: &str) -> Result<Scene> {
    let path = folder.join("scene.toml");
    let text = format!("image = {{ width = 8, height = 8 }}\n[[mesh]]\n{mesh}\n[camera]\n{camera}\n");
    std::fs::write(&path, text).map_err(|e| Error::work(e.to_string()))?;
    Scene::load(&path, &[], 0.0, &Loading::default())
}

/// Returns the time of each pose of a path, ms: half along a street of the city, half around it.
fn path(folder: &Path, scene: &Scene, size: (u32, u32), lens: Lens, method: Method, poses: u32) -> Result<Vec<f64>> {
    let mut engine = Engine::open(&GpuOptions::default())?.ok_or_else(|| Error::input("no adapter"))?;
    let run = RunOptions { method, ..RunOptions::default() };
    let wanted = Wanted::of(vec![Channel::T, Channel::Z, Channel::TriangleId]);
    let (mut sequence, mut last, mut all_ms) = (Sequence::default(), None, Vec::new());
    for k in 0..poses {
        let seen = load(folder, "builtin = \"box\"", &lens.keys(&Pose::of(k, poses)))?;
        let camera = Camera::in_scene(&seen.camera, Some(size), &scene.mesh, &Loading::default())?;
        let started = Instant::now();
        let planned = engine.planner().plan(scene, Arc::new(camera), &wanted, &run, last.as_ref())?;
        last = Some(planned.clone());
        let rendered = sequence.render(&mut engine, planned, &run)?.rendered();
        all_ms.push(started.elapsed().as_secs_f64() * 1e3 - rendered.call.compile);
        if all_ms.iter().sum::<f64>() > 1e3 * SECONDS_MAX {
            break;
        }
    }
    Ok(all_ms)
}

//! Times each kernel on the device, in scenes that ask for different ones: `cargo bench`. `cargo test --benches` runs each once, on a small image.

use anamorph::internals::engine::plan::Wanted;
use anamorph::internals::engine::{Engine, RunOptions};
use anamorph::internals::gpu::device::NO_ADAPTER;
use anamorph::internals::gpu::{Gpu, GpuOptions};
use anamorph::internals::image::frame::Channel;
use anamorph::internals::input::Loading;
use anamorph::internals::scene::Scene;
use anamorph::internals::tools::example::EXAMPLES;
use criterion::Criterion;
use std::time::Duration;

/// One GLC, a few, hundreds of triangles of them, a ray a pixel, a curve a pixel, a chain, and a lens.
const SCENES: [&str; 7] =
    ["city-cross-slit", "cow-panorama", "surround", "fisheye", "twist-curved", "terrain-bottom-up", "glass-ball"];

const FRAMES: usize = 10;

fn main() -> anamorph::internals::input::Result<()> {
    let bench = std::env::args().any(|a| a == "--bench");
    let size = if bench { ["image.width=800", "image.height=600"] } else { ["image.width=96", "image.height=72"] };
    let Some(gpu) = Gpu::open(&GpuOptions::default())? else {
        println!("skipped: {NO_ADAPTER}");
        return Ok(());
    };
    if !gpu.has.timestamps {
        println!("skipped: adapter {} has no timestamps", gpu.info.name);
        return Ok(());
    }
    let mut engine = Engine::new(gpu);
    let mut criterion = Criterion::default().sample_size(FRAMES).configure_from_args();
    for name in SCENES {
        kernels(&mut criterion, &mut engine, name, &size.map(str::to_owned))?;
    }
    criterion.final_summary();
    Ok(())
}

/// Every kernel of a frame of an example, each by the time on the device of its own passes.
fn kernels(
    criterion: &mut Criterion,
    engine: &mut Engine,
    name: &str,
    set: &[String],
) -> anamorph::internals::input::Result<()> {
    let Some(example) = EXAMPLES.iter().find(|e| e.name == name) else {
        return Err(anamorph::internals::input::Error::input(format!("there is no example {name}")));
    };
    let folder = tempfile::tempdir()
        .map_err(|e| anamorph::internals::input::Error::work(format!("no temporary folder: {e}")))?;
    let scene = Scene::load(&example.write(folder.path())?, set, 0.0, &Loading::default())?;
    let camera = scene.camera()?;
    let wanted = Wanted { srgb8: true, ..Wanted::of(vec![Channel::T, Channel::TriangleId]) };
    let mut frames = engine.prepare(&scene, &camera, &wanted, &RunOptions::default())?;
    frames.frame()?;
    let stages: Vec<&str> = frames.stages().iter().map(|s| s.0).collect();
    let mut group = criterion.benchmark_group(name);
    for stage in stages {
        group.bench_function(stage, |bencher| {
            bencher.iter_custom(|count| {
                let mut ms = 0.0;
                for _ in 0..count {
                    frames.frame().expect("a frame like the first");
                    ms += frames.stages().iter().find(|s| s.0 == stage).map_or(0.0, |s| s.1);
                }
                Duration::from_secs_f64(ms / 1e3)
            });
        });
    }
    group.finish();
    Ok(())
}

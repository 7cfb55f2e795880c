//! Times of frames of a city with a part that does not show, over those of the same frames without it: medians of pairs in turn, with
//! intervals that hold the median with 95 % probability. It prints a line for each part. Arguments: the number of pairs (30).
//!
//! A frame is timed from the first upload until its results are complete on the device; a call also plans and uploads all anew.

use anamorph::internals::engine::plan::Wanted;
use anamorph::internals::engine::{Engine, Frames, RunOptions};
use anamorph::internals::gpu::device::GpuOptions;
use anamorph::internals::image::png_bytes;
use anamorph::internals::input::{Error, Loading, Result};
use anamorph::internals::scene::Scene;
use anamorph::internals::scene::volume::{ControlPoint, Grid, Mode, Volume, placed};
use anamorph_lab::bench::times::Ratio;
use glam::{DMat3, DVec3};
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

/// 15,000 triangles in an image of 640 x 480 pixels, in the light of a sun.
const CITY: &str = "image = { width = 640, height = 480 }\n[[mesh]]\nbuiltin = \"city\"\ntriangles = 15000\n\
                    [[light]]\ndirection = [-1, -2, -1.2]\n";

const VIEW: &str = "eye = [0, 26, 60]\ntarget = [0, 4, 0]\nvfov = 40\n";

/// A part, and scenes with it and without it.
type Pair = (&'static str, Scene, Scene);

fn main() -> Result<()> {
    let pairs = std::env::args().nth(1).map_or(Ok(30), |count| count.parse());
    let pairs: usize = pairs.map_err(|_| Error::input("use: in_view [PAIRS]"))?;
    let folder = tempfile::tempdir().map_err(|e| Error::work(e.to_string()))?;
    let mut engine = Engine::open(&GpuOptions::default())?.ok_or_else(|| Error::input("no adapter"))?;
    println!("| part out of view | frame | call | passes with and without | the same picture |\n|---|---|---|---|---|");
    for (name, with, without) in all(folder.path())? {
        let mut both = [start(&mut engine, &with)?, start(&mut engine, &without)?];
        let mut frame_ms = [Vec::new(), Vec::new()];
        for _ in 0..pairs {
            for (frames, ms) in both.iter_mut().zip(&mut frame_ms) {
                ms.push(Some(frames.frame()?));
            }
        }
        let [own, bare] = both;
        let [own, bare] = [own.finish()?, bare.finish()?];
        let mut call_ms = [Vec::new(), Vec::new()];
        for _ in 0..pairs {
            for (scene, ms) in [&with, &without].into_iter().zip(&mut call_ms) {
                let started = Instant::now();
                start(&mut engine, scene)?.finish()?;
                ms.push(Some(started.elapsed().as_secs_f64() * 1e3));
            }
        }
        let passes = [own.passes.total(), bare.passes.total()];
        let [frame, call] = [frame_ms, call_ms].map(|[with, without]| text(Ratio::of(&with, &without)));
        println!("| {name} | {frame} | {call} | {}, {} | {} |", passes[0], passes[1], own.srgb8 == bare.srgb8);
    }
    Ok(())
}

fn start(engine: &mut Engine, scene: &Scene) -> Result<Frames> {
    let wanted = Wanted { srgb8: true, ..Wanted::of(Vec::new()) };
    engine.prepare(scene, scene.camera()?, &wanted, &RunOptions::default())
}

fn text(ratio: Option<Ratio>) -> String {
    let Some(Ratio { median, interval }) = ratio else { return "none".into() };
    interval.map_or(format!("{median:.3}"), |[lo, hi]| format!("{median:.3} ({lo:.3} to {hi:.3})"))
}

fn all(folder: &Path) -> Result<Vec<Pair>> {
    let load = |parts: &str, camera: &str| {
        let path = folder.join("scene.toml");
        let text = format!("{CITY}{parts}\n[camera]\n{camera}");
        std::fs::write(&path, text).map_err(|e| Error::work(e.to_string()))?;
        Scene::load(&path, &[], 0.0, &Loading::default())
    };
    let write =
        |name: &str, bytes: &[u8]| std::fs::write(folder.join(name), bytes).map_err(|e| Error::work(e.to_string()));
    let texels: Vec<u8> = (0..64u8).flat_map(|k| [4 * k, 200, 90]).collect();
    write("image.png", &png_bytes(8, 8, &texels)?)?;
    let pinhole = |parts: &str| load(parts, &format!("kind = \"pinhole\"\n{VIEW}line_time = 0.001\n"));
    let with = |name: &'static str, part: &str| Ok((name, pinhole(part)?, pinhole("")?));
    let glass = format!(
        "kind = \"refraction\"\nior = 1.5\nfresnel = true\ndepth = 4\n\
         lens = {{ shape = \"sphere\", center = [0, 40, 90], radius = 3 }}\n\
         eye = {{ kind = \"pinhole\", {} }}\n",
        VIEW.trim().replace('\n', ", ")
    );
    let quad = "[[mesh]]\nbuiltin = \"plane\"\nsize = 4\ntranslate = [0, 40, 90]\ntexture = \"image.png\"";
    let moving = "[[mesh]]\nbuiltin = \"box\"\n\
                  translate = [{ frame = 0, value = [0, 40, 90] }, { frame = 1, value = [3, 40, 90] }]";
    let projector = "[[projector_light]]\nimage = \"image.png\"\nmode = \"light\"\n\
                     camera = { kind = \"pinhole\", eye = [0, 30, 0], target = [0, 60, 1], vfov = 40 }";
    let floor = "[[mesh]]\nbuiltin = \"plane\"\nsize = 8\ntranslate = [0, -9, 300]\n";
    let caustics = "[caustics]\nlight = { kind = \"refraction\", ior = 1.5, depth = 2, \
         eye = { kind = \"pinhole\", eye = [0, -4, 300], target = [0, -9, 300], up = [0, 0, 1], vfov = 40 }, \
         lens = { shape = \"sphere\", center = [0, -6, 300], radius = 0.5 } }\n\
         receivers = [{ origin = [-3, -9, 303], u = [6, 0, 0], v = [0, 0, -6], texels = [100, 100] }]";
    Ok(vec![
        with("a black light with shadows", "[[light]]\nposition = [0, 40, 0]\ncolor = [0, 0, 0]\nshadows = true")?,
        ("a glass ball", load("", &glass)?, load("", &format!("kind = \"pinhole\"\n{VIEW}"))?),
        with("a moving box", moving)?,
        with("a projector light that lights nothing", projector)?,
        with("a sphere", "[[spheres]]\ncenters = [[0, 40, 90]]\nradius = 3")?,
        ("a volume", Scene { volume: Some(volume()), ..pinhole("")? }, pinhole("")?),
        with("an image on a quad", quad)?,
        ("caustics", pinhole(&format!("{floor}{caustics}"))?, pinhole(floor)?),
        with("a lamp below the ground", "[[light]]\nposition = [0, -9, 0]\ndistance = 30\nshadows = true")?,
    ])
}

/// A fog behind the camera.
fn volume() -> Volume {
    let sides = [17; 3];
    let to_world = placed(sides, DVec3::new(0.0, 40.0, 90.0), DVec3::splat(0.5), DMat3::IDENTITY);
    let point = |value: f32| ControlPoint { value, colour: [value; 3], extinction: 0.2 * value };
    let grid = Grid { sides, values: (0..17 * 17 * 17).map(|k| (k % 5) as f32 / 5.0).collect(), to_world };
    Volume { grid: Arc::new(grid), transfer: [0.0, 1.0].map(point).into(), mode: Mode::Composite, is_lit: false }
}

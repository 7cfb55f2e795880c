//! `make gallery`: renders every example that is after a figure to FOLDER/gallery/NAME.png, and all of them, small, into
//! the contact sheet FOLDER/gallery.png. FOLDER is the one argument; after it may come the names of those that are rendered anew, where
//! the others are there already.

#[path = "common/sheet.rs"]
mod sheet;

#[path = "common/dress.rs"]
mod dress;

use anamorph::internals::camera::Camera;
use anamorph::internals::engine::combinations::at_once;
use anamorph::internals::engine::plan::Wanted;
use anamorph::internals::engine::plan::samples::sample_offsets;
use anamorph::internals::engine::{Engine, RunOptions};
use anamorph::internals::gpu::Gpu;
use anamorph::internals::gpu::device::NO_ADAPTER;
use anamorph::internals::image::frame::Channel;
use anamorph::internals::image::{toned8, write_png};
use anamorph::internals::input::{Error, Result};
use anamorph::internals::scene::Scene;
use anamorph::internals::tools::example::{Example, gallery};
use dress::dressed;
use image::RgbImage;
use std::path::Path;
use std::time::Instant;

const COLUMNS: u32 = 5;

fn main() -> Result<()> {
    let folder = std::env::args_os().nth(1).ok_or_else(|| Error::input("use: gallery FOLDER"))?;
    let (folder, pictures) = (Path::new(&folder), Path::new(&folder).join("gallery"));
    std::fs::create_dir_all(&pictures).map_err(|e| Error::work(format!("{}: {e}", pictures.display())))?;
    let mut engine = Engine::new(Gpu::open(&Default::default())?.ok_or_else(|| Error::work(NO_ADAPTER))?);
    let mut small = Vec::new();
    let asked: Vec<String> = std::env::args().skip(2).collect();
    for example in gallery() {
        let path = pictures.join(format!("{}.png", example.name));
        let is_asked = asked.is_empty() || asked.iter().any(|name| name == example.name) || !path.is_file();
        let picture = if is_asked { render(&mut engine, example, &pictures)? } else { known(&path)? };
        small.push((example.name, picture));
    }
    let sheet = sheet::sheet(&small, COLUMNS);
    write_png(&folder.join("gallery.png"), sheet.width(), sheet.height(), &sheet)
}

/// A picture that is there already, as large as a cell of the sheet allows.
fn known(path: &Path) -> Result<RgbImage> {
    let wrong = |e: image::ImageError| Error::input(format!("{}: {e}; remove it", path.display()));
    let picture = image::open(path).map_err(wrong)?.into_rgba8();
    Ok(sheet::small(picture.width(), picture.height(), &picture))
}

/// Samples of a pixel; of cameras that take a frame each, fewer.
const SAMPLES: u32 = 16;
const FRAMES: u32 = 4;

/// Writes the example's picture into the folder, in good light; returns it as large as a cell of the sheet allows.
fn render(engine: &mut Engine, example: &Example, folder: &Path) -> Result<RgbImage> {
    let scene = dressed(Scene::load(&example.write(folder)?, &[], 0.0)?);
    let camera = scene.camera()?;
    let (width, height) = (camera.width, camera.height);
    let started = Instant::now();
    let sums = if at_once(&scene, &camera, SAMPLES) {
        colours(engine, &scene, &camera, Wanted { samples: SAMPLES, ..Wanted::of(COLOURS.to_vec()) })?
    } else {
        let wanted = Wanted { frames: FRAMES, ..Wanted::of(COLOURS.to_vec()) };
        let mut sums = vec![0.0; COLOURS.len() * width as usize * height as usize];
        for place in sample_offsets(FRAMES) {
            let moved = camera.with_sample_offset(place.x, place.y);
            let frame = colours(engine, &scene, &moved, wanted.clone())?;
            sums.iter_mut().zip(frame).for_each(|(sum, c)| *sum += c / FRAMES as f32);
        }
        sums
    };
    let pixels = width as usize * height as usize;
    let shown = |k: usize, c: usize| toned8(scene.tone, sums[c * pixels + k]);
    let rgba: Vec<u8> = (0..pixels).flat_map(|k| [shown(k, 0), shown(k, 1), shown(k, 2), 255]).collect();
    write_png(&folder.join(format!("{}.png", example.name)), width, height, &rgba)?;
    println!("{:<22}{width}x{height}, {:.1} s", example.name, started.elapsed().as_secs_f64());
    Ok(sheet::small(width, height, &rgba))
}

const COLOURS: [Channel; 3] = [Channel::R, Channel::G, Channel::B];

/// Linear light, channel by channel.
fn colours(engine: &mut Engine, scene: &Scene, camera: &Camera, wanted: Wanted) -> Result<Vec<f32>> {
    let frame = engine.render(scene, camera, &wanted, &RunOptions::default())?.frame;
    Ok(COLOURS.iter().flat_map(|c| frame.f32(*c).unwrap_or_default()).copied().collect())
}

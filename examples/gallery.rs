//! `make gallery`: renders every example that is after a figure to FOLDER/gallery/NAME.png, and all of them, small, into
//! the contact sheet FOLDER/gallery.png. FOLDER is the one argument.

#[path = "common/sheet.rs"]
mod sheet;

use anamorph::engine::{Engine, RunOptions};
use anamorph::example::{Example, gallery};
use anamorph::gpu::Gpu;
use anamorph::gpu::device::NO_ADAPTER;
use anamorph::output::write_png;
use anamorph::plan::Wanted;
use anamorph::scene::Scene;
use anamorph::{Error, Result};
use image::RgbImage;
use std::path::Path;

const COLUMNS: u32 = 5;

fn main() -> Result<()> {
    let folder = std::env::args_os().nth(1).ok_or_else(|| Error::input("use: gallery FOLDER"))?;
    let (folder, pictures) = (Path::new(&folder), Path::new(&folder).join("gallery"));
    std::fs::create_dir_all(&pictures).map_err(|e| Error::work(format!("{}: {e}", pictures.display())))?;
    let mut engine = Engine::new(Gpu::open(&Default::default())?.ok_or_else(|| Error::work(NO_ADAPTER))?);
    let mut small = Vec::new();
    for example in gallery() {
        small.push((example.name, render(&mut engine, example, &pictures)?));
    }
    let sheet = sheet::sheet(&small, COLUMNS);
    write_png(&folder.join("gallery.png"), sheet.width(), sheet.height(), &sheet)
}

/// Writes the example's picture into the folder; returns it as large as a cell of the sheet allows.
fn render(engine: &mut Engine, example: &Example, folder: &Path) -> Result<RgbImage> {
    let scene = Scene::load(&example.write(folder)?, &[], 0.0)?;
    let camera = scene.camera()?;
    let wanted = Wanted { srgb8: true, ..Wanted::of(Vec::new()) };
    let rendered = engine.render(&scene, &camera, &wanted, &RunOptions::default())?;
    let (width, height) = (camera.width, camera.height);
    let rgba = rendered.srgb8.ok_or_else(|| Error::work("no picture came back"))?;
    write_png(&folder.join(format!("{}.png", example.name)), width, height, &rgba)?;
    println!("{:<22}{width}x{height}, {:.0} ms", example.name, rendered.frame_ms.first().unwrap_or(&f64::NAN));
    Ok(sheet::small(width, height, &rgba))
}

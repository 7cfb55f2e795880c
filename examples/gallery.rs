//! `make gallery`: renders every example that is after a figure to FOLDER/gallery/NAME.png, and all of them, small, into
//! the contact sheet FOLDER/gallery.png. FOLDER is the one argument.

use anamorph::engine::{Engine, RunOptions};
use anamorph::example::{Example, gallery};
use anamorph::gpu::Gpu;
use anamorph::gpu::device::NO_ADAPTER;
use anamorph::output::write_png;
use anamorph::plan::Wanted;
use anamorph::scene::Scene;
use anamorph::{Error, Result};
use image::imageops::{FilterType, overlay, resize};
use image::{Rgb, RgbImage};
use std::path::Path;

/// A picture's place on the sheet, pixels, without its name.
const CELL: [u32; 2] = [240, 180];
/// Height of a name's line.
const LINE: u32 = 18;
const COLUMNS: u32 = 5;
const GAP: u32 = 4;
const PAPER: Rgb<u8> = Rgb([255; 3]);
const INK: Rgb<u8> = Rgb([0; 3]);

fn main() -> Result<()> {
    let folder = std::env::args_os().nth(1).ok_or_else(|| Error::input("use: gallery FOLDER"))?;
    let (folder, pictures) = (Path::new(&folder), Path::new(&folder).join("gallery"));
    std::fs::create_dir_all(&pictures).map_err(|e| Error::work(format!("{}: {e}", pictures.display())))?;
    let mut engine = Engine::new(Gpu::open(&Default::default())?.ok_or_else(|| Error::work(NO_ADAPTER))?);
    let mut small = Vec::new();
    for example in gallery() {
        small.push((example.name, render(&mut engine, example, &pictures)?));
    }
    let sheet = sheet(&small);
    write_png(&folder.join("gallery.png"), sheet.width(), sheet.height(), &sheet)
}

/// Writes the example's picture into the folder; returns it as large as a cell of the sheet allows.
fn render(engine: &mut Engine, example: &Example, folder: &Path) -> Result<RgbImage> {
    let scene = Scene::load(&example.write(folder)?, &[], 0.0)?;
    let camera = scene.camera()?;
    let wanted = Wanted { channels: Vec::new(), srgb8: true, counting: false };
    let rendered = engine.render(&scene, &camera, &wanted, &RunOptions::default())?;
    let (width, height) = (camera.width, camera.height);
    let rgba = rendered.srgb8.ok_or_else(|| Error::work("no picture came back"))?;
    write_png(&folder.join(format!("{}.png", example.name)), width, height, &rgba)?;
    println!("{:<22}{width}x{height}, {:.0} ms", example.name, rendered.frame_ms.first().unwrap_or(&f64::NAN));
    let rgb = |x: u32, y: u32| {
        let at = rgba.len() / (width * height) as usize * (y * width + x) as usize;
        Rgb([rgba[at], rgba[at + 1], rgba[at + 2]])
    };
    let shrink = (f64::from(CELL[0]) / f64::from(width)).min(f64::from(CELL[1]) / f64::from(height));
    let [width_small, height_small] = [width, height].map(|n| (f64::from(n) * shrink).round() as u32);
    Ok(resize(&RgbImage::from_fn(width, height, rgb), width_small, height_small, FilterType::Triangle))
}

/// All pictures in rows, each over its name.
fn sheet(pictures: &[(&str, RgbImage)]) -> RgbImage {
    let rows = (pictures.len() as u32).div_ceil(COLUMNS);
    let (pitch_x, pitch_y) = (CELL[0] + GAP, CELL[1] + LINE);
    let mut sheet = RgbImage::from_pixel(COLUMNS * pitch_x + GAP, rows * pitch_y + GAP, PAPER);
    for (k, (name, picture)) in (0u32..).zip(pictures) {
        let (x, y) = (GAP + k % COLUMNS * pitch_x, GAP + k / COLUMNS * pitch_y);
        overlay(&mut sheet, picture, x.into(), (y + CELL[1] - picture.height()).into());
        write(&mut sheet, name, x, y + CELL[1] + 3);
    }
    sheet
}

/// Letters of 3 x 5 dots, a row a number, its highest of three bits on the left: a to z, then the hyphen.
#[rustfmt::skip] // a table
const LETTERS: [[u8; 5]; 27] = [
    [2, 5, 7, 5, 5], [6, 5, 6, 5, 6], [3, 4, 4, 4, 3], [6, 5, 5, 5, 6], [7, 4, 6, 4, 7], [7, 4, 6, 4, 4], [3, 4, 5, 5, 3],
    [5, 5, 7, 5, 5], [7, 2, 2, 2, 7], [1, 1, 1, 5, 2], [5, 5, 6, 5, 5], [4, 4, 4, 4, 7], [5, 7, 7, 5, 5], [6, 5, 5, 5, 5],
    [2, 5, 5, 5, 2], [6, 5, 6, 4, 4], [2, 5, 5, 6, 3], [6, 5, 6, 5, 5], [3, 4, 2, 1, 6], [7, 2, 2, 2, 2], [5, 5, 5, 5, 7],
    [5, 5, 5, 5, 2], [5, 5, 7, 7, 5], [5, 5, 2, 5, 5], [5, 5, 2, 2, 2], [7, 1, 2, 4, 7], [0, 0, 7, 0, 0],
];

/// Writes a name, its upper left corner at (x, y), in dots of 2 x 2 pixels; what is no letter is a hyphen.
fn write(sheet: &mut RgbImage, name: &str, x: u32, y: u32) {
    for (k, c) in (0u32..).zip(name.bytes()) {
        let letter = LETTERS[if c.is_ascii_lowercase() { usize::from(c - b'a') } else { 26 }];
        for (i, j) in (0..6).flat_map(|i| (0..10).map(move |j| (i, j))) {
            if letter[j as usize / 2] >> (2 - i / 2) & 1 == 1 {
                sheet.put_pixel(x + 8 * k + i, y + j, INK);
            }
        }
    }
}

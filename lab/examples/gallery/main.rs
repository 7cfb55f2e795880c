//! `make gallery`: renders every example that is after a figure, and those of what no paper has. Into FOLDER go the page gallery.md, with
//! pictures and scenes, the contact sheet gallery.jpg, and moving pictures. FOLDER is the one argument; after it may come the names of those
//! that are rendered anew, where the others are there already.

mod beside;
mod dress;
mod moving;
mod page;
#[path = "../common/sheet.rs"]
mod sheet;

use anamorph::internals::camera::Camera;
use anamorph::internals::camera::exposure::Sample;
use anamorph::internals::engine::combinations::at_once;
use anamorph::internals::engine::plan::Wanted;
use anamorph::internals::engine::plan::samples::sample_offsets;
use anamorph::internals::engine::{Engine, RunOptions};
use anamorph::internals::gpu::Gpu;
use anamorph::internals::gpu::device::NO_ADAPTER;
use anamorph::internals::image::frame::Channel;
use anamorph::internals::image::{toned8, write_text};
use anamorph::internals::input::{Error, Loading, Result};
use anamorph::internals::scene::Scene;
use anamorph::internals::tools::example::Example;
use anamorph_lab::gallery::gallery;
use anamorph_lab::rivals;
use beside::{Beside, beside};
use dress::dressed;
use image::codecs::jpeg::JpegEncoder;
use image::{ImageError, RgbImage, imageops};
use moving::{Moving, moving};
use std::fs::File;
use std::io::BufWriter;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Columns of the contact sheet.
const COLUMNS: u32 = 5;
/// Pixels along the longer side of an example's picture, and of one beside it.
const SIZE: u32 = 1000;
const SIZE_BESIDE: u32 = 600;
/// Samples of a pixel; of cameras that take a frame each, fewer, but where a shutter is open.
const SAMPLES: u32 = 16;
const FRAMES: u32 = 4;
/// Of JPEG, percent.
const QUALITY: u8 = 78;

fn main() -> Result<()> {
    let mut words = std::env::args().skip(1);
    let folder = PathBuf::from(words.next().ok_or_else(|| Error::input("use: gallery FOLDER"))?);
    let asked: Vec<String> = words.collect();
    let gpu = Gpu::open(&Default::default())?.ok_or_else(|| Error::work(NO_ADAPTER))?;
    let mut studio = Studio { engine: Engine::new(gpu), pictures: folder.join("gallery") };
    std::fs::create_dir_all(&studio.pictures).map_err(|e| broken(&studio.pictures, e))?;
    let (mut small, mut shown) = (Vec::new(), Vec::new());
    for example in gallery() {
        let is_asked = |path: &Path| asked.is_empty() || asked.iter().any(|n| n == example.name) || !path.is_file();
        let started = Instant::now();
        let path = studio.path(example.name);
        if is_asked(&path) {
            let scene = studio.scene(example, "", 0.0, SIZE)?;
            save(&path, &studio.picture(scene, None)?)?;
        }
        for beside in beside(example.name) {
            let path = studio.path(&page::name_beside(beside));
            if is_asked(&path) {
                let picture = studio.picture_beside(example, beside)?;
                save(&path, &picture)?;
            }
        }
        if let Some(moving) = moving(example.name) {
            let path = studio.pictures.join(format!("{}-moving.png", example.name));
            if is_asked(&path) {
                studio.move_picture(example, moving, &path)?;
            }
        }
        let picture = image::open(&path).map_err(|e| broken(&path, e))?.into_rgb8();
        small.push((example.name, sheet::small(&picture)));
        shown.push(studio.shown(example)?);
        println!(
            "{:<22}{}x{}, {:.1} s",
            example.name,
            picture.width(),
            picture.height(),
            started.elapsed().as_secs_f64()
        );
    }
    save(&folder.join("gallery.jpg"), &sheet::sheet(&small, COLUMNS))?;
    write_text(&folder.join("gallery.md"), &page::page(&shown, &studio.engine.gpu.info.name))
}

/// Renders examples into the folder of pictures.
struct Studio {
    engine: Engine,
    pictures: PathBuf,
}

impl Studio {
    fn path(&self, name: &str) -> PathBuf {
        self.pictures.join(format!("{name}.jpg"))
    }

    /// A frame of the example as its file says but for `change`, its longer side `size` pixels long.
    fn scene(&self, example: &Example, change: &str, frame: f64, size: u32) -> Result<Scene> {
        let path = example.write(&self.pictures)?;
        let (width, height) = Scene::load(&path, &[], 0.0, &Loading::default())?.size.unwrap_or((1, 1));
        let scaled = |n: u32| (f64::from(n * size) / f64::from(width.max(height))).round();
        let mut changes = vec![format!("image.width={}", scaled(width)), format!("image.height={}", scaled(height))];
        changes.extend(change.split_whitespace().map(str::to_owned));
        Scene::load(&path, &changes, frame, &Loading::default())
    }

    fn picture_beside(&mut self, example: &Example, beside: &Beside) -> Result<RgbImage> {
        let [left, top, width, height] = beside.close.unwrap_or([0.0, 0.0, 1.0, 1.0]);
        let scene =
            self.scene(example, beside.change, beside.frame, (f64::from(SIZE_BESIDE) / width).round() as u32)?;
        let whole = self.picture(scene, beside.rival)?;
        let across = |share: f64| (share * f64::from(whole.width())).round() as u32;
        let down = |share: f64| (share * f64::from(whole.height())).round() as u32;
        Ok(imageops::crop_imm(&whole, across(left), down(top), across(width), down(height)).to_image())
    }

    /// In good light; by a rival, whose points are not where rays meet triangles, without shadows.
    fn picture(&mut self, scene: Scene, rival: Option<&str>) -> Result<RgbImage> {
        let scene = &if rival.is_none() { dressed(scene) } else { scene };
        let camera = scene.camera()?;
        let rival = rival.map(rivals::parse).transpose().map_err(Error::input)?;
        let options = RunOptions { rival, ..Default::default() };
        let sums = if rival.is_none() && at_once(scene, &camera, SAMPLES) {
            let wanted = Wanted { samples: SAMPLES, ..Wanted::of(COLOURS.to_vec()) };
            self.colours(scene, &camera, wanted, &options)?
        } else {
            let count = if scene.exposure.shutter > 0.0 { SAMPLES } else { FRAMES };
            let wanted = Wanted { frames: count, ..Wanted::of(COLOURS.to_vec()) };
            let mut sums = vec![0.0; COLOURS.len() * camera.width as usize * camera.height as usize];
            for (number, place) in (0..).zip(sample_offsets(count)) {
                let moved = camera.of_sample(place.into(), Sample { number, count })?;
                let frame = self.colours(scene, &moved, wanted.clone(), &options)?;
                sums.iter_mut().zip(frame).for_each(|(sum, c)| *sum += c / count as f32);
            }
            sums
        };
        let pixels = sums.len() / COLOURS.len();
        let bytes = (0..pixels).flat_map(|k| [0, 1, 2].map(|c| toned8(scene.tone, sums[c * pixels + k]))).collect();
        RgbImage::from_raw(camera.width, camera.height, bytes).ok_or_else(|| Error::work("a picture without pixels"))
    }

    /// Linear light, channel by channel.
    fn colours(&mut self, scene: &Scene, camera: &Camera, wanted: Wanted, options: &RunOptions) -> Result<Vec<f32>> {
        let frame = self.engine.render(scene, camera, &wanted, options)?.frame;
        Ok(COLOURS.iter().flat_map(|c| frame.f32(*c).unwrap_or_default()).copied().collect())
    }

    /// What the page says of an example: counted and timed as its file is, without the sky.
    fn shown(&mut self, example: &'static Example) -> Result<page::Shown> {
        let scene = Scene::load(&example.write(&self.pictures)?, &[], 0.0, &Loading::default())?;
        let camera = scene.camera()?;
        let options = RunOptions { repeat: TIMED, ..Default::default() };
        let mut ms = self.engine.render(&scene, &camera, &Wanted::of(COLOURS.to_vec()), &options)?.frame_ms;
        ms.sort_by(f64::total_cmp);
        let counted = anamorph::internals::jobs::counted(&scene, &camera);
        Ok(page::Shown {
            example,
            size: (camera.width, camera.height),
            kind: camera.kind,
            counted,
            ms: ms[ms.len() / 2],
        })
    }

    /// A picture that moves there and back, as an animated PNG.
    fn move_picture(&mut self, example: &Example, moving: &Moving, path: &Path) -> Result<()> {
        let steps = 0..moving.steps;
        let pictures: Vec<RgbImage> = steps
            .map(|k| self.picture(self.scene(example, &moving.change(k), 0.0, SIZE_MOVING)?, None))
            .collect::<Result<_>>()?;
        write_moving(path, &pictures)
    }
}

const COLOURS: [Channel; 3] = [Channel::R, Channel::G, Channel::B];
/// Frames that an example is timed by.
const TIMED: u32 = 3;
/// Pixels along the longer side of a picture that moves.
const SIZE_MOVING: u32 = 400;

fn broken(path: &Path, e: impl std::fmt::Display) -> Error {
    Error::work(format!("{}: {e}", path.display()))
}

fn save(path: &Path, picture: &RgbImage) -> Result<()> {
    let file = File::create(path).map_err(|e| broken(path, e))?;
    let mut encoder = JpegEncoder::new_with_quality(BufWriter::new(file), QUALITY);
    encoder.encode_image(picture).map_err(|e: ImageError| broken(path, e))
}

/// Writes an animated PNG that plays ten pictures a second, for ever. To keep it small, a picture has only the pixels that differ from the
/// picture before, and 6 bits per channel.
fn write_moving(path: &Path, pictures: &[RgbImage]) -> Result<()> {
    let rounded = |channel: u8| channel.saturating_add(2) & 0xfc;
    let write = || {
        let mut encoder =
            png::Encoder::new(BufWriter::new(File::create(path)?), pictures[0].width(), pictures[0].height());
        encoder.set_color(png::ColorType::Rgba);
        encoder.set_compression(png::Compression::High);
        encoder.set_animated(pictures.len() as u32, 0)?;
        encoder.set_frame_delay(1, 10)?;
        encoder.set_blend_op(png::BlendOp::Over)?;
        let mut writer = encoder.write_header()?;
        let mut before = Vec::new();
        for picture in pictures {
            let pixels: Vec<[u8; 3]> = picture.pixels().map(|pixel| pixel.0.map(rounded)).collect();
            let changed = pixels.iter().enumerate().map(|(k, pixel)| match *pixel {
                _ if before.get(k) == Some(pixel) => [0; 4],
                [r, g, b] => [r, g, b, 255],
            });
            writer.write_image_data(&changed.flatten().collect::<Vec<u8>>())?;
            before = pixels;
        }
        writer.finish()
    };
    write().map_err(|e: png::EncodingError| broken(path, e))
}

//! Close-ups beside each other: lines that this engine draws through a camera, and lines that were drawn in a cube map and looked up there
//! (Lorenz and Doellner 2009, figures 7 and 8).

use super::case::{Case, Source};
use super::race::COLOURS;
use anamorph::internals::camera::Camera;
use anamorph::internals::camera::kinds::pinhole::Pinhole;
use anamorph::internals::camera::spec::{CameraKind, CameraSpec};
use anamorph::internals::engine::combinations::at_once;
use anamorph::internals::engine::plan::Wanted;
use anamorph::internals::engine::plan::samples::sample_offsets;
use anamorph::internals::engine::{Engine, RunOptions};
use anamorph::internals::image::{toned8, write_png};
use anamorph::internals::input::{Error, Loading, Result};
use anamorph::internals::scene::Scene;
use anamorph::internals::scene::style::{Hatching, Line, Outline, Style};
use glam::DVec3;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// A part of a scene's picture, in styles, by both techniques.
pub struct Closeups {
    pub name: &'static str,
    example: &'static str,
    set: &'static [&'static str],
    /// Left, top, width and height, px.
    part: [u32; 4],
}

/// What was drawn.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Drawn {
    pub name: String,
    pub pictures: Vec<Picture>,
}

#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Picture {
    pub label: String,
    /// Beside the results.
    pub file: String,
    /// dB of its part against the mean of [`TRUTH`] frames.
    pub psnr: f64,
}

/// The paper's figures.
pub const LORENZ: [Closeups; 2] = [
    Closeups {
        name: "Lorenz 7: close-ups of the cylinder",
        example: "city-cylinder",
        set: &["image.width=800", "image.height=600"],
        part: [280, 280, 160, 120],
    },
    Closeups {
        name: "Lorenz 8: close-ups of the camera texture",
        example: "deformation",
        set: &["image.width=800", "image.height=600"],
        part: [350, 240, 160, 120],
    },
];

/// Samples per pixel, for both techniques.
const SAMPLES: u32 = 16;

/// Of a texel of the cube map: with more of them an adapter that binds 128 MiB holds no face whole, which outlines need.
const FACE_SAMPLES: u32 = 8;

/// Frames, each with places of its own, that the truth is the mean of.
const TRUTH: u32 = 36;

/// Texels of a face of the cube map.
const SIDE: u32 = 1024;

const INK: [f32; 3] = [0.02, 0.02, 0.08];

/// Pen and ink, and a solid wireframe that grows thinner with depth; lines `times` as wide.
fn styles(times: f64) -> [(&'static str, Style); 2] {
    let line = |width: f64, depth: f64| Line { width: times * width, colour: INK, depth };
    let hatching = Hatching { spacing: 5.0 * times, ink: INK, paper: [1.0; 3] };
    let outline = Outline { line: line(1.5, f64::INFINITY), crease: 40.0 };
    [
        ("pen and ink", Style { hatching: Some(hatching), outline: Some(outline), ..Style::default() }),
        ("wireframe thinner with depth", Style { wireframe: Some(line(2.5, 40.0)), ..Style::default() }),
    ]
}

impl Closeups {
    /// Renders all, and writes their parts into a folder.
    ///
    /// # Errors
    /// [`Error`] where the example, the device or a file fails.
    pub fn draw(&self, engine: &mut Engine, folder: &Path) -> Result<Drawn> {
        let files = tempfile::tempdir().map_err(|e| Error::work(format!("no temporary folder: {e}")))?;
        let path = Case::new("", Source::Example(self.example), Vec::new()).write(files.path())?;
        let set: Vec<String> = self.set.iter().map(|s| (*s).to_owned()).collect();
        let plain = Scene { background: [1.0; 3], ..Scene::load(&path, &set, 0.0, &Loading::default())? };
        let camera = plain.camera()?;
        let mut pictures = Vec::new();
        // lines of the map are as wide as those of the picture where it is looked up
        let finer = texels_a_pixel(&camera, self.part);
        for (k, ((style, own), (_, of_map))) in styles(1.0).into_iter().zip(styles(finer)).enumerate() {
            let scene = Scene { style: own, ..plain.clone() };
            let truth = self.crop(&mean(engine, &scene, &camera, TRUTH)?, camera.width);
            let ours = self.crop(&several(engine, &scene, &camera)?, camera.width);
            let map = Scene { style: of_map, ..plain.clone() };
            let theirs = self.crop(&image_based(engine, &map, &camera)?, camera.width);
            for (technique, short, seen) in [("this engine", "ours", ours), ("image-based", "ib", theirs)] {
                let file = format!("closeup-{}-{}-{short}.png", self.example, k + 1);
                let rgb: Vec<u8> = seen.iter().flatten().map(|v| toned8(plain.tone, *v)).collect();
                write_png(&folder.join(&file), self.part[2], self.part[3], &rgb)?;
                pictures.push(Picture { label: format!("{style}, {technique}"), file, psnr: psnr(&truth, &seen) });
            }
        }
        Ok(Drawn { name: self.name.into(), pictures })
    }

    /// The part of a picture.
    fn crop(&self, picture: &[[f32; 3]], width: u32) -> Vec<[f32; 3]> {
        let [left, top, w, h] = self.part;
        let row = |y: u32| &picture[((top + y) * width + left) as usize..][..w as usize];
        (0..h).flat_map(row).copied().collect()
    }
}

/// Linear RGB of a frame.
fn frame(engine: &mut Engine, scene: &Scene, camera: &Camera, samples: u32, frames: u32) -> Result<Vec<[f32; 3]>> {
    let wanted = Wanted { samples, frames, ..Wanted::of(COLOURS.to_vec()) };
    let frame = engine.render(scene, camera, &wanted, &RunOptions::default())?.frame;
    let [r, g, b] = COLOURS.map(|c| frame.f32(c).unwrap_or_default());
    Ok((0..r.len()).map(|k| [r[k], g[k], b[k]]).collect())
}

/// The mean of frames at places of their own.
fn mean(engine: &mut Engine, scene: &Scene, camera: &Camera, count: u32) -> Result<Vec<[f32; 3]>> {
    let mut sums = vec![[0.0; 3]; camera.width as usize * camera.height as usize];
    for place in sample_offsets(count) {
        let own = frame(engine, scene, &camera.with_sample_offset(place.x, place.y), 1, count)?;
        sums.iter_mut().zip(own).for_each(|(sum, c)| (0..3).for_each(|k| sum[k] += c[k] / count as f32));
    }
    Ok(sums)
}

/// With several samples per pixel, at once where that goes.
fn several(engine: &mut Engine, scene: &Scene, camera: &Camera) -> Result<Vec<[f32; 3]>> {
    match at_once(scene, camera, SAMPLES) {
        true => frame(engine, scene, camera, SAMPLES, 1),
        false => mean(engine, scene, camera, SAMPLES),
    }
}

/// Six pictures from the camera's one eye, and between the nearest four texels of them what each pixel's ray shows.
fn image_based(engine: &mut Engine, scene: &Scene, camera: &Camera) -> Result<Vec<[f32; 3]>> {
    let middle = camera.ray(camera.width / 2, camera.height / 2);
    let eye = middle.ok_or_else(|| Error::input("the camera's middle pixel has no ray"))?.origin;
    let mut faces = Vec::new();
    for (forward, up) in FACES {
        let kind = CameraKind::new("pinhole", Pinhole { eye, target: eye + forward, up, vfov: 90.0 });
        let spec = CameraSpec { kind, t_range: camera.t_range };
        let face = Camera::in_scene(&spec, Some((SIDE, SIDE)), scene.surroundings(), &Loading::default())?;
        faces.push(frame(engine, scene, &face, FACE_SAMPLES, 1)?);
    }
    let seen = |k: u32| {
        let Some(ray) = camera.ray(k % camera.width, k / camera.width) else { return scene.background };
        let d = ray.direction;
        let ahead = |k: &usize| d.dot(FACES[*k].0);
        let face = (0..FACES.len()).max_by(|a, b| ahead(a).total_cmp(&ahead(b))).unwrap_or_default();
        let (forward, up) = FACES[face];
        let place = |along: DVec3| (0.5 + 0.5 * d.dot(along) / d.dot(forward)) * f64::from(SIDE) - 0.5;
        between(&faces[face], place(forward.cross(up)), place(-up))
    };
    Ok((0..camera.width * camera.height).map(seen).collect())
}

/// Forward and up of each side of a cube.
const FACES: [(DVec3, DVec3); 6] = [
    (DVec3::X, DVec3::Y),
    (DVec3::NEG_X, DVec3::Y),
    (DVec3::Z, DVec3::Y),
    (DVec3::NEG_Z, DVec3::Y),
    (DVec3::Y, DVec3::Z),
    (DVec3::NEG_Y, DVec3::Z),
];

/// Bilinear.
fn between(face: &[[f32; 3]], x: f64, y: f64) -> [f32; 3] {
    let last = f64::from(SIDE - 1);
    let (x, y) = (x.clamp(0.0, last), y.clamp(0.0, last));
    let (i, j) = (x.floor().min(last - 1.0), y.floor().min(last - 1.0));
    let (u, v) = ((x - i) as f32, (y - j) as f32);
    let texel = |di: usize, dj: usize| face[(j as usize + dj) * SIDE as usize + i as usize + di];
    [0, 1, 2].map(|k| {
        let above = texel(0, 0)[k] + u * (texel(1, 0)[k] - texel(0, 0)[k]);
        let below = texel(0, 1)[k] + u * (texel(1, 1)[k] - texel(0, 1)[k]);
        above + v * (below - above)
    })
}

/// Texels of the cube map in a face's middle for a pixel's width in the middle of a part.
fn texels_a_pixel(camera: &Camera, [left, top, width, height]: [u32; 4]) -> f64 {
    let (i, j) = (left + width / 2, top + height / 2);
    let direction = |i: u32| camera.ray(i, j).map(|ray| ray.direction.normalize());
    let angle = direction(i).zip(direction(i + 1)).map_or(1e-3, |(a, b)| a.angle_between(b));
    0.5 * f64::from(SIDE) * angle
}

fn psnr(truth: &[[f32; 3]], seen: &[[f32; 3]]) -> f64 {
    let square = |(a, b): (&[f32; 3], &[f32; 3])| (0..3).map(|k| f64::from(a[k] - b[k]).powi(2)).sum::<f64>();
    let mean = truth.iter().zip(seen).map(square).sum::<f64>() / (3 * truth.len()) as f64;
    -10.0 * mean.log10()
}

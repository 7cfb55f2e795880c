//! COLMAP's sparse models: a folder with `cameras` and `images`, as `.bin` or `.txt`. The centre of its first pixel is at (0.5, 0.5).

use super::{Calibration, Contents, Placed, Which, intrinsics};
use crate::camera::calibration::{Coefficients, Model, Projection};
use crate::input::{Error, Loading, Result};
use glam::{DQuat, DVec2, DVec3};
use std::fs::File;
use std::io::{BufRead, BufReader, Read as _};
use std::path::{Path, PathBuf};

/// COLMAP's models: the number in binary files, the name in text, and how many parameters follow.
const MODELS: [(i32, &str, usize); 18] = [
    (0, "SIMPLE_PINHOLE", 3),
    (1, "PINHOLE", 4),
    (2, "SIMPLE_RADIAL", 4),
    (3, "RADIAL", 5),
    (4, "OPENCV", 8),
    (5, "OPENCV_FISHEYE", 8),
    (6, "FULL_OPENCV", 12),
    (7, "FOV", 5),
    (8, "SIMPLE_RADIAL_FISHEYE", 4),
    (9, "RADIAL_FISHEYE", 5),
    (10, "THIN_PRISM_FISHEYE", 12),
    (11, "RAD_TAN_THIN_PRISM_FISHEYE", 16),
    (12, "SIMPLE_DIVISION", 4),
    (13, "DIVISION", 5),
    (14, "SIMPLE_FISHEYE", 3),
    (15, "FISHEYE", 4),
    (16, "EUCM", 6),
    (17, "EQUIRECTANGULAR", 2),
];

/// A camera as written.
struct Camera {
    id: u64,
    model: String,
    size: [u64; 2],
    parameters: Vec<f64>,
}

/// An image as written: its pose takes the world to the camera.
struct Image {
    name: String,
    camera: u64,
    rotation: DQuat,
    translation: DVec3,
}

/// A folder, or its file of cameras.
pub fn is_model(path: &Path) -> bool {
    path.is_dir() || matches!(path.file_name().and_then(|n| n.to_str()), Some("cameras.bin" | "cameras.txt"))
}

pub fn read(path: &Path, which: Which, loading: &Loading) -> Result<Calibration> {
    let cameras = file(path, "cameras");
    let refuse = |path: &Path, why: String| Error::input(format!("{}: {why}", path.display()));
    let all = load(&cameras, loading, camera_lines, camera_records)?;
    let by_id = |which: Which| {
        let all = all.iter().map(|c| (c.id, c)).collect();
        which.of(all).and_then(calibration).map_err(|why| refuse(&cameras, why))
    };
    let Which::Image(name) = which else { return by_id(which) };
    let images = file(path, "images");
    let image = in_order(&images, loading)?.into_iter().find(|i| i.name == name);
    let image = image.ok_or_else(|| refuse(&images, format!("has no image {name:?}")))?;
    let placed = Some(image.placed().map_err(|why| refuse(&images, why))?);
    Ok(Calibration { placed, ..by_id(Which::Index(image.camera))? })
}

/// All cameras, and the images, of which a model's folder may have none.
pub fn contents(path: &Path, loading: &Loading) -> Result<Contents> {
    let cameras = load(&file(path, "cameras"), loading, camera_lines, camera_records)?;
    let images = file(path, "images");
    let images = if images.exists() { load(&images, loading, image_lines, image_records)? } else { Vec::new() };
    let image = |image: Image| super::Image { placed: image.placed(), camera: image.camera, name: image.name };
    Ok(Contents {
        cameras: cameras.iter().map(|camera| (camera.id, calibration(camera))).collect(),
        images: images.into_iter().map(image).collect(),
    })
}

impl Image {
    fn placed(&self) -> std::result::Result<Placed, String> {
        let none = || format!("image {:?}: its pose is not finite, or its quaternion is 0", self.name);
        Placed::of_inverse(self.rotation, self.translation).ok_or_else(none)
    }
}

/// A folder, or the file of images.
pub fn has_images(path: &Path) -> bool {
    path.is_dir() || matches!(path.file_name().and_then(|n| n.to_str()), Some("images.bin" | "images.txt"))
}

/// The names of all images, in order.
pub fn images(path: &Path, loading: &Loading) -> Result<Vec<String>> {
    Ok(in_order(&file(path, "images"), loading)?.into_iter().map(|image| image.name).collect())
}

/// The poses of all images, in the order of their names.
pub fn poses(path: &Path, loading: &Loading) -> Result<Vec<Placed>> {
    let file = file(path, "images");
    let placed = |image: &Image| image.placed().map_err(|why| Error::input(format!("{}: {why}", file.display())));
    in_order(&file, loading)?.iter().map(placed).collect()
}

/// The images of a file, at least one, by name.
fn in_order(file: &Path, loading: &Loading) -> Result<Vec<Image>> {
    let mut images = load(file, loading, image_lines, image_records)?;
    images.sort_by(|a, b| a.name.cmp(&b.name));
    if let Some(twice) = images.windows(2).find(|pair| pair[0].name == pair[1].name) {
        return Err(Error::input(format!("{}: has two images {:?}", file.display(), twice[0].name)));
    }
    if images.is_empty() {
        return Err(Error::input(format!("{}: has no images", file.display())));
    }
    Ok(images)
}

/// `NAME.bin` or `NAME.txt` of the model: as the file that is given, or binary if a folder has no other, or has both files so.
fn file(path: &Path, name: &str) -> PathBuf {
    if !path.is_dir() {
        return path.with_file_name(name).with_extension(path.extension().unwrap_or_default());
    }
    let has = |name: &str| path.join(name).exists();
    let is_binary = has("cameras.bin") && has("images.bin") || !has("cameras.txt") && !has("images.txt");
    path.join(name).with_extension(if is_binary { "bin" } else { "txt" })
}

type Parsed<T> = std::result::Result<Vec<T>, String>;

fn load<T>(
    path: &Path,
    loading: &Loading,
    lines: fn(&str) -> Parsed<T>,
    records: fn(&mut Bytes) -> Parsed<T>,
) -> Result<Vec<T>> {
    let unreadable =
        |e: std::io::Error| Error::unreadable(path, format_args!("{e}; a COLMAP model has cameras and images"));
    let parsed = if path.extension().is_some_and(|e| e == "bin") {
        records(&mut Bytes(BufReader::new(loading.open(path).map_err(unreadable)?)))
    } else {
        lines(&loading.read_to_string(path).map_err(unreadable)?)
    };
    parsed.map_err(|why| Error::input(format!("{}: {why}", path.display())))
}

/// The numbered lines that are no comments.
fn lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let text = text.trim_start_matches('\u{feff}');
    text.lines().enumerate().map(|(n, line)| (n + 1, line.trim())).filter(|(_, line)| !line.starts_with('#'))
}

/// The next word of line `n` as a number.
fn number<'a, T: std::str::FromStr>(
    words: &mut impl Iterator<Item = &'a str>,
    n: usize,
    what: &str,
) -> std::result::Result<T, String> {
    let word = words.next().ok_or_else(|| format!("line {n}: {what} is missing"))?;
    word.parse().map_err(|_| format!("line {n}: {what}: {word:?} is not a number in range"))
}

fn camera_lines(text: &str) -> Parsed<Camera> {
    let camera = |(n, line): (usize, &str)| {
        let mut words = line.split_ascii_whitespace();
        let id = number(&mut words, n, "the camera's id")?;
        let model = words.next().ok_or_else(|| format!("line {n}: the model is missing"))?.to_string();
        let size = [number(&mut words, n, "the width")?, number(&mut words, n, "the height")?];
        let mut parameters = Vec::new();
        while words.clone().next().is_some() {
            parameters.push(number(&mut words, n, "a parameter")?);
        }
        Ok(Camera { id, model, size, parameters })
    };
    lines(text).filter(|(_, line)| !line.is_empty()).map(camera).collect()
}

/// Each image has two lines; the second, with its points, may be empty.
fn image_lines(text: &str) -> Parsed<Image> {
    let mut all = Vec::new();
    let mut lines = lines(text);
    while let Some((n, line)) = lines.next() {
        if line.is_empty() {
            continue;
        }
        // nine numbers, and what is left of the line
        let mut rest = line;
        let mut words = std::iter::from_fn(|| {
            let (word, after) = rest.split_once(|c: char| c.is_ascii_whitespace()).unwrap_or((rest, ""));
            rest = after.trim_start();
            (!word.is_empty()).then_some(word)
        });
        let _id: u64 = number(&mut words, n, "the image's id")?;
        let mut value = |what: &str| number(&mut words, n, what);
        let [w, x, y, z] = [value("QW")?, value("QX")?, value("QY")?, value("QZ")?];
        let translation = DVec3::new(value("TX")?, value("TY")?, value("TZ")?);
        let camera = number(&mut words, n, "the camera's id")?;
        if rest.is_empty() {
            return Err(format!("line {n}: the name is missing"));
        }
        let name = rest.to_owned();
        all.push(Image { name, camera, rotation: DQuat::from_xyzw(x, y, z, w).normalize(), translation });
        lines.next();
    }
    Ok(all)
}

/// A binary file: little-endian.
struct Bytes(BufReader<File>);

type Read<T> = std::result::Result<T, String>;

fn ended(error: std::io::Error) -> String {
    match error.kind() {
        std::io::ErrorKind::UnexpectedEof => "ends too early".into(),
        _ => error.to_string(),
    }
}

impl Bytes {
    fn array<const N: usize>(&mut self) -> Read<[u8; N]> {
        let mut bytes = [0; N];
        self.0.read_exact(&mut bytes).map_err(ended)?;
        Ok(bytes)
    }

    fn u64(&mut self) -> Read<u64> {
        self.array().map(u64::from_le_bytes)
    }

    fn u32(&mut self) -> Read<u32> {
        self.array().map(u32::from_le_bytes)
    }

    fn f64(&mut self) -> Read<f64> {
        self.array().map(f64::from_le_bytes)
    }

    /// Text up to a byte 0, of at most [`Bytes::NAME`] bytes; `whose` is for the error.
    fn name(&mut self, whose: u32) -> Read<String> {
        let mut bytes = Vec::new();
        self.0.by_ref().take(Bytes::NAME).read_until(0, &mut bytes).map_err(ended)?;
        if bytes.pop() != Some(0) {
            return Err(format!("image {whose}: its name does not end"));
        }
        String::from_utf8(bytes).map_err(|_| format!("image {whose}: its name is not UTF-8; rename it"))
    }

    /// Longest name, with its end.
    const NAME: u64 = 4096;

    fn skip(&mut self, count: u64) -> Read<()> {
        let skipped = std::io::copy(&mut self.0.by_ref().take(count), &mut std::io::sink()).map_err(ended)?;
        if skipped == count { Ok(()) } else { Err("ends too early".into()) }
    }
}

fn camera_records(bytes: &mut Bytes) -> Parsed<Camera> {
    let count = bytes.u64()?;
    let camera = |_| {
        let (id, number) = (bytes.u32()?.into(), bytes.u32()? as i32);
        let size = [bytes.u64()?, bytes.u64()?];
        let (_, model, count) = MODELS
            .into_iter()
            .find(|m| m.0 == number)
            .ok_or_else(|| format!("camera {id}: model number {number} is not known"))?;
        let parameters = (0..count).map(|_| bytes.f64()).collect::<Parsed<f64>>()?;
        Ok(Camera { id, model: model.into(), size, parameters })
    };
    (0..count).map(camera).collect()
}

fn image_records(bytes: &mut Bytes) -> Parsed<Image> {
    /// Bytes of a point: x, y and its number, 8 each.
    const POINT: u64 = 24;
    let count = bytes.u64()?;
    let image = |_| {
        let id = bytes.u32()?;
        let [w, x, y, z] = [bytes.f64()?, bytes.f64()?, bytes.f64()?, bytes.f64()?];
        let translation = DVec3::new(bytes.f64()?, bytes.f64()?, bytes.f64()?);
        let camera = bytes.u32()?.into();
        let name = bytes.name(id)?;
        let points = bytes.u64()?;
        bytes.skip(points.saturating_mul(POINT))?;
        Ok(Image { name, camera, rotation: DQuat::from_xyzw(x, y, z, w).normalize(), translation })
    };
    (0..count).map(image).collect()
}

fn calibration(camera: &Camera) -> std::result::Result<Calibration, String> {
    let Camera { id, model: name, size, parameters: p } = camera;
    let known =
        MODELS.iter().find(|m| m.1 == name).ok_or_else(|| format!("camera {id}: model {name:?} is not known"))?;
    if p.len() != known.2 {
        return Err(format!("camera {id}: {} parameters; {name} has {}", p.len(), known.2));
    }
    let is_simple = name.starts_with("SIMPLE_") || name.starts_with("RADIAL");
    let (focal, centre, k) = match name.as_str() {
        // one turn over the width, half a turn over the height
        "EQUIRECTANGULAR" => {
            let pixels = DVec2::new(p[0], p[1]);
            (pixels / DVec2::new(std::f64::consts::TAU, std::f64::consts::PI), 0.5 * pixels, &p[2..])
        }
        _ if is_simple => (DVec2::splat(p[0]), DVec2::new(p[1], p[2]), &p[3..]),
        _ => (DVec2::new(p[0], p[1]), DVec2::new(p[2], p[3]), &p[4..]),
    };
    let model = match name.as_str() {
        "SIMPLE_PINHOLE" | "PINHOLE" => Model::brown(&[]),
        "SIMPLE_RADIAL" | "RADIAL" | "OPENCV" | "FULL_OPENCV" => Model::brown(k),
        "SIMPLE_FISHEYE" | "FISHEYE" | "SIMPLE_RADIAL_FISHEYE" | "RADIAL_FISHEYE" | "OPENCV_FISHEYE" => {
            Model::fisheye(k)
        }
        "FOV" => Model::field_of_view(k[0]),
        "SIMPLE_DIVISION" | "DIVISION" => Model::plain(Projection::Division { k: k[0] }),
        "EUCM" => Model::plain(Projection::EnhancedUnified { alpha: k[0], beta: k[1] }),
        "EQUIRECTANGULAR" => Model::plain(Projection::Equirectangular),
        "THIN_PRISM_FISHEYE" => {
            let distortion = Coefficients {
                tangential: [k[2], k[3]],
                prism: [DVec2::new(k[6], k[7]), DVec2::ZERO],
                ..Coefficients::radial(&[k[0], k[1], k[4], k[5]])
            };
            Model { projection: Projection::Equidistant, distortions: vec![distortion] }
        }
        "RAD_TAN_THIN_PRISM_FISHEYE" => {
            let distortions = Coefficients::radial_then_thin_prism(&k[..6], [k[6], k[7]], [k[8], k[9], k[10], k[11]]);
            Model { projection: Projection::Equidistant, distortions }
        }
        _ => return Err(format!("camera {id}: model {name} is not known")),
    };
    let intrinsics = intrinsics(*size, focal, centre - 0.5).map_err(|why| format!("camera {id}: {why}"))?;
    Ok(Calibration::new(intrinsics, model))
}

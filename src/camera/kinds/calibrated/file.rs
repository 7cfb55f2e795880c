//! Calibration files: the table of formats, how each is recognized, and the cameras and images of a file.

mod alicevision;
mod basalt;
mod camodocal;
mod colmap;
mod document;
mod gyroflow;
mod kalibr;
mod kitti;
mod metashape;
mod ncore;
mod ocam;
pub mod opencv;
mod opensfm;
mod orb_slam;
mod refused;
mod rig;
mod ros_ini;
mod svo;
mod transforms;
mod woodscape;
mod xml;

use crate::camera::calibration::{Intrinsics, Model};
use crate::input::{Error, Loading, Result};
pub use colmap::{has_images, poses};
use document::Document;
use glam::{DMat2, DMat3, DQuat, DVec2, DVec3};
use std::path::Path;

/// A camera of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct Calibration {
    pub intrinsics: Intrinsics,
    pub model: Model,
    /// Pose of the image that the scene names.
    pub placed: Option<Placed>,
    /// An assumption that the file leaves open, or a part of the file that the rays do not follow.
    pub note: Option<String>,
}

impl Calibration {
    fn new(intrinsics: Intrinsics, model: Model) -> Calibration {
        Calibration { intrinsics, model, placed: None, note: None }
    }
}

/// Pose of an image.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placed {
    /// Position in the world.
    pub eye: DVec3,
    /// Rotation from the camera's frame (x right, y down, z forward) to the world's.
    pub rotation: DQuat,
}

impl Placed {
    /// Inverts a pose from the world to the camera; `None` if it is not finite.
    fn of_inverse(rotation: DQuat, translation: DVec3) -> Option<Placed> {
        let rotation = rotation.inverse();
        let eye = -(rotation * translation);
        (eye.is_finite() && rotation.is_finite()).then_some(Placed { eye, rotation })
    }

    /// Converts the rows of a matrix from the camera's frame to the world's.
    fn of_rows(rows: &[[f64; 4]; 3]) -> std::result::Result<Placed, String> {
        let column = |k: usize| DVec3::new(rows[0][k], rows[1][k], rows[2][k]);
        let axes = DMat3::from_cols(column(0), column(1), column(2));
        crate::camera::pose::check_axes(axes)?;
        let eye = column(3);
        if !eye.is_finite() {
            return Err("the position is not finite".into());
        }
        Ok(Placed { eye, rotation: DQuat::from_mat3(&axes).normalize() })
    }
}

/// All cameras and images of a file.
#[derive(Debug, Default)]
pub struct Contents {
    /// Each camera with its number for `index`, or with the reason why it cannot be used.
    pub cameras: Vec<(u64, std::result::Result<Calibration, String>)>,
    pub images: Vec<Image>,
}

/// An image of a file, taken by one of its cameras.
#[derive(Debug)]
pub struct Image {
    pub name: String,
    /// Number of the camera that took it.
    pub camera: u64,
    /// Pose, or the reason why there is none.
    pub placed: std::result::Result<Placed, String>,
}

impl Contents {
    fn of_one(camera: std::result::Result<Calibration, String>) -> std::result::Result<Contents, String> {
        Ok(Contents { cameras: vec![(0, Ok(camera?))], images: Vec::new() })
    }

    fn of_cameras(cameras: Vec<(u64, std::result::Result<Calibration, String>)>) -> Contents {
        Contents { cameras, images: Vec::new() }
    }

    fn choose(self, which: Which) -> std::result::Result<Calibration, String> {
        let Which::Image(name) = which else {
            let or_image = self.images.first().filter(|_| matches!(which, Which::Only));
            let or_image = or_image.map_or(String::new(), |image| format!(", or an image: image = {:?}", image.name));
            let is_one = self.cameras.len() < 2;
            return which.of(self.cameras).map_err(|why| if is_one { why } else { why + &or_image })?;
        };
        if self.images.is_empty() {
            return Err("has no images with poses; give index, or leave both out".into());
        }
        let Some(image) = self.images.iter().find(|image| image.name == name) else {
            let names: Vec<_> = self.images.iter().take(NAMED).map(|image| format!("{:?}", image.name)).collect();
            return Err(format!("has no image {name:?}; its images are {}", few(&names.join(", "))));
        };
        let placed = Some(image.placed.clone().map_err(|why| format!("image {name:?}: {why}"))?);
        Ok(Calibration { placed, ..Which::Index(image.camera).of(self.cameras)?? })
    }
}

/// Most names in a message, which is then cut where it is still long.
const NAMED: usize = 4;

/// Choice of a camera in a file.
#[derive(Debug, Clone, Copy)]
pub enum Which<'a> {
    /// The file's only camera.
    Only,
    /// The camera with this number: COLMAP's id, N of camN, or the place in the file's list of cameras, from 0.
    Index(u64),
    /// The camera of an image, by name.
    Image(&'a str),
}

impl Which<'_> {
    /// Takes the only item, or the item with this number.
    fn of<T>(self, mut all: Vec<(u64, T)>) -> std::result::Result<T, String> {
        let listed = || all.iter().map(|(n, _)| n.to_string()).collect::<Vec<_>>().join(", ");
        let at = match self {
            Which::Only if all.len() == 1 => Some(0),
            Which::Only if all.is_empty() => return Err("has no camera that can be used".into()),
            Which::Only => return Err(format!("has cameras {}; choose one: index = {}", few(&listed()), all[0].0)),
            Which::Index(index) => all.iter().position(|(n, _)| *n == index),
            Which::Image(_) => return Err("has no images with poses; give index".into()),
        };
        match at {
            Some(at) => Ok(all.swap_remove(at).1),
            None => Err(format!("has no camera of this index; it has {}", few(&listed()))),
        }
    }
}

/// Cuts a long list for a message.
fn few(listed: &str) -> String {
    match listed.char_indices().nth(80) {
        Some((end, _)) => format!("{}...", &listed[..end]),
        None => listed.into(),
    }
}

type Read = fn(&Document) -> std::result::Result<Contents, String>;

/// A format of calibration files.
struct Format {
    /// Name of the program or data set that writes it, for messages and `anamorph info`.
    name: &'static str,
    recognizes: fn(&Document) -> bool,
    read: Read,
}

/// Formats that are recognized by a file's text, tried in this order. COLMAP's files are recognized by their names.
const FORMATS: &[Format] = &[
    Format { name: "NVIDIA DRIVE", recognizes: rig::is_rig, read: rig::contents },
    Format { name: "ncore", recognizes: ncore::is_file, read: ncore::contents },
    Format { name: "Kalibr", recognizes: kalibr::is_chain, read: kalibr::chain },
    Format { name: "EuRoC sensor.yaml", recognizes: kalibr::is_sensor, read: kalibr::sensor },
    Format { name: "transforms.json", recognizes: transforms::is_file, read: transforms::contents },
    Format { name: "camodocal", recognizes: camodocal::is_file, read: camodocal::contents },
    Format { name: "Basalt", recognizes: basalt::is_file, read: basalt::contents },
    Format { name: "ORB-SLAM or stella_vslam", recognizes: orb_slam::is_file, read: orb_slam::contents },
    Format { name: "SVO or vikit", recognizes: svo::is_file, read: svo::contents },
    Format { name: "gyroflow", recognizes: gyroflow::is_file, read: gyroflow::contents },
    Format { name: "WoodScape", recognizes: woodscape::is_file, read: woodscape::contents },
    Format { name: "OCamCalib", recognizes: ocam::is_file, read: ocam::contents },
    Format { name: "OpenSfM or ODM", recognizes: opensfm::is_file, read: opensfm::contents },
    Format { name: "AliceVision", recognizes: alicevision::is_file, read: alicevision::contents },
    Format { name: "Metashape", recognizes: metashape::is_file, read: metashape::contents },
    Format { name: "KITTI", recognizes: kitti::is_file, read: kitti::contents },
    Format { name: "ROS .ini", recognizes: ros_ini::is_file, read: ros_ini::contents },
    Format { name: "OpenCV or ROS", recognizes: opencv::is_file, read: opencv::contents },
];

fn recognized(document: &Document) -> Option<&'static Format> {
    FORMATS.iter().find(|format| (format.recognizes)(document))
}

/// Parses a file's text: its format, cameras and images.
fn parse(text: &str) -> std::result::Result<(&'static str, Contents), String> {
    let document = Document::parse(text).map_err(|why| format!("not a calibration: {why}"))?;
    match recognized(&document) {
        Some(format) => Ok((format.name, (format.read)(&document)?)),
        None => Err(refused::why(&document).unwrap_or_else(|| {
            let names: Vec<&str> = FORMATS.iter().map(|format| format.name).collect();
            let why = match &document {
                Document::Text(_, Some(why)) => format!(" (as YAML: {why})"),
                _ => String::new(),
            };
            format!("not a calibration of a format that is read: COLMAP, {}{why}", names.join(", "))
        })),
    }
}

/// Reads a camera from a file of any format of [`FORMATS`], or from a folder that COLMAP wrote (or its file of cameras).
///
/// # Errors
/// [`Error::Input`], [`Error::Missing`] or [`Error::Read`] naming the file: it cannot be read, is of no such format, or lacks that camera.
pub fn read(path: &Path, which: Which, loading: &Loading) -> Result<Calibration> {
    if colmap::is_model(path) {
        return colmap::read(path, which, loading);
    }
    load(path, loading)?.1.choose(which).map_err(|why| Error::input(format!("{}: {why}", path.display())))
}

/// Loads a file: its format, cameras and images.
///
/// # Errors
/// The errors of [`read`].
pub fn load(path: &Path, loading: &Loading) -> Result<(&'static str, Contents)> {
    if colmap::is_model(path) {
        return Ok(("COLMAP", colmap::contents(path, loading)?));
    }
    let text = loading.read_to_string(path).map_err(|e| match e.kind() {
        std::io::ErrorKind::InvalidData => Error::Read(format!(
            "{}: cannot be read: it is no text; calibrations are text, or COLMAP's folder",
            path.display()
        )),
        _ => Error::unreadable(path, format_args!("{e}; check the path")),
    })?;
    parse(&text).map_err(|why| Error::input(format!("{}: {why}", path.display())))
}

/// Tells whether the text is a calibration of a format in [`FORMATS`].
#[cfg(feature = "cli")]
pub fn is_calibration(text: &str) -> bool {
    Document::parse(text).is_ok_and(|document| recognized(&document).is_some())
}

/// The names of the images of a folder that COLMAP wrote, or of a file with poses, in order.
///
/// # Errors
/// [`Error::Input`], [`Error::Missing`] or [`Error::Read`] naming the file of images: it cannot be read, or has none.
pub fn images(model: &Path, loading: &Loading) -> Result<Vec<String>> {
    if has_images(model) || colmap::is_model(model) {
        return colmap::images(model, loading);
    }
    let images = load(model, loading)?.1.images;
    if images.is_empty() {
        return Err(Error::input(format!("{}: has no images with poses", model.display())));
    }
    Ok(images.into_iter().map(|image| image.name).collect())
}

/// The poses of the images in a file's text, in its order; `None` for formats without images.
pub fn poses_of_text(text: &str) -> Option<std::result::Result<Vec<Placed>, String>> {
    let images = parse(text).ok()?.1.images;
    let placed = |image: Image| image.placed.map_err(|why| format!("image {:?}: {why}", image.name));
    (!images.is_empty()).then(|| images.into_iter().map(placed).collect())
}

/// The intrinsics of a camera without skew, its principal point in OpenCV's pixels; checked.
fn intrinsics(size: [u64; 2], focal: DVec2, centre: DVec2) -> std::result::Result<Intrinsics, String> {
    crate::image::size::check_size(size[0], size[1]).map_err(|e| e.to_string())?;
    if !(focal.min_element() > 0.0 && (focal.x * focal.y).is_finite() && centre.is_finite()) {
        return Err(format!(
            "focal lengths {}, {} and principal point {}, {}: the lengths must be over 0, and all numbers finite",
            focal.x, focal.y, centre.x, centre.y
        ));
    }
    // checked above to be far under 2^32
    let size = (size[0] as u32, size[1] as u32);
    Ok(Intrinsics { size, scale: DMat2::from_diagonal(focal), centre })
}

//! Calibration files of OpenCV and ROS: `FileStorage` as YAML, XML or JSON, in the spellings of its versions; ROS's `camera_info` as YAML,
//! which has the same keys, and as the text of a message. The first pixel has its centre at (0, 0).

use super::document::{Document, Result, Tree, whole};
use super::{Calibration, Contents, xml};
use crate::camera::calibration::{Coefficients, Intrinsics, Model, Projection};
use crate::input::{Error, Loading};
use glam::DVec2;
use std::path::Path;

/// A file's camera.
#[derive(Debug, Clone, PartialEq)]
pub struct OpenCvFile {
    pub intrinsics: Intrinsics,
    /// As in the file: `k1, k2, p1, p2, ...`, or the fisheye's four.
    coefficients: Vec<f64>,
    /// Mirror parameter of `cv::omnidir`.
    xi: Option<f64>,
    /// The file's model: whether it is the fisheye, and the line that says so.
    fisheye: Option<(bool, String)>,
    /// Part of the file that rays do not follow.
    note: Option<String>,
}

impl OpenCvFile {
    /// With the model that is named (whether it is the fisheye), or else the file's, or else Brown's.
    pub fn calibration(self, named: Option<bool>) -> Result<Calibration> {
        if let Some(xi) = self.xi {
            return self.omnidir(xi, named);
        }
        let notes: Vec<String> =
            self.model_note().filter(|_| named.is_none()).into_iter().chain(self.note.clone()).collect();
        let is_fisheye = named.or(self.fisheye.map(|f| f.0)).unwrap_or(false);
        let mut k = &self.coefficients[..];
        // drivers pad the fisheye's four coefficients with zeros
        while is_fisheye && k.len() > 4 && k.last() == Some(&0.0) {
            k = &k[..k.len() - 1];
        }
        let refuse = |known: &str| Err(format!("{} distortion coefficients; {known}", k.len()));
        let model = match (is_fisheye, k.len()) {
            (true, 4) => Model::fisheye(k),
            (true, _) => return refuse("the fisheye model has 4"),
            (false, 0 | 4 | 5 | 8 | 12 | 14) => Model::brown(k),
            (false, _) => return refuse("the Brown model has 0, 4, 5, 8, 12 or 14"),
        };
        let note = (!notes.is_empty()).then(|| notes.join("; "));
        Ok(Calibration { note, ..Calibration::new(self.intrinsics, model) })
    }

    /// Mei's model with k1, k2, p1, p2 and a skew.
    fn omnidir(self, xi: f64, named: Option<bool>) -> Result<Calibration> {
        match (named, self.coefficients.len()) {
            (Some(_), _) => Err("the file has xi, so it is of cv::omnidir; use kind = \"calibrated\"".into()),
            (None, 4) => {
                let distortions = vec![Coefficients::of_opencv(&self.coefficients)];
                let model = Model { projection: Projection::Unified { xi }, distortions };
                Ok(Calibration { note: self.note, ..Calibration::new(self.intrinsics, model) })
            }
            (None, count) => Err(format!("{count} distortion coefficients; cv::omnidir has 4")),
        }
    }

    /// What the file does not say: which model its four coefficients belong to.
    fn model_note(&self) -> Option<String> {
        let is_open = self.fisheye.is_none() && self.coefficients.len() == 4;
        let told = "the file names no model: its 4 coefficients are taken as k1, k2, p1, p2 of brown; for cv::fisheye use kind = \"opencv\" with model = \"fisheye\"";
        is_open.then(|| told.into())
    }

    /// The line of the file that names another model than `fisheye` says.
    pub fn contradicts(&self, fisheye: bool) -> Option<&str> {
        self.fisheye.as_ref().filter(|(said, _)| *said != fisheye).map(|(_, line)| line.as_str())
    }
}

/// Reads the image's size, the camera matrix and the distortion coefficients, and the model if the file names it (`distortion_model`,
/// `fisheye_model`).
///
/// # Errors
/// [`Error::Input`] naming the file: it cannot be read, is not such a file, or its matrices have another form.
pub fn read(path: &Path, loading: &Loading) -> crate::input::Result<OpenCvFile> {
    let refuse = |why: String| Error::input(format!("{}: {why}", path.display()));
    let text =
        loading.read_to_string(path).map_err(|e| Error::unreadable(path, format_args!("{e}; check the path")))?;
    let document = Document::parse(&text).map_err(|why| refuse(format!("{NOT}: {why}")))?;
    match super::recognized(&document) {
        Some(other) if !is_file(&document) => {
            Err(refuse(format!("a calibration of {}, which kind = \"calibrated\" reads", other.name)))
        }
        _ => file(&document).map_err(refuse),
    }
}

const NOT: &str = "not a calibration as OpenCV writes it";

/// Spellings of the keys, without case and underscores: OpenCV 2 to 5, its Kinect samples, ROS's files and messages.
const MATRIX: [&str; 2] = ["cameramatrix", "k"];
const COEFFICIENTS: [&str; 4] = ["distortioncoefficients", "distcoeffs", "dist", "d"];
const WIDTH: [&str; 2] = ["imagewidth", "width"];
const HEIGHT: [&str; 2] = ["imageheight", "height"];
const SIZE: [&str; 2] = ["imgsize", "imagesize"];

/// A value by one of the spellings, and its key as the file spells it.
fn find<'a>(root: &'a Tree, spellings: &[&str]) -> Option<(&'a str, &'a Tree)> {
    let plain = |key: &str| key.to_ascii_lowercase().replace('_', "");
    root.entries().find(|(key, value)| spellings.contains(&plain(key).as_str()) && **value != Tree::Null)
}

pub fn is_file(document: &Document) -> bool {
    let has_keys = |tree: &Tree| find(tree, &MATRIX).is_some() || find(tree, &["imagewidth"]).is_some();
    document.root("opencv_storage").is_some() || has_keys(document.tree())
}

pub fn contents(document: &Document) -> Result<Contents> {
    Contents::of_one(file(document)?.calibration(None))
}

fn file(document: &Document) -> Result<OpenCvFile> {
    let as_written = |why: String| format!("{NOT}: {why}");
    match document {
        Document::Tree(tree) => of_tree(tree),
        Document::Xml(xml) => {
            let root = xml.root_element();
            if !root.has_tag_name("opencv_storage") {
                let name = root.tag_name().name();
                return Err(as_written(format!("its root element is <{name}>, not <opencv_storage>")));
            }
            of_tree(&xml::tree(root).map_err(as_written)?)
        }
        Document::Text(_, why) => {
            Err(as_written(why.clone().unwrap_or_else(|| "it is no YAML, XML or JSON with keys".into())))
        }
    }
}

fn of_tree(root: &Tree) -> Result<OpenCvFile> {
    let as_written = |why: String| format!("{NOT}: {why}");
    let need = |spellings: &[&str], name: &str| find(root, spellings).ok_or(as_written(format!("{name} is missing")));
    if let Some(file) = root.get("cam0_calib").and_then(Tree::text) {
        return Err(format!(
            "a configuration of VINS-Fusion, not a lens; use the file {file:?} that its cam0_calib names"
        ));
    }
    let (name, matrix) = need(&MATRIX, "camera_matrix")?;
    let (rows, cols, data) = numbers(matrix, 3).map_err(|why| as_written(format!("{name}: {why}")))?;
    let [fx, skew, cx, zero, fy, cy, zero_x, zero_y, one] = data[..] else {
        return Err(format!("{name}: {} numbers in {rows} x {cols}; it must be 3 x 3", data.len()));
    };
    let xi = root.get("xi").map(|xi| {
        let numbers = xi.numbers().or_else(|| Some(vec![xi.number()?]));
        numbers.filter(|n| n.len() == 1).map_or(Err(as_written("xi must be a finite number".into())), |n| Ok(n[0]))
    });
    let xi = xi.transpose()?;
    let is_skewed = skew != 0.0 && xi.is_none();
    if (rows, cols) != (3, 3) || [zero, zero_x, zero_y] != [0.0; 3] || one != 1.0 || is_skewed {
        return Err(format!("{name}: must be [fx, 0, cx; 0, fy, cy; 0, 0, 1]"));
    }
    let size = size(root).map_err(as_written)?;
    let mut intrinsics =
        super::intrinsics(size, DVec2::new(fx, fy), DVec2::new(cx, cy)).map_err(|why| format!("{name}: {why}"))?;
    intrinsics.scale.y_axis.x = skew;
    let (name, list) = need(&COEFFICIENTS, "distortion_coefficients")?;
    let (rows, cols, data) = numbers(list, 1).map_err(|why| as_written(format!("{name}: {why}")))?;
    if rows.checked_mul(cols) != Some(data.len()) {
        return Err(format!("{name}: {} numbers in {rows} x {cols}", data.len()));
    }
    let fisheye = said_model(root, &data)?;
    Ok(OpenCvFile { intrinsics, coefficients: data, xi, fisheye, note: cropped(root) })
}

/// The rows, columns and numbers of a matrix; a list alone has `rows`.
fn numbers(matrix: &Tree, rows: usize) -> Result<(usize, usize, Vec<f64>)> {
    let field = |key: &str| matrix.get(key).ok_or(format!("missing field `{key}`"));
    let data = if matrix.is_table() { field("data")? } else { matrix };
    let numbers = match data {
        // XML has none as an empty text
        Tree::Text(text) => {
            let number = |word: &str| word.parse().map_err(|_| format!("<data>: {word:?} is not a number in range"));
            Some(text.split_ascii_whitespace().map(number).collect::<Result<_>>()?)
        }
        _ => data.numbers(),
    };
    let numbers: Vec<f64> =
        numbers.filter(|n| n.iter().all(|x| x.is_finite())).ok_or("must be a list of finite numbers")?;
    if !matrix.is_table() {
        return Ok((rows, numbers.len() / rows, numbers));
    }
    let count = |key: &str| match field(key)?.number() {
        Some(n) if n >= 0.0 && n.fract() == 0.0 => Ok(n as usize),
        _ => Err(format!("{key} must be a whole number")),
    };
    Ok((count("rows")?, count("cols")?, numbers))
}

fn size(root: &Tree) -> Result<[u64; 2]> {
    if let Some((name, size)) = find(root, &SIZE) {
        let size = size.numbers().and_then(|n| <[f64; 2]>::try_from(n).ok());
        return size.map_or(Err(format!("{name} must be the width and the height")), whole);
    }
    let side = |spellings: &[&str], name: &str| {
        let (name, value) = find(root, spellings)
            .ok_or(format!("{name} is missing; add image_width and image_height, px, to the file"))?;
        value.number().ok_or(format!("{name} must be a finite number"))
    };
    whole([side(&WIDTH, "image_width")?, side(&HEIGHT, "image_height")?])
}

/// What ROS says of a part of the sensor, which `camera_matrix` is not of.
fn cropped(root: &Tree) -> Option<String> {
    let number = |tree: &Tree, key: &str| tree.get(key).and_then(Tree::number).unwrap_or(0.0);
    let is_binned = number(root, "binning_x") > 1.0 || number(root, "binning_y") > 1.0;
    let roi = root.get("roi");
    let is_cut =
        roi.is_some_and(|roi| ["x_offset", "y_offset", "width", "height"].iter().any(|k| number(roi, k) > 0.0));
    (is_binned || is_cut)
        .then(|| "binning and roi of the file are not applied: the rays are those of the whole image".into())
}

/// The model that the file names: whether it is the fisheye, and the line that says so. Simulators leave the name empty.
fn said_model(root: &Tree, coefficients: &[f64]) -> Result<Option<(bool, String)>> {
    let said = |fisheye: bool, name: &str| Some((fisheye, format!("distortion_model: {name}")));
    let is_none = coefficients.iter().all(|k| *k == 0.0);
    let named = match root.get("distortion_model").map(|name| name.text().unwrap_or("?")) {
        None | Some("") => None,
        Some(name @ ("none" | "None")) if is_none => said(false, name),
        Some(name @ ("plumb_bob" | "rational_polynomial" | "radtan")) => said(false, name),
        Some(name @ ("equidistant" | "fisheye" | "kannala_brandt" | "kannala_brandt4")) => said(true, name),
        Some(name) => {
            return Err(format!(
                "distortion_model: {name:?} is not known; use plumb_bob or rational_polynomial (Brown), equidistant or fisheye (fisheye), or none without coefficients"
            ));
        }
    };
    let flag = root.get("fisheye_model").and_then(Tree::number);
    let flagged = flag.map(|flag| (flag != 0.0, format!("fisheye_model: {flag}")));
    match (named, flagged) {
        (Some(a), Some(b)) if a.0 != b.0 => Err(format!("{} and {} contradict each other; correct one", a.1, b.1)),
        (named, flagged) => Ok(named.or(flagged)),
    }
}

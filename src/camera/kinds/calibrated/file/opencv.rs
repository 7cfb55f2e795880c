//! Calibration files: OpenCV's `FileStorage` as YAML, XML or JSON, and ROS's `camera_info`, which has the same keys.

use super::{Calibration, xml};
use crate::camera::calibration::{Intrinsics, Model};
use crate::input::{Error, Loading, Result};
use glam::DVec2;
use serde::Deserialize;
use std::path::Path;

/// A file's camera.
#[derive(Debug, Clone, PartialEq)]
pub struct OpenCvFile {
    pub intrinsics: Intrinsics,
    /// As in the file: `k1, k2, p1, p2, ...`, or the fisheye's four.
    coefficients: Vec<f64>,
    /// The file's model: whether it is the fisheye, and the line that says so.
    fisheye: Option<(bool, String)>,
}

impl OpenCvFile {
    /// With the model that is named (whether it is the fisheye), or else the file's, or else Brown's.
    pub fn calibration(self, named: Option<bool>) -> std::result::Result<Calibration, String> {
        let note = self.model_note().filter(|_| named.is_none());
        let k = &self.coefficients;
        let refuse = |known: &str| Err(format!("{} distortion coefficients; {known}", k.len()));
        let model = match (named.or(self.fisheye.map(|f| f.0)).unwrap_or(false), k.len()) {
            (true, 4) => Model::fisheye(k),
            (true, _) => return refuse("the fisheye model has 4"),
            (false, 0 | 4 | 5 | 8 | 12 | 14) => Model::brown(k),
            (false, _) => return refuse("the Brown model has 0, 4, 5, 8, 12 or 14"),
        };
        Ok(Calibration { intrinsics: self.intrinsics, model, placed: None, note })
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

/// The keys that are read; a calibration holds many more.
#[derive(Deserialize, PartialEq)]
pub(super) struct Keys {
    pub image_width: u64,
    pub image_height: u64,
    pub camera_matrix: Matrix,
    pub distortion_coefficients: Matrix,
    /// ROS's name for the model.
    pub distortion_model: Option<String>,
    /// 1 or 0, as OpenCV's calibration program writes it.
    pub fisheye_model: Option<i64>,
}

/// An `!!opencv-matrix`, row by row.
#[derive(Deserialize, PartialEq)]
pub(super) struct Matrix {
    pub rows: usize,
    pub cols: usize,
    pub data: Vec<f64>,
}

/// Reads `image_width`, `image_height`, `camera_matrix` and `distortion_coefficients`, and the model if the file names it
/// (`distortion_model`, `fisheye_model`).
///
/// # Errors
/// [`Error::Input`] naming the file: it cannot be read, is not such a file, or its matrices have another form.
pub fn read(path: &Path, loading: &Loading) -> Result<OpenCvFile> {
    let refuse = |why: String| Error::input(format!("{}: {why}", path.display()));
    let text =
        loading.read_to_string(path).map_err(|e| Error::unreadable(path, format_args!("{e}; check the path")))?;
    parse(&text).map_err(refuse)
}

/// Most lists and tables in brackets. A calibration has some tens; the YAML parser's time grows with the square of nested ones.
const BRACKETS_MAX: usize = 10_000;

pub(super) fn check_brackets(text: &str) -> std::result::Result<(), String> {
    let count = text.bytes().filter(|b| matches!(b, b'[' | b'{')).count();
    if count <= BRACKETS_MAX {
        return Ok(());
    }
    Err(format!(
        "has {count} lists and tables in brackets, over the limit of {BRACKETS_MAX}; remove all but the camera's keys"
    ))
}

pub(super) fn parse(text: &str) -> std::result::Result<OpenCvFile, String> {
    check_brackets(text)?;
    let keys = keys(text).map_err(|e| format!("not a calibration as OpenCV writes it: {}", e.replace('\n', " ")))?;
    let fisheye = said_model(&keys)?;
    let Matrix { rows, cols, data } = keys.camera_matrix;
    let [fx, skew, cx, zero, fy, cy, zero_x, zero_y, one] = data[..] else {
        return Err(format!("camera_matrix: {} numbers in {rows} x {cols}; it must be 3 x 3", data.len()));
    };
    if (rows, cols) != (3, 3) || [skew, zero, zero_x, zero_y] != [0.0; 4] || one != 1.0 {
        return Err("camera_matrix: must be [fx, 0, cx; 0, fy, cy; 0, 0, 1]".into());
    }
    let (focal, centre) = (DVec2::new(fx, fy), DVec2::new(cx, cy));
    let intrinsics = super::intrinsics([keys.image_width, keys.image_height], focal, centre)
        .map_err(|why| format!("camera_matrix: {why}"))?;
    let Matrix { rows, cols, data } = keys.distortion_coefficients;
    if rows.checked_mul(cols) != Some(data.len()) || data.iter().any(|k| !k.is_finite()) {
        let count = data.len();
        return Err(format!("distortion_coefficients: {count} numbers in {rows} x {cols}; each must be finite"));
    }
    Ok(OpenCvFile { intrinsics, coefficients: data, fisheye })
}

/// The keys of a file in any of the three formats, distinguished by its first character.
fn keys(text: &str) -> std::result::Result<Keys, String> {
    let text = text.trim_start_matches('\u{feff}').trim_start();
    if text.starts_with('<') {
        return xml::keys(text);
    }
    if text.starts_with('{') {
        return serde_json::from_str(text).map_err(|e| e.to_string());
    }
    // OpenCV's first line is no directive of YAML; a comment keeps the numbers of the lines
    serde_norway::from_str(&text.replacen("%YAML:1.0", "# YAML 1.0", 1)).map_err(|e| e.to_string())
}

/// The model that the file names: whether it is the fisheye, and the line that says so.
fn said_model(keys: &Keys) -> std::result::Result<Option<(bool, String)>, String> {
    let named = match keys.distortion_model.as_deref() {
        None => None,
        Some(name @ ("plumb_bob" | "rational_polynomial")) => Some((false, format!("distortion_model: {name}"))),
        Some(name @ ("equidistant" | "fisheye")) => Some((true, format!("distortion_model: {name}"))),
        Some(name) => {
            return Err(format!(
                "distortion_model: {name:?} is not known; use plumb_bob or rational_polynomial (Brown), or equidistant or fisheye (fisheye)"
            ));
        }
    };
    let flagged = keys.fisheye_model.map(|flag| (flag != 0, format!("fisheye_model: {flag}")));
    match (named, flagged) {
        (Some(a), Some(b)) if a.0 != b.0 => Err(format!("{} and {} contradict each other; correct one", a.1, b.1)),
        (named, flagged) => Ok(named.or(flagged)),
    }
}

//! OCamCalib's `calib_results.txt` (Scaramuzza): the height over the sensor as a polynomial of the radius in pixels. The first pixel has its
//! centre at (0, 0); the file counts rows before columns.

use super::document::{Document, Result, whole};
use super::{Calibration, Contents, intrinsics};
use crate::camera::calibration::{Intrinsics, Model, Projection};
use glam::{DMat2, DVec2};

pub fn is_file(document: &Document) -> bool {
    document.text().is_some_and(|text| text.starts_with('#') && text.contains("polynomial coefficients for the DIRECT"))
}

pub fn contents(document: &Document) -> Result<Contents> {
    Contents::of_one(of_lines(document.text().unwrap_or_default()))
}

/// Five lines of numbers: both polynomials with their lengths in front, the centre, the affine part, the size.
fn of_lines(text: &str) -> Result<Calibration> {
    let lines = text.lines().enumerate().map(|(n, line)| (n + 1, line.trim()));
    let numbers = |(n, line): (usize, &str)| {
        let read = |word: &str| word.parse().map_err(|_| format!("line {n}: {word:?} is not a number"));
        line.split_ascii_whitespace().map(read).collect::<Result<Vec<f64>>>()
    };
    let all: Vec<_> =
        lines.filter(|(_, l)| !l.is_empty() && !l.starts_with('#')).map(numbers).collect::<Result<_>>()?;
    let [direct, _inverse, centre, affine, size, ..] = &all[..] else {
        return Err(format!("{} lines of numbers; a calib_results.txt of OCamCalib has 5", all.len()));
    };
    let (Some((count, heights)), [row, column], [c, d, e], [height, width]) =
        (direct.split_first(), &centre[..], &affine[..], &size[..])
    else {
        return Err("its lines of numbers are not a polynomial, the inverse one, row and column of the centre, c d e, and height and width".into());
    };
    if *count != heights.len() as f64 {
        return Err(format!("the direct polynomial has {} coefficients, not {count}", heights.len()));
    }
    // (row, column) - centre = [c d; e 1] (down, right)
    let scale = DMat2::from_cols(DVec2::new(1.0, *d), DVec2::new(*e, *c));
    camera(whole([*width, *height])?, scale, DVec2::new(*column, *row), heights)
}

/// Most coefficients of a polynomial; OCamCalib's has 5.
const COEFFICIENTS: usize = 16;

/// A camera whose plane is the sensor, px; `polynomial` is minus the height.
pub fn camera(size: [u64; 2], scale: DMat2, centre: DVec2, polynomial: &[f64]) -> Result<Calibration> {
    if polynomial.len() > COEFFICIENTS {
        return Err(format!(
            "the polynomial has {} coefficients; at most {COEFFICIENTS} are possible",
            polynomial.len()
        ));
    }
    let determinant = scale.determinant();
    if determinant.is_nan() || determinant <= 0.0 {
        return Err(format!("affine part: c - d e = {determinant}; it must be over 0"));
    }
    let c = polynomial.iter().map(|a| -a).collect();
    let intrinsics = Intrinsics { scale, ..intrinsics(size, DVec2::ONE, centre)? };
    Ok(Calibration::new(intrinsics, Model::plain(Projection::HeightOfRadius { c })))
}

//! The `.ini` files of ROS's older camera drivers. The first pixel has its centre at (0, 0).

use super::document::{Document, Result, whole};
use super::{Calibration, Contents, intrinsics};
use crate::camera::calibration::Model;
use glam::DVec2;

fn lines<'a>(document: &Document<'a>) -> impl Iterator<Item = &'a str> {
    let lines = document.text().into_iter().flat_map(str::lines).map(str::trim);
    lines.filter(|line| !line.is_empty() && !line.starts_with('#'))
}

pub fn is_file(document: &Document) -> bool {
    lines(document).next() == Some("[image]")
}

/// The numbers of the lines below a heading.
fn below(document: &Document, heading: &str, count: usize) -> Result<Vec<f64>> {
    let mut lines = lines(document).skip_while(|line| *line != heading);
    lines.next().ok_or(format!("{heading} is missing"))?;
    let words: Vec<&str> = lines.flat_map(str::split_ascii_whitespace).take(count).collect();
    let number = |word: &str| word.parse().ok().filter(|x: &f64| x.is_finite());
    let numbers = words.into_iter().map_while(number).collect::<Vec<f64>>();
    if numbers.len() < count && heading != "distortion" {
        return Err(format!("{heading}: {} numbers; it has {count}", numbers.len()));
    }
    Ok(numbers)
}

pub fn contents(document: &Document) -> Result<Contents> {
    Contents::of_one(camera(document))
}

fn camera(document: &Document) -> Result<Calibration> {
    let side = |heading: &str| Ok::<_, String>(below(document, heading, 1)?[0]);
    let size = whole([side("width")?, side("height")?])?;
    let matrix = below(document, "camera matrix", 9)?;
    // up to the next heading
    let k = below(document, "distortion", 14)?;
    if !matches!(k.len(), 4 | 5 | 8 | 12 | 14) {
        return Err(format!("distortion: {} numbers; the Brown model has 4, 5, 8, 12 or 14", k.len()));
    }
    let intrinsics = intrinsics(size, DVec2::new(matrix[0], matrix[4]), DVec2::new(matrix[2], matrix[5]))?;
    Ok(Calibration::new(intrinsics, Model::brown(&k)))
}

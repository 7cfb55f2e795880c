//! A summary of a compiled camera, as text and for EXR headers.

use crate::arrays::MapEach;
use crate::camera::glc::{Class, classify};
use crate::camera::{Bundle, Camera, Rays};
use glam::DVec3;
use serde::{Serialize, Serializer};
use serde_json::Value;
use std::fmt;

/// Summary of a compiled camera.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Description {
    pub kind: &'static str,
    pub width: u32,
    pub height: u32,
    /// Infinities are "inf" and "-inf" in JSON.
    #[serde(serialize_with = "serialize_range")]
    pub t_range: [f64; 2],
    /// In all layers; 0 if each pixel has its own ray or curve.
    pub pieces: usize,
    /// One, or those of a chain, first to last.
    pub layers: Vec<Layer>,
    /// It moves while an image is taken.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub moves: bool,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub notes: Vec<String>,
}

/// Summary of the rays of a layer.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Layer {
    /// 0 if each pixel has its own ray or curve.
    pub pieces: usize,
    /// The degree of curved rays.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub degree: Option<usize>,
    /// The classes of the pieces' general linear cameras, the most frequent first.
    pub classes: Vec<ClassCount>,
    /// The rays, if the whole image is one piece.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bundle: Option<BundleRecord>,
}

/// Number of pieces of one class.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ClassCount {
    pub class: &'static str,
    pub pieces: usize,
    /// Ray parameters of the slits if the image is one piece.
    pub slits: Vec<f64>,
}

/// `P = p[0] + x p[1] + y p[2]`, `D` alike, x and y in pixels from the middle of the image.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BundleRecord {
    pub p: [[f64; 3]; 3],
    pub d: [[f64; 3]; 3],
}

/// Perspective pieces, whose weights vary, are not affine in the image, so no GLCs.
const WEIGHTED: &str = "weighted (its corners' w differ)";

impl Description {
    pub fn of(camera: &Camera) -> Description {
        Description {
            kind: camera.kind,
            width: camera.width,
            height: camera.height,
            t_range: camera.t_range,
            pieces: camera.piece_count(),
            layers: camera.layers.iter().map(Layer::of).collect(),
            moves: camera.moving.is_some(),
            notes: camera.notes.iter().chain(&camera.unfulfilled).cloned().collect(),
        }
    }
}

impl Layer {
    fn of(rays: &Rays) -> Layer {
        let none = Layer { pieces: 0, degree: None, classes: Vec::new(), bundle: None };
        match rays {
            Rays::Pieces(pieces) => {
                let whole = pieces.pieces.first().filter(|piece| piece.corners_px.is_none());
                let rows = |v: &[DVec3; 3]| v.map_each(|v| v.to_array());
                Layer {
                    pieces: pieces.pieces.len(),
                    classes: count_classes(pieces.pieces.iter().map(|piece| &piece.bundle)),
                    bundle: whole.map(|w| BundleRecord { p: rows(&w.bundle.p), d: rows(&w.bundle.d) }),
                    ..none
                }
            }
            Rays::Field(_) => none,
            Rays::Curves(_) => Layer { pieces: rays.piece_count(), degree: Some(rays.degree()), ..none },
        }
    }
}

fn count_classes<'a>(bundles: impl Iterator<Item = &'a Bundle>) -> Vec<ClassCount> {
    let mut classes: Vec<ClassCount> = Vec::new();
    for bundle in bundles {
        let (class, slits) = piece_class(bundle);
        match classes.iter_mut().find(|c| c.class == class) {
            Some(count) => {
                count.pieces += 1;
                count.slits.clear();
            }
            None => classes.push(ClassCount { class, pieces: 1, slits }),
        }
    }
    // stable: equal counts stay in the order of the pieces
    classes.sort_by_key(|c| std::cmp::Reverse(c.pieces));
    classes
}

/// The class of a piece and its slits. Moving all near or all far points alike changes neither, so the derivatives over
/// the image stand for the corners.
pub fn piece_class(bundle: &Bundle) -> (&'static str, Vec<f64>) {
    if bundle.h[1] != 0.0 || bundle.h[2] != 0.0 {
        return (WEIGHTED, Vec::new());
    }
    let Bundle { p, d, .. } = bundle;
    let (class, slits) = classify(&[DVec3::ZERO, p[1], p[2]], &[DVec3::ZERO, p[1] + d[1], p[2] + d[2]]);
    (class.name(), slits.into_iter().map(shortened).collect())
}

/// Significant digits of a slit's t: classes are distinguished to 11 digits.
fn shortened(t: f64) -> f64 {
    // a number as printed parses; a root of -0 is 0
    format!("{t:.10e}").parse().unwrap_or(t) + 0.0
}

fn serialize_range<S: Serializer>(range: &[f64; 2], serializer: S) -> Result<S::Ok, S::Error> {
    let end = |t: f64| if t.is_finite() { Value::from(t) } else { Value::from(t.to_string()) };
    range.map_each(end).serialize(serializer)
}

impl fmt::Display for Description {
    /// Lines of text, each a word and its value; those of a chain's layers follow the layer's number.
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        writeln!(f, "kind     {}", self.kind)?;
        writeln!(f, "image    {} x {}", self.width, self.height)?;
        if let [layer] = self.layers.as_slice() {
            write!(f, "{layer}")?;
        } else {
            writeln!(f, "layers   {}, of {} pieces in all", self.layers.len(), self.pieces)?;
            for (k, layer) in self.layers.iter().enumerate() {
                write!(f, "layer    {k}\n{layer}")?;
            }
        }
        writeln!(f, "t_range  [{}, {}]", self.t_range[0], self.t_range[1])?;
        if self.moves {
            writeln!(f, "moves    while the image is taken: each pixel has the ray of its own time")?;
        }
        self.notes.iter().try_for_each(|note| writeln!(f, "note     {note}"))
    }
}

impl fmt::Display for Layer {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match (self.pieces, self.degree) {
            (0, None) => writeln!(f, "pieces   none: a ray of its own for each pixel")?,
            (0, Some(m)) => writeln!(f, "pieces   none: a curve of degree {m} for each pixel")?,
            (n, None) => writeln!(f, "pieces   {n}")?,
            (n, Some(m)) => writeln!(f, "pieces   {n}, of curves of degree {m}")?,
        }
        for count in &self.classes {
            let slits: Vec<String> = count.slits.iter().map(f64::to_string).collect();
            let slits = match slits.len() {
                0 => String::new(),
                1 if count.class == Class::Pinhole.name() => format!(", rays meet at t = {}", slits[0]),
                1 => format!(", slit at t = {}", slits[0]),
                _ => format!(", slits at t = {}", slits.join(" and ")),
            };
            let pieces = if self.pieces == 1 { String::new() } else { format!("{} of ", count.pieces) };
            writeln!(f, "class    {pieces}{}{slits}", count.class)?;
        }
        Ok(())
    }
}

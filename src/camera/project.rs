//! Projection of 3-D points: all image places whose rays or curves pass through a point.
//!
//! Beams, boxes around origins and directions, bound the rays of each part of the image, and a [`tree`] of them finds the
//! parts that may see a point. The GPU may traverse that tree instead (`sift`); its results are computed again here, so
//! the images are the same.
//!
//! * [`pieces`]: in a piece the rays through a point are the roots of a cubic in t ([`columns`]); all are found.
//! * [`field`], [`curved`]: formulas and tables have no such equation. The image is searched in cells of a quarter
//!   pixel that bounds of their rays cannot rule out, and Newton's method ([`newton`]) finds the exact place from each.
//!   Two images closer together than such a cell may be found as one. The bounds of a formula are sampled (with a margin
//!   of as much again as it is seen to bulge between samples): where it jumps or ends inside a pixel, slivers that no
//!   sample is in are lost. A table is searched between its pixel centres, where it is bilinear. Near eyes and slits so
//!   much of the image may see the point that the search is given up ([`Images::incomplete`]).

pub mod beam;
mod columns;
pub mod curved;
mod field;
mod newton;
mod pieces;
mod samples;
pub mod tree;

use super::{Camera, Rays};
use crate::parallel;
use glam::{DVec2, DVec3};
use serde::Serialize;
use tree::{Tree, WHOLE};

/// One image of a point.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Image {
    /// Pixels right of the image's left side.
    pub x: f64,
    /// Pixels below its top.
    pub y: f64,
    /// x / width.
    pub a: f64,
    /// y / height.
    pub b: f64,
    /// Ray parameter; in a chain the layer's index plus the t in it.
    pub t: f64,
    /// The layer of a chain, from 0.
    pub layer: usize,
    /// Numbered through all layers; 0 in a ray field.
    pub piece: u32,
}

/// Why a point has more images than can be listed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Degenerate {
    /// The point is on a slit: a curve of the image shows it.
    Slit,
    /// The point is an eye: an area of the image shows it.
    Eye,
}

impl Degenerate {
    /// `slit` or `eye`.
    pub fn name(self) -> &'static str {
        match self {
            Degenerate::Slit => "slit",
            Degenerate::Eye => "eye",
        }
    }
}

/// How close a ray of a field must pass to a point to be one through it, relative to the distances of both from the world's origin.
pub const SEARCH_ROUNDING: f64 = field::NOTHING;

/// All images of a point.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Images {
    /// The isolated images, sorted by layer, piece and t.
    pub images: Vec<Image>,
    /// Set if there are also curves or areas of images.
    pub degenerate: Option<Degenerate>,
    /// The search was given up and there may be more images: too many rays pass close to the point, or they jump too often.
    /// Left out of JSON where it is false.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub incomplete: bool,
}

/// A camera indexed for projecting points.
pub struct Projector<'a> {
    camera: &'a Camera,
    layers: Vec<Layer<'a>>,
}

enum Layer<'a> {
    Pieces(pieces::Search<'a>),
    Field(field::Search<'a>),
    Curves(curved::Search<'a>),
}

/// An image in one layer: place (px), t of the layer, and the layer's own piece.
#[derive(Debug, Clone, Copy)]
struct Found {
    place: DVec2,
    t: f64,
    piece: u32,
}

/// The images of a point in one layer.
#[derive(Debug, Default)]
struct Shown {
    found: Vec<Found>,
    degenerate: Option<Degenerate>,
    /// Work: boxes tested, plus [`NEWTON_WORK`] for each Newton search.
    work: u32,
}

/// Most work for one point in one layer: a few seconds.
const WORK: u32 = 1 << 18;

/// Cost of a Newton search relative to a box test.
const NEWTON_WORK: u32 = 4;

impl Shown {
    /// Adds work; false if the limit is exceeded.
    fn may_spend(&mut self, work: u32) -> bool {
        self.work = self.work.saturating_add(work);
        self.work <= WORK
    }
}

/// Images of one layer closer than this, in px and in t relative to its size, are one. Newton's method stops far
/// closer.
const ONE_PLACE_PX: f64 = 1e-6;
const ONE_T: f64 = 1e-6;

/// How far a place may lie beyond a border, px, and a t beyond its range, relative: both come from some 100 roundings
/// of numbers up to 2^16 (px) and 1 (t), and pieces that share a border must not both refuse it.
const BORDER_PX: f64 = 1e-9;
const T_TOLERANCE: f64 = 1e-12;

impl<'a> Projector<'a> {
    /// Bounds of the camera's rays are taken here, once for all points.
    pub fn new(camera: &'a Camera) -> Projector<'a> {
        let layer = |rays: &'a Rays| match rays {
            Rays::Pieces(p) => Layer::Pieces(pieces::Search::new(p, camera)),
            Rays::Field(f) => Layer::Field(field::Search::new(f, camera.t_range)),
            Rays::Curves(c) => Layer::Curves(curved::Search::new(c)),
        };
        Projector { camera, layers: camera.layers.iter().map(layer).collect() }
    }

    /// All images of each point, world units; none of one that is not finite.
    pub fn project_all(camera: &Camera, points: &[DVec3]) -> Vec<Images> {
        // bounds are not taken in vain
        if let [Rays::Field(field)] = camera.layers.as_slice() {
            let search = field::Search::of_closed_form(field, camera.t_range);
            let projector = Projector { camera, layers: Vec::new() };
            let images = |point: &DVec3| {
                let mut all = Images::default();
                if point.is_finite() {
                    projector.add(0, search.closed_form(*point)?, &mut all);
                }
                Some(all)
            };
            if let Ok(all) = parallel::try_map(points, |point| images(point).ok_or(())) {
                return all;
            }
        }
        let projector = Projector::new(camera);
        parallel::map(points, |point| projector.project(*point))
    }

    /// Whose points are projected.
    pub fn camera(&self) -> &'a Camera {
        self.camera
    }

    /// The beams of each layer's rays.
    pub fn trees(&self) -> impl Iterator<Item = &Tree> {
        self.layers.iter().map(|layer| match layer {
            Layer::Pieces(s) => &s.tree,
            Layer::Field(s) => &s.tree,
            Layer::Curves(s) => &s.tree,
        })
    }

    /// All images of `point`, world units; none of a point that is not finite.
    pub fn project(&self, point: DVec3) -> Images {
        self.project_below(point, |_| WHOLE)
    }

    /// As [`Projector::project`], where `from` names nodes of each layer's tree, ascending, at or below which all leaves
    /// are that may see the point.
    pub fn project_below<'n>(&self, point: DVec3, from: impl Fn(usize) -> &'n [u32]) -> Images {
        let mut all = Images::default();
        if !point.is_finite() {
            return all;
        }
        for (layer, search) in self.layers.iter().enumerate() {
            let shown = match search {
                Layer::Pieces(s) => s.images(point, from(layer)),
                Layer::Field(s) => s.images(point, from(layer)),
                Layer::Curves(s) => s.images(point, from(layer)),
            };
            self.add(layer, shown, &mut all);
        }
        all
    }

    /// Adds what a layer shows.
    fn add(&self, layer: usize, shown: Shown, all: &mut Images) {
        all.degenerate = all.degenerate.max(shown.degenerate);
        all.incomplete |= shown.work > WORK;
        let mut found = merged(self.camera.t_range, shown.found);
        found.sort_by(|a, b| a.piece.cmp(&b.piece).then(a.t.total_cmp(&b.t)));
        let images: Vec<Image> = found.iter().map(|f| self.image(layer, f)).collect();
        // at a shared face the lower layer has the point
        let fresh = |image: &Image| !all.images.iter().any(|lower| is_handed_over(lower, image));
        let fresh: Vec<Image> = images.into_iter().filter(fresh).collect();
        all.images.extend(fresh);
    }

    fn image(&self, layer: usize, found: &Found) -> Image {
        let (x, y) = (found.place.x, found.place.y);
        Image {
            x,
            y,
            a: x / f64::from(self.camera.width),
            b: y / f64::from(self.camera.height),
            t: layer as f64 + found.t,
            layer,
            piece: self.camera.first_piece(layer) + found.piece,
        }
    }
}

/// Both are the point where one layer's ray ends and the next one's starts.
fn is_handed_over(lower: &Image, upper: &Image) -> bool {
    let near = DVec2::new(lower.x - upper.x, lower.y - upper.y).length() <= ONE_PLACE_PX;
    near && lower.layer + 1 == upper.layer && (lower.t - upper.t).abs() <= ONE_T
}

/// Those within the range of t, brought into it, each once: of several at one place the lowest piece's.
fn merged([t0, t1]: [f64; 2], mut found: Vec<Found>) -> Vec<Found> {
    found.sort_by_key(|f| f.piece);
    let mut kept: Vec<Found> = Vec::with_capacity(found.len());
    for f in found {
        let tolerance = T_TOLERANCE * f.t.abs().max(1.0);
        let one =
            |k: &Found| (k.place - f.place).length() <= ONE_PLACE_PX && (k.t - f.t).abs() <= ONE_T * f.t.abs().max(1.0);
        if t0 - tolerance <= f.t && f.t <= t1 + tolerance && !kept.iter().any(one) {
            kept.push(Found { t: f.t.clamp(t0, t1), ..f });
        }
    }
    kept
}

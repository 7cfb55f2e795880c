//! Cameras: what a scene file asks for, compiled to rays and curves.
//!
//! A camera's image consists of pieces, each an affine homogeneous [`Bundle`] of rays ([`pieces`]), or it is a field with one
//! ray ([`field`]) or one Bezier curve ([`curve`]) per pixel. A chain stacks several of these as layers: its rays continue
//! from one layer to the next. All other modules use these representations only.
//!
//! [`kinds`] lists the kinds of cameras in scene files; each is a [`recipe::Recipe`] that builds such layers.

/// Pixels per side of a tile of the image.
pub const TILE: u32 = 8;

mod boxes;
pub mod bundle;
pub mod calibration;
pub mod chain;
pub mod change;
pub mod composition;
pub mod curve;
pub mod describe;
pub mod exposure;
pub mod field;
pub mod glc;
pub mod graph;
pub mod kinds;
pub mod lens;
pub mod mesh;
pub mod moving;
pub mod notes;
pub mod optics;
pub mod perturb;
pub mod pieces;
pub mod pose;
pub mod project;
pub mod projector;
pub mod ray_order;
pub mod recipe;
pub mod region;
pub mod spec;
mod stack;
pub mod stacked;
pub mod tessellate;
pub(crate) mod values;
pub mod view;
#[cfg(any(feature = "cli", feature = "view"))]
pub mod volume;

use crate::camera::composition::Composition;
use crate::camera::exposure::Sample;
use crate::camera::optics::Optics;
use crate::camera::spec::CameraSpec;
use crate::geometry::mesh::Mesh;
use crate::image::frame::{Channel, NO_ID};
use crate::image::size::check_size;
use crate::input::{Error, Loading, Result};
pub use bundle::{Bundle, Ray};
pub use curve::{Curve, CurveMap, Curves};
pub use field::{Field, RayMap};
use glam::{DVec2, DVec3};
use moving::Moving;
use notes::Notes;
#[cfg(any(feature = "cli", feature = "view"))]
pub use pieces::Piece;
pub use pieces::Pieces;
use recipe::{Built, SceneUse, Setting, Surroundings};
use std::cell::Cell;
use std::sync::Arc;

/// The rays of a layer.
#[derive(Debug, Clone)]
pub enum Rays {
    Pieces(Pieces),
    Field(Field),
    Curves(Curves),
}

impl Rays {
    /// Number of pieces; 0 if each pixel has its own ray or curve.
    pub fn piece_count(&self) -> usize {
        match self {
            Rays::Pieces(p) => p.pieces.len(),
            Rays::Field(_) => 0,
            Rays::Curves(c) => c.map.piece_count(),
        }
    }

    /// Degree of the curves; 1 of rays.
    pub fn degree(&self) -> usize {
        match self {
            Rays::Curves(curves) => curves.map.degree(),
            _ => 1,
        }
    }

    /// The straight ray at an image place, px.
    pub fn ray_at(&self, place_px: DVec2) -> Option<Ray> {
        match self {
            Rays::Pieces(pieces) => Some(pieces.bundle_at_place(pieces.owner_at(place_px)?, place_px).ray(0.0, 0.0)),
            Rays::Field(field) => field.ray_at(place_px),
            Rays::Curves(_) => None,
        }
    }
}

/// A camera compiled for an image of `width x height` pixels.
#[derive(Debug, Clone)]
pub struct Camera {
    pub kind: &'static str,
    pub width: u32,
    pub height: u32,
    /// Closed range of t for hits, in every layer.
    pub t_range: [f64; 2],
    /// One layer, or those of a chain, first to last, each with t in [0, 1]. A pixel's hit in the lowest layer wins.
    pub layers: Vec<Rays>,
    /// The mirror or lens in view; the camera then has one layer of straight rays.
    pub optics: Option<Arc<Optics>>,
    /// Notes for the user: what was left out or approximated.
    pub notes: Notes,
    /// Requests that cannot be fulfilled in this scene, for the user.
    pub unfulfilled: Vec<String>,
    /// How much of the scene its rays depend on.
    pub scene_use: SceneUse,
    /// Which sample of each pixel its rays are; `None`: the pixel's own ray.
    pub sample: Option<Sample>,
    /// For each pixel the one that it is of the image, row by row, if they are in another order.
    pub pixel_order: Option<Arc<[u32]>>,
    /// Where it is at several times, if it moves while an image is taken.
    pub moving: Option<Arc<Moving>>,
    /// The cameras of a composite. If it [is layered](Composition::is_layered), `layers` are the rays of its master, or of the camera that
    /// regions alone would show.
    pub composition: Option<Arc<Composition>>,
}

/// Clones the camera.
impl From<&Camera> for Arc<Camera> {
    fn from(camera: &Camera) -> Arc<Camera> {
        Arc::new(camera.clone())
    }
}

/// A pixel is safe if its answer is constant within this distance of its centre, px (`docs/reference/definitions.md`, Safe).
pub const SAFE_RADIUS_PX: f64 = 1.0 / 16.0;

/// Most layers of a chain: a visibility key has 4 bits for them.
pub const LAYERS_MAX: usize = 16;

impl Camera {
    /// Compiles `spec` for an image of `size` and no scene; see [`Camera::in_scene`].
    pub fn new(spec: &CameraSpec, size: Option<(u32, u32)>) -> Result<Camera> {
        Camera::in_scene(spec, size, &Mesh::default(), &Loading::default())
    }

    /// Compiles `spec` for an image of `size` in a scene, which matters for cameras that depend on it, such as `track`. A ray map has its
    /// own size; `size` must be equal or `None`.
    pub fn in_scene<'a>(
        spec: &CameraSpec,
        size: Option<(u32, u32)>,
        seen: impl Into<Surroundings<'a>>,
        loading: &'a Loading,
    ) -> Result<Camera> {
        Camera::in_setting(spec, &Setting::new(size, seen, spec.t_range, loading))
    }

    /// Compiles a camera that may be part of another, and records in `setting` how much of the scene it depends on.
    pub(crate) fn in_setting(spec: &CameraSpec, setting: &Setting) -> Result<Camera> {
        if let Some((width, height)) = setting.size {
            check_size(width.into(), height.into())?;
        }
        let own = Cell::default();
        let built = Camera::build(spec, &setting.noting(spec.t_range, &own));
        setting.note_use(own.get());
        built.map(|camera| Camera { scene_use: own.get(), ..camera })
    }

    fn build(spec: &CameraSpec, setting: &Setting) -> Result<Camera> {
        let built = spec.kind.recipe.build(setting)?;
        let n = built.layers.len();
        if n == 0 || n > LAYERS_MAX {
            return Err(Error::input(format!("camera: {n} layers; a chain has 1 to {LAYERS_MAX}")));
        }
        built.layers.iter().try_for_each(check_reach)?;
        Ok(Camera::of_built(spec.kind.name, spec.t_range, built))
    }

    /// A camera of one layer.
    pub fn of(kind: &'static str, size: (u32, u32), t_range: [f64; 2], rays: Rays) -> Camera {
        Camera::of_built(kind, t_range, Built::new(size, rays))
    }

    /// A camera of these rays; `t_range` is that of the scene file.
    fn of_built(kind: &'static str, t_range: [f64; 2], built: Built) -> Camera {
        Camera {
            kind,
            width: built.size.0,
            height: built.size.1,
            t_range: built.t_range.unwrap_or(t_range),
            layers: built.layers,
            optics: built.optics,
            notes: built.notes,
            unfulfilled: built.unfulfilled,
            scene_use: SceneUse::Nothing,
            sample: None,
            pixel_order: None,
            moving: None,
            composition: built.composition,
        }
    }

    /// The same camera for one of the samples of each pixel, `(dx, dy)` pixels from the pixel's centre.
    ///
    /// # Errors
    /// [`Error::Input`] if the camera moves and no pixel has a ray at the time of its sample.
    pub fn of_sample(&self, (dx, dy): (f64, f64), sample: Sample) -> Result<Camera> {
        let sampled = match &self.moving {
            Some(moving) => moving.camera(Some(sample))?,
            None => Camera { sample: Some(sample), ..self.clone() },
        };
        Ok(sampled.with_sample_offset(dx, dy))
    }

    /// The same camera with every pixel's sample moved by `(dx, dy)` pixels from the pixel centre.
    pub fn with_sample_offset(&self, dx: f64, dy: f64) -> Camera {
        let moved = |rays: &Rays| match rays {
            Rays::Pieces(p) => Rays::Pieces(p.with_sample(0.5 + dx, 0.5 + dy)),
            Rays::Field(f) => Rays::Field(f.with_sample_offset(dx, dy)),
            Rays::Curves(c) => Rays::Curves(c.with_sample_offset(dx, dy)),
        };
        let composition = self.composition.as_ref().map(|c| Arc::new(c.with_sample_offset((dx, dy), self.sample)));
        Camera { layers: self.layers.iter().map(moved).collect(), composition, ..self.clone() }
    }

    /// Number of pieces in all layers, plus those of its optics (facets or smooth parts); 0 for a ray field.
    pub fn piece_count(&self) -> usize {
        self.first_piece(self.layers.len()) as usize + self.optics.as_ref().map_or(0, |o| o.piece_count())
    }

    /// Number of the first piece of a layer: those of the lower layers come before it.
    pub fn first_piece(&self, layer: usize) -> u32 {
        self.layers[..layer].iter().map(|rays| rays.piece_count() as u32).sum()
    }

    /// The composition, if frames are composed of those of several cameras.
    pub fn layered(&self) -> Option<&Composition> {
        self.composition.as_deref().filter(|composition| composition.is_layered())
    }

    /// The value of `piece.id` at a pixel of the image whose ray has this piece: of a composite, the number of the camera.
    pub fn piece_number(&self, piece: u32, (i, j): (u32, u32)) -> u32 {
        let Some(composition) = self.composition.as_ref().filter(|_| piece != NO_ID) else { return piece };
        composition.first(i, j).map_or(piece, |k| k as u32)
    }

    /// The channels of [`Channel::ALL`] that images of this camera can have.
    pub fn channels(&self) -> Vec<Channel> {
        Channel::ALL.into_iter().filter(|c| *c != Channel::MirrorId || self.optics.is_some()).collect()
    }

    /// Whether some layer has curved rays.
    pub fn is_curved(&self) -> bool {
        self.layers.iter().any(|l| matches!(l, Rays::Curves(_)))
    }

    /// Its rays are curved, or run through several layers.
    pub fn is_curved_or_layered(&self) -> bool {
        self.is_curved() || self.layers.len() > 1
    }

    /// The piece of a layer that owns pixel `(i, j)`, numbered through all layers, and its bundle centred there; `None`:
    /// no ray, or a curved one.
    pub fn pixel(&self, layer: usize, i: u32, j: u32) -> Option<(u32, Bundle)> {
        let (piece, bundle) = match &self.layers[layer] {
            Rays::Pieces(p) => p.owner(i, j).map(|k| (k, p.bundle_at(k, i, j)))?,
            Rays::Field(f) => f.bundle(i, j).map(|b| (0, b))?,
            Rays::Curves(_) => return None,
        };
        Some((self.first_piece(layer) + piece, bundle))
    }

    /// The ray of pixel `(i, j)` in a layer as a curve over t in [0, 1], and its piece numbered through all layers.
    pub fn curve(&self, layer: usize, i: u32, j: u32) -> Option<(u32, Curve)> {
        match &self.layers[layer] {
            Rays::Curves(c) => c.near(i, j, (0.0, 0.0)).map(|(k, curve)| (self.first_piece(layer) + k, curve)),
            _ => self.pixel(layer, i, j).map(|(k, b)| (k, Curve::of_ray(&b.ray(0.0, 0.0)))),
        }
    }

    /// The bundles of all pieces of a layer of straight rays within [`SAFE_RADIUS_PX`] of the centre of pixel `(i, j)`, the
    /// owner's first; and whether part of that disc lies outside every piece. Empty if the pixel has no ray.
    pub fn near(&self, layer: usize, i: u32, j: u32) -> (Vec<Bundle>, bool) {
        match &self.layers[layer] {
            Rays::Pieces(p) => p.near(i, j, SAFE_RADIUS_PX),
            Rays::Field(f) => (f.quadrants(i, j), f.ends_near(i, j)),
            Rays::Curves(_) => (Vec::new(), true),
        }
    }

    /// The pixel of the image that a pixel is, where they are in another order.
    pub fn image_pixel(&self, (i, j): (u32, u32)) -> (u32, u32) {
        let at = |order: &Arc<[u32]>| order[j as usize * self.width as usize + i as usize];
        self.pixel_order.as_ref().map(at).map_or((i, j), |k| (k % self.width, k / self.width))
    }

    /// A pixel in the middle of the image, or of one of those that are stacked in it.
    pub fn middle(&self) -> (u32, u32) {
        let row = match self.layers.as_slice() {
            [Rays::Pieces(pieces)] => pieces.middle_row(),
            [Rays::Field(field)] => field.middle_row(),
            _ => None,
        };
        (self.width / 2, row.unwrap_or(self.height / 2))
    }

    /// The common origin of all rays; `None` if there are several, or no pixel has a ray.
    pub fn centre(&self) -> Option<DVec3> {
        let each = |k: u32| self.ray(k % self.width, k / self.width).map(|r| r.origin);
        let mut starts = (0..self.width * self.height).filter_map(each);
        let first = starts.next()?;
        // a homogeneous piece moves its one origin by rounding
        let near = CENTRE_ROUNDING * (1.0 + first.abs().max_element());
        starts.all(|p| (p - first).abs().max_element() <= near).then_some(first)
    }

    /// The first segment of pixel `(i, j)`: its ray, or the chord of its curve.
    pub fn ray(&self, i: u32, j: u32) -> Option<Ray> {
        (0..self.layers.len()).find_map(|layer| match &self.layers[layer] {
            Rays::Curves(_) => self.curve(layer, i, j).map(|(_, c)| c.chord()),
            _ => self.pixel(layer, i, j).map(|(_, b)| b.ray(0.0, 0.0)),
        })
    }
}

/// Largest coordinate of a control point, world units; as for scenes. Products of ten coordinates stay in the range of f64.
const REACH_MAX: f64 = 1e30;

/// Pixels per side of [`lattice`].
const PLACES: u32 = 17;

/// Pixels all over an image, corner to corner, row by row.
fn lattice((width, height): (u32, u32)) -> impl Iterator<Item = (u32, u32)> {
    let at = |k: u32, side: u32| (u64::from(k) * u64::from(side - 1) / u64::from(PLACES - 1)) as u32;
    (0..PLACES).flat_map(move |j| (0..PLACES).map(move |i| (at(i, width), at(j, height))))
}

/// Refuses curves that reach too far, tested on a lattice of pixels.
fn check_reach(rays: &Rays) -> Result<()> {
    let Rays::Curves(curves) = rays else { return Ok(()) };
    let found = lattice((curves.width, curves.height)).filter_map(|(i, j)| curves.near(i, j, (0.0, 0.0)));
    let size = |curve: &Curve| curve.points().iter().fold(0f64, |m, p| m.max(p.abs().max_element()));
    let reach = found.fold(0f64, |m, (_, curve)| m.max(size(&curve)));
    if reach <= REACH_MAX {
        return Ok(());
    }
    Err(Error::input(format!(
        "camera: a control point lies {reach:.1e} from the origin, over the limit of {REACH_MAX:.0e}; move it, or scale the scene and its camera"
    )))
}

/// Tolerance for equal origins, relative to their size: sixteen roundings.
const CENTRE_ROUNDING: f64 = 16.0 * f64::EPSILON;

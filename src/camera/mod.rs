//! Cameras: what a scene file asks for, compiled to bundles of rays.
//!
//! A camera is an image cut into pieces, each an affine homogeneous [`Bundle`] of rays ([`pieces`]), or a ray field
//! read pixel by pixel ([`field`]). Everything after this module knows only these two.

pub mod bundle;
pub mod central;
pub mod field;
pub mod glc;
pub mod mesh;
pub mod pieces;

use crate::error::{Error, Result};
use crate::scene::file::{CameraKind, CameraSpec};
pub use bundle::{Bundle, Ray};
pub use field::Field;
pub use pieces::{Piece, Pieces};

/// The rays of a camera.
#[derive(Debug, Clone)]
pub enum Rays {
    Pieces(Pieces),
    Field(Field),
}

/// A camera compiled for an image of `width x height` pixels.
#[derive(Debug, Clone)]
pub struct Camera {
    pub kind: &'static str,
    pub width: u32,
    pub height: u32,
    /// Hits count for t in this closed range.
    pub t_range: [f64; 2],
    pub rays: Rays,
    /// What was left out of a partly degenerate camera, for a person to read.
    pub notes: Vec<String>,
}

/// How far from a pixel's centre an answer must hold for the pixel to be safe (contract, section 5), px.
pub const SAFE_RADIUS_PX: f64 = 1.0 / 16.0;

impl Camera {
    /// Compiles `spec` for an image of `size`; a ray map brings its own size, which `size` may only repeat.
    pub fn new(spec: &CameraSpec, size: Option<(u32, u32)>) -> Result<Camera> {
        if let CameraKind::Raymap { origins, directions } = &spec.kind {
            let field = Field::load(origins, directions)?;
            if size.is_some_and(|s| s != (field.width, field.height)) {
                let (w, h) = (field.width, field.height);
                return Err(Error::input(format!("image: the ray map is {w}x{h}; leave the size out or make it that")));
            }
            let (width, height) = (field.width, field.height);
            let (rays, notes) = (Rays::Field(field), Vec::new());
            return Ok(Camera { kind: "raymap", width, height, t_range: spec.t_range, rays, notes });
        }
        let (width, height) =
            size.ok_or_else(|| Error::input("image: no size; give width and height in [image] or --size"))?;
        let (w, h) = (width, height);
        let mut notes = Vec::new();
        let whole = |bundle| Pieces::whole(bundle, w, h);
        let (kind, pieces) = match &spec.kind {
            CameraKind::Pinhole { eye, target, up, vfov } => {
                ("pinhole", whole(central::pinhole(*eye, *target, *up, *vfov, h)?))
            }
            CameraKind::Orthographic { eye, target, up, height } => {
                ("orthographic", whole(central::orthographic(*eye, *target, *up, *height, h)?))
            }
            CameraKind::Glc { near, far } => ("glc", whole(glc::bundle(near, far, w, h)?)),
            CameraKind::Mesh(mesh) => ("mesh", mesh::compile(mesh, w, h, &mut notes)?),
            CameraKind::Raymap { .. } => unreachable!("handled above"),
        };
        Ok(Camera { kind, width, height, t_range: spec.t_range, rays: Rays::Pieces(pieces), notes })
    }

    /// The same camera with every pixel's sample moved by `(dx, dy)` pixels from the pixel centre.
    pub fn with_sample_offset(&self, dx: f64, dy: f64) -> Camera {
        let mut camera = self.clone();
        camera.rays = match &self.rays {
            Rays::Pieces(p) => Rays::Pieces(p.with_sample(0.5 + dx, 0.5 + dy)),
            Rays::Field(f) => Rays::Field(f.with_sample_offset(dx, dy)),
        };
        camera
    }

    /// How many pieces the image is cut into; 0 for a ray field.
    pub fn piece_count(&self) -> usize {
        match &self.rays {
            Rays::Pieces(p) => p.pieces.len(),
            Rays::Field(_) => 0,
        }
    }

    /// The piece that owns pixel `(i, j)` and its bundle centred there; `None`: no ray.
    pub fn pixel(&self, i: u32, j: u32) -> Option<(u32, Bundle)> {
        match &self.rays {
            Rays::Pieces(p) => p.owner(i, j).map(|k| (k, p.bundle_at(k, i, j))),
            Rays::Field(f) => f.bundle(i, j).map(|b| (0, b)),
        }
    }

    /// The bundles of all pieces that come within [`SAFE_RADIUS_PX`] of the centre of pixel `(i, j)`, the owner's
    /// first; and whether some place that near lies outside every piece. Empty where the pixel has no ray.
    pub fn near(&self, i: u32, j: u32) -> (Vec<Bundle>, bool) {
        match &self.rays {
            Rays::Pieces(p) => p.near(i, j, SAFE_RADIUS_PX),
            Rays::Field(f) => (f.quadrants(i, j), false),
        }
    }

    /// The ray of pixel `(i, j)`.
    pub fn ray(&self, i: u32, j: u32) -> Option<Ray> {
        self.pixel(i, j).map(|(_, b)| b.ray(0.0, 0.0))
    }
}

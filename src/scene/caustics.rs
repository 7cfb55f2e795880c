//! Caustics: light that a mirror or a lens bounces onto receivers.
//!
//! A camera at the light, looking at the optics, renders the photon-location map: one photon for every corner of a grid over
//! the light's image. Three neighbouring photons span a beam of known flux, and on a receiver a caustic triangle, over which
//! the flux is spread evenly. The result is a map of flux on each receiver. Where a camera sees a receiver, the diffuse
//! reflection of that flux is added.
//!
//! [`flux`] and [`beams`] make the triangles of the photons.
//!
//! Hou, Wei, Shum and Guo 2006, section 3.3.

pub mod beams;
pub mod flux;
pub mod receiver_triangles;
pub mod shares;
pub mod spec;

use crate::arrays::MapEach;
use crate::camera::optics::Optics;
use crate::camera::{Camera, Rays};
use crate::geometry::mesh::{Material, Mesh};
use crate::geometry::texture::Texture;
use crate::input::{Error, Loading, Result};
use crate::scene::Scene;
use crate::scene::caustics::spec::CausticsSpec;
use crate::scene::light::{Light, Source};
use glam::{DVec2, DVec3};
use serde::Serialize;
use std::sync::Arc;

/// A light and the receivers of its caustics.
#[derive(Debug, Clone)]
pub struct Caustics {
    /// The camera at the light: a pixel for each corner of the grid of `cells`, and its sample there.
    pub light: Camera,
    pub optics: Arc<Optics>,
    /// Columns and rows of the grid over the light's image.
    pub cells: [u32; 2],
    /// Flux of the light's whole image, linear RGB.
    pub flux: f64,
    pub method: Method,
    pub receivers: Vec<Receiver>,
}

/// How the flux of a caustic triangle is computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// The flux of its beam, spread over its area.
    Flux,
    /// The flux of the light there without the optics, times the ratio of the solid angles of the beam and the
    /// triangle, both seen from the light (Hou et al., section 3.3).
    SolidAngle,
}

/// A parallelogram `origin + s u + t v`, s and t in [0, 1], in a plane of the scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Receiver {
    pub origin: DVec3,
    pub u: DVec3,
    pub v: DVec3,
    /// Texels along u and along v.
    pub texels: [u32; 2],
}

/// Flux on a receiver: linear RGB a texel, row by row along u from the origin.
#[derive(Debug, Clone, PartialEq)]
pub struct Map {
    pub receiver: Receiver,
    pub flux: Vec<[f64; 3]>,
}

/// The maps of all receivers, and the budget of the remaining flux.
#[derive(Debug, Clone, PartialEq)]
pub struct CausticMaps {
    pub maps: Vec<Map>,
    pub budget: FluxBudget,
}

/// Where a light's flux went; the mean of linear RGB.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct FluxBudget {
    pub flux: f64,
    /// On the receivers.
    pub deposited: f64,
    /// Bounced by the optics, and off the receivers.
    pub missed: f64,
    /// Never bounced: direct light, which is not part of caustics.
    pub direct: f64,
    /// Absorbed by the optics.
    pub absorbed: f64,
    /// Caustic triangles on receivers, flat ones among them.
    pub triangles: u64,
    /// Those narrower than [`shares::LINE_WIDTH`]: lines and points.
    pub degenerate: u64,
}

/// A budget, and the wall time from the light's first ray until the maps are complete, ms.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct CausticsReport {
    #[serde(flatten)]
    pub budget: FluxBudget,
    pub ms: f64,
}

impl Caustics {
    /// # Errors
    /// [`Error::Input`] if the light or a receiver makes no sense, or no triangle of the scene is in a receiver's plane.
    pub fn new(spec: &CausticsSpec, mesh: &Mesh, loading: &Loading) -> Result<Caustics> {
        let [columns, rows] = spec.map;
        let camera = Camera::in_scene(&spec.light, Some((columns, rows)), mesh, loading);
        let camera = camera.map_err(|e| e.at("caustics.light"))?;
        let ([Rays::Pieces(pieces)], Some(optics)) = (camera.layers.as_slice(), camera.optics.clone()) else {
            return Err(Error::input("caustics.light: use a reflection or refraction whose eye is a pinhole"));
        };
        // one sample more each way, from the image's left and upper border to its right and lower one
        let corners = crate::camera::Pieces::new(pieces.pieces.clone(), columns + 1, rows + 1);
        let light = Camera { width: columns + 1, height: rows + 1, layers: vec![Rays::Pieces(corners)], ..camera };
        let receivers = spec.receivers.clone();
        receiver_triangles::check(&receivers, mesh)?;
        Ok(Caustics {
            light: light.with_sample_offset(-0.5, -0.5),
            optics,
            cells: spec.map,
            flux: spec.flux,
            method: spec.method,
            receivers,
        })
    }

    /// The light's camera and a scene whose R and G encode the photons: surfaces are white, so G is a photon's remaining share of light
    /// without tints, and R is the same halved at every bounce.
    pub fn counting(&self, scene: &Scene) -> (Scene, Camera) {
        let optics = Optics { tint: COUNTING_TINT, base: [1.0; 3], ..(*self.optics).clone() };
        let camera = Camera { optics: Some(Arc::new(optics)), ..self.light.clone() };
        let mut white = Scene {
            background: [1.0; 3],
            caustics: None,
            sky: None,
            volume: None,
            style: Default::default(),
            ..scene.clone()
        };
        // no light but that from everywhere
        white.lights = vec![Light { source: Source::Distant(DVec3::ZERO), ..Light::distant(DVec3::X) }];
        white.projector_lights = Vec::new();
        white.ambient_occlusion = None;
        let mesh = Arc::make_mut(&mut white.mesh);
        mesh.clear_colors();
        for material in &mut mesh.materials {
            *material = Material {
                diffuse: [1.0 / crate::scene::light::AMBIENT; 3],
                two_sided: material.two_sided,
                // light passes where it is masked, or less than half opaque
                texture: material.texture.as_ref().filter(|t| t.has_alpha_mask()).map(Texture::white),
                blend: material.blend,
                ..Material::default()
            };
        }
        (white, camera)
    }

    /// Texels of the receivers before this one, and of all at the end.
    pub fn first_texels(&self) -> Vec<u32> {
        let end = |end: &mut u32, r: &Receiver| {
            *end += r.texels[0] * r.texels[1];
            Some(*end)
        };
        std::iter::once(0).chain(self.receivers.iter().scan(0, end)).collect()
    }
}

/// R is halved at every bounce.
const COUNTING_TINT: [f32; 3] = [0.5, 1.0, 1.0];

impl Receiver {
    /// World area.
    pub fn area(&self) -> f64 {
        self.u.cross(self.v).length()
    }

    /// World area of a texel.
    pub fn texel_area(&self) -> f64 {
        self.area() / (self.texels[0] as f64 * self.texels[1] as f64)
    }

    fn size(&self) -> DVec2 {
        DVec2::new(self.texels[0] as f64, self.texels[1] as f64)
    }

    /// Texel coordinates of a point of its plane, along u and v from the origin.
    pub fn texels_of(&self, p: DVec3) -> DVec2 {
        let n = self.u.cross(self.v);
        let q = p - self.origin;
        DVec2::new(q.cross(self.v).dot(n), self.u.cross(q).dot(n)) / n.length_squared() * self.size()
    }

    /// World point of texel coordinates.
    pub fn point(&self, place: DVec2) -> DVec3 {
        let st = place / self.size();
        self.origin + st.x * self.u + st.y * self.v
    }
}

impl Map {
    /// Flux per area at texel coordinates, linear RGB: between the middles of texels bilinear, beyond the outermost ones
    /// constant; `None` outside.
    pub fn irradiance(&self, place: DVec2) -> Option<[f64; 3]> {
        let [columns, rows] = self.receiver.texels;
        let size = DVec2::new(columns as f64, rows as f64);
        if !(place.cmpge(DVec2::ZERO).all() && place.cmple(size).all()) {
            return None;
        }
        let p = (place - 0.5).clamp(DVec2::ZERO, size - 1.0);
        let (x, y) = (p.x as u32, p.y as u32);
        let (x1, y1) = ((x + 1).min(columns - 1), (y + 1).min(rows - 1));
        let (s, t) = (p.x.fract(), p.y.fract());
        let at = |x: u32, y: u32, k: usize| self.flux[(y * columns + x) as usize][k];
        let mixed = |k: usize| {
            let above = at(x, y, k) * (1.0 - s) + at(x1, y, k) * s;
            let below = at(x, y1, k) * (1.0 - s) + at(x1, y1, k) * s;
            above * (1.0 - t) + below * t
        };
        Some([0, 1, 2].map_each(|k| mixed(k) / self.receiver.texel_area()))
    }

    /// The sum of all texels.
    pub fn total(&self) -> [f64; 3] {
        [0, 1, 2].map_each(|k| self.flux.iter().map(|f| f[k]).sum())
    }
}

/// The mean of linear RGB.
pub fn mean(rgb: [f64; 3]) -> f64 {
    rgb.iter().sum::<f64>() / 3.0
}

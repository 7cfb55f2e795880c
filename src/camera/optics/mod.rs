//! Optics: surfaces that turn rays, which a camera looks at and through.
//!
//! A ray that first meets the surface goes on from there: reflected, or refracted by Snell's law; up to `depth` times.
//! Everything else of the scene hides, and is seen, as without the surface. The surface is flat facets ([`Facets`]) with
//! a law of how a facet turns rays ([`Law`]), or a smooth one ([`Smooth`]) that is met exactly.
//!
//! Hou, Wei, Shum and Guo 2006, sections 2 and 3; Yu, Yu and McMillan 2009, section 5.2.

pub mod atlas;
pub mod facets;
pub mod fineness;
pub mod meeting;
pub mod quadric;
pub mod resample;
pub mod shape;
pub mod shooting;
pub mod smooth;
pub mod torus;
pub mod turn;
pub mod wave;

use crate::geometry::mesh::Mesh;
pub use facets::{Cameras, Facet, Facets};
use glam::{DVec2, DVec3};
pub use quadric::Quadric;
pub use smooth::Smooth;
use std::f64::consts::PI;
pub use torus::Torus;
pub use wave::Wave;

/// A mirror or a lens in front of a camera.
#[derive(Debug, Clone, PartialEq)]
pub struct Optics {
    pub turn: Turn,
    pub surface: Surface,
    /// How many times a ray may be turned, at least 1. A ray that was turned once sees the scene alone where this is 1;
    /// where it is more, it sees the surface again, and ends on it after the last turn.
    pub depth: u32,
    /// Where a ray is refracted, as much of its light as Fresnel's equations give it is reflected, and both are followed.
    pub fresnel: bool,
    /// Normals are tilted by up to this much, the tangent of the angle.
    pub roughness: f64,
    /// How many rays a pixel's is split into where it is first turned, each with a tilt of its own, for all its turns.
    pub rays: u32,
    /// Turned rays go on from this point of the world, not from where they were turned: what an environment map that was
    /// taken there shows, as finely as one likes (Blinn and Newell 1976). What is near is shown out of place.
    pub environment: Option<DVec3>,
    /// Facets are rendered to an atlas first, and looked up there: one turn, unsplit.
    pub atlas: Option<Atlas>,
    /// What is seen by way of the surface is multiplied by this at every turn, linear RGB.
    pub tint: [f32; 3],
    /// What the surface looks like where rays end on it, linear RGB.
    pub base: [f32; 3],
}

/// What becomes of a ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Turn {
    Reflect,
    /// Snell's law; of a ray that meets the outside the index of refraction outside over that inside is 1 / ior, of one
    /// that meets the inside ior. Total reflection where it leaves no direction.
    Refract {
        ior: f64,
    },
}

#[derive(Debug, Clone, PartialEq)]
pub enum Surface {
    Facets { facets: Facets, law: Law },
    Smooth(Smooth),
}

/// The papers' own way: every facet's camera has a right-angled triangle of one size in a joint picture (Hou et al., section 2;
/// the layout is that of `surround`).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Atlas {
    /// A side of the triangles.
    pub texels: u32,
    /// What the surface is seen from.
    pub eye: DVec3,
}

/// How a facet turns rays.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Law {
    /// The rays from the eye to the facet's corners are turned about the corners' normals; between them the turned rays
    /// are affine: each facet is one GLC (Yu et al., section 5.2). Directions are scaled to one height over the facet's
    /// plane, which is their parametrization plane; where a corner's ray does not leave that plane by more than
    /// [`FLAT_LEAST`] on the side of the others, to unit length instead (Hou et al., equation 1).
    Flat { eye: DVec3 },
    /// Every ray is turned about the corners' normals, interpolated over the facet (Hou et al., section 3.1).
    Normals,
}

/// The parts of a ray's light that are followed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Branch {
    /// Reflected by a mirror; refracted, or totally reflected, by a lens. It says what is seen.
    Main,
    /// Reflected where the rest is refracted.
    Reflected,
}

/// Sine of the angle with the facet's plane at which the corners' rays must leave to be scaled to one height.
pub const FLAT_LEAST: f64 = 1.0 / 64.0;

impl Optics {
    /// Smooth, colourless, black where rays end on it; of unsplit rays that go on from where they are turned.
    pub fn new(turn: Turn, surface: Surface, depth: u32) -> Optics {
        Optics {
            turn,
            surface,
            depth,
            fresnel: false,
            roughness: 0.0,
            rays: 1,
            environment: None,
            atlas: None,
            tint: [1.0; 3],
            base: [0.0; 3],
        }
    }

    /// The facets, where the surface is made of them.
    pub fn facets(&self) -> Option<&Facets> {
        match &self.surface {
            Surface::Facets { facets, .. } => Some(facets),
            Surface::Smooth(_) => None,
        }
    }

    /// Facets, or parts of a smooth surface.
    pub fn surface_count(&self) -> usize {
        self.smooth_count() + self.facets().map_or(0, |f| f.triangles.len())
    }

    /// Vertices of the facets.
    pub fn vertex_count(&self) -> usize {
        self.facets().map_or(0, |f| f.positions.len())
    }

    /// Pieces of the optics: facets of a coarser copy, or the facets or smooth surfaces themselves.
    pub fn camera_count(&self) -> usize {
        self.facets().map_or(self.surface_count(), Facets::camera_count)
    }

    /// Which of them turns the rays that meet a facet or smooth surface.
    pub fn camera_of(&self, surface: u32) -> u32 {
        self.facets().map_or(surface, |f| f.camera_of(surface as usize))
    }

    pub fn smooth_count(&self) -> usize {
        match &self.surface {
            Surface::Facets { .. } => 0,
            Surface::Smooth(smooth) => smooth.count(),
        }
    }

    /// Id of the first facet or part: facets are the last triangles of `mesh`, smooth surfaces come behind all of them.
    pub fn first_id(&self, mesh: &Mesh) -> u32 {
        (mesh.triangles.len() - self.facets().map_or(0, |f| f.triangles.len())) as u32
    }

    /// What a ray is split into wherever it is turned.
    pub fn branches(&self) -> &'static [Branch] {
        if self.fresnel { &[Branch::Main, Branch::Reflected] } else { &[Branch::Main] }
    }

    /// The tilts of the normals, one a ray: in the frame of the tangent plane, evenly over a disc (Vogel's spiral). The first
    /// ray says what is seen.
    pub fn tilts(&self) -> Vec<DVec2> {
        let n = f64::from(self.rays);
        let turn = PI * (3.0 - 5f64.sqrt());
        let tilt = |k: u32| {
            let (s, c) = (f64::from(k) * turn).sin_cos();
            self.roughness * ((f64::from(k) + 0.5) / n).sqrt() * DVec2::new(c, s)
        };
        if self.roughness == 0.0 { vec![DVec2::ZERO] } else { (0..self.rays).map(tilt).collect() }
    }

    /// Rays that were turned may meet the surface again.
    pub fn sees_itself(&self) -> bool {
        self.depth > 1
    }
}

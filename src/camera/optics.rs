//! Optics: a mirror or lens in front of a camera.
//!
//! A ray whose first hit is the surface is reflected there, or refracted by Snell's law, up to `depth` times. The rest of
//! the scene is unaffected. The surface consists of flat facets ([`Facets`]) with
//! a law of reflection ([`Law`]), or a smooth surface ([`Smooth`]) that is intersected exactly.
//!
//! Hou, Wei, Shum and Guo 2006, sections 2 and 3; Yu, Yu and McMillan 2009, section 5.2.

pub mod atlas;
pub mod bounce;
pub mod facet_error;
pub mod facets;
pub mod meeting;
pub mod quadric;
pub mod resample;
pub mod shape;
pub mod shooting;
#[cfg(feature = "simplify")]
mod simplify;
pub mod smooth;
pub mod torus;
pub mod wave;

use crate::geometry::bvh::Aabb;
pub use facets::{Facet, Facets};
use glam::{DVec2, DVec3};
pub use quadric::Quadric;
pub use smooth::Smooth;
use std::f64::consts::PI;
pub use torus::Torus;
pub use wave::Wave;

/// A mirror or a lens in front of a camera.
#[derive(Debug, Clone, PartialEq)]
pub struct Optics {
    pub bounce: Bounce,
    pub surface: Surface,
    /// Most bounces of a ray, at least 1. With 1, a bounced ray does not see the surface again. With more it does, and ends
    /// on it after the last bounce.
    pub depth: u32,
    /// A refracted ray is split: a second ray is reflected with its share of the light by Fresnel's equations.
    pub fresnel: bool,
    /// Tangent of the largest angle by which normals are tilted.
    pub roughness: f64,
    /// Number of rays into which a pixel's ray is split at its first bounce. Each has its own tilt, at all its bounces.
    pub rays: u32,
    /// Bounced rays start at this world point instead of the point of the bounce: an environment map of unlimited resolution
    /// taken there (Blinn and Newell 1976). Near objects appear displaced.
    pub environment: Option<DVec3>,
    /// Facets are rendered to an atlas first and looked up there: one bounce, unsplit rays.
    pub atlas: Option<Atlas>,
    /// Factor of the colour at every bounce, linear RGB.
    pub tint: [f32; 3],
    /// Colour of the surface where rays end on it, linear RGB.
    pub base: [f32; 3],
}

/// How the surface changes a ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Bounce {
    Reflect,
    /// Snell's law. `ior` is the index of refraction inside over that outside. Total reflection where the law has no
    /// solution.
    Refract {
        ior: f64,
    },
}

#[derive(Debug, Clone, PartialEq)]
pub enum Surface {
    Facets { facets: Facets, law: Law },
    Smooth(Smooth),
}

impl Surface {
    /// A box around it.
    pub fn bounds(&self) -> Aabb {
        match self {
            Surface::Facets { facets, .. } => Aabb::around(&facets.positions),
            Surface::Smooth(smooth) => smooth.bounds(),
        }
    }
}

/// Every facet's camera renders a right-angled triangle of one size in a joint image (Hou et al., section 2; laid out as in
/// `surround`).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Atlas {
    /// A short side of the triangles, texels.
    pub texels: u32,
    /// The eye, world units.
    pub eye: DVec3,
}

/// How a facet reflects or refracts rays.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Law {
    /// The rays from the eye to the facet's corners bounce about the corners' normals; between them the bounced rays are
    /// interpolated: each facet is one GLC (Yu et al., section 5.2). Directions are scaled to one height over the facet's
    /// plane. If a corner's ray leaves the plane at a sine below [`FLAT_LEAST`], or on the other side than the others, all
    /// are scaled to unit length instead (Hou et al., equation 1).
    Flat { eye: DVec3 },
    /// Every ray bounces about the corners' normals, interpolated over the facet (Hou et al., section 3.1).
    Normals,
}

/// The parts of a ray's light that are followed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Branch {
    /// Reflected by a mirror; refracted, or totally reflected, by a lens. Ids and depths are its.
    Main,
    /// The reflected part of a ray that is refracted.
    Reflected,
}

/// Least sine of the angle between the facet's plane and its corners' bounced rays for which they are scaled to one height.
pub const FLAT_LEAST: f64 = 1.0 / 64.0;

impl Optics {
    /// Without roughness, tint or splitting; black where rays end on it.
    pub fn new(bounce: Bounce, surface: Surface, depth: u32) -> Optics {
        Optics {
            bounce,
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

    /// The facets; `None` for a smooth surface.
    pub fn facets(&self) -> Option<&Facets> {
        match &self.surface {
            Surface::Facets { facets, .. } => Some(facets),
            Surface::Smooth(_) => None,
        }
    }

    /// Number of facets, or of parts of a smooth surface.
    pub fn surface_count(&self) -> usize {
        self.smooth_count() + self.facets().map_or(0, |f| f.triangles.len())
    }

    /// Number of the facets' vertices.
    pub fn vertex_count(&self) -> usize {
        self.facets().map_or(0, |f| f.positions.len())
    }

    /// Number of the optics' pieces: facets of a coarser copy, or the facets or smooth parts themselves.
    pub fn piece_count(&self) -> usize {
        self.facets().map_or(self.surface_count(), Facets::piece_count)
    }

    /// The piece that defines the rays which leave a facet or smooth part.
    pub fn piece_of(&self, surface: u32) -> u32 {
        self.facets().map_or(surface, |f| f.coarse_of(surface as usize))
    }

    pub fn smooth_count(&self) -> usize {
        match &self.surface {
            Surface::Facets { .. } => 0,
            Surface::Smooth(smooth) => smooth.count(),
        }
    }

    /// Id of the first facet or part, in a scene of so many triangles with the facets: facets are the last of these, smooth parts are numbered after
    /// all of them.
    pub fn first_id(&self, triangles: usize) -> u32 {
        (triangles - self.facets().map_or(0, |f| f.triangles.len())) as u32
    }

    /// The branches that a ray splits into at every bounce.
    pub fn branches(&self) -> &'static [Branch] {
        if self.fresnel { &[Branch::Main, Branch::Reflected] } else { &[Branch::Main] }
    }

    /// The tilts of the normals, one per split ray: in the frame of the tangent plane, evenly over a disc (Vogel's spiral).
    /// Ids and depths are those of the first ray.
    pub fn tilts(&self) -> Vec<DVec2> {
        let n = f64::from(self.rays);
        let golden_angle = PI * (3.0 - 5f64.sqrt());
        let tilt = |k: u32| {
            let (s, c) = (f64::from(k) * golden_angle).sin_cos();
            self.roughness * ((f64::from(k) + 0.5) / n).sqrt() * DVec2::new(c, s)
        };
        if self.roughness == 0.0 { vec![DVec2::ZERO] } else { (0..self.rays).map(tilt).collect() }
    }

    /// Whether bounced rays may meet the surface again.
    pub fn sees_itself(&self) -> bool {
        self.depth > 1
    }
}
